# SPDX-License-Identifier: MIT
# genrender_instances: the library's instances, compiled once for the larger of this project's programs, which link it and call
# instead of compiling. Benchmarks, some tests and those of mixed flags and of the installed package do without, as most users
# do. With sanitizers all use it: for the processor's own target, optimised where what calls it is not.
add_library(genrender_instances OBJECT ${CMAKE_CURRENT_LIST_DIR}/instances.cpp)
# What computes much is optimised where the rest is only compiled quickly, as -Og does.
set(genrender_computes $<$<CONFIG:Debug>:-O1>)
target_compile_options(genrender_instances PRIVATE ${genrender_computes})
target_link_libraries(genrender_instances PUBLIC ${genrender_targets} PRIVATE genrender_developer_flags)
target_compile_definitions(genrender_instances PUBLIC GENRENDER_COMPILED)
if(GENRENDER_SANITIZERS)
    target_compile_definitions(genrender_instances PUBLIC GENRENDER_OWN_FLAGS_ONLY)
    target_compile_options(genrender_instances PUBLIC -march=native)
endif()
