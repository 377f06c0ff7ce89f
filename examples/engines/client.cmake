# SPDX-License-Identifier: MIT
# What the project of every client includes: the library's side of the comparison, compiled once, and the flags of this
# project's own programs.
set(CMAKE_CXX_EXTENSIONS OFF)
if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release)
endif()
add_library(engine_flags INTERFACE)
target_compile_options(engine_flags INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Werror
    # Of optimised code of others' headers, as cmake/developer_flags.cmake says; of g++ 12's own strings.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds -Wno-maybe-uninitialized -Wno-restrict>)

add_library(engine_comparison OBJECT ${CMAKE_CURRENT_LIST_DIR}/comparison.cpp)
target_link_libraries(engine_comparison PUBLIC genrender::genrender genrender::scene genrender::reference engine_flags)
target_compile_definitions(engine_comparison PRIVATE
    GENRENDER_MINIATURE_WEIGHTS="${CMAKE_CURRENT_LIST_DIR}/../miniature/weights")
