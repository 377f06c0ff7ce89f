# SPDX-License-Identifier: MIT
# What the project of every client includes: the library's side of the comparison, compiled once, and the flags of this
# project's own programs. That side is the file engine_comparison_source where it is set, else comparison.cpp.
set(CMAKE_CXX_EXTENSIONS OFF)
if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release)
endif()
add_library(engine_flags INTERFACE)
target_compile_options(engine_flags INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Werror
    # Of optimised code of others' headers, as cmake/developer_flags.cmake says; of g++ 12's own strings.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds -Wno-maybe-uninitialized -Wno-restrict>)

if(NOT engine_comparison_source)
    set(engine_comparison_source ${CMAKE_CURRENT_LIST_DIR}/comparison.cpp)
    set_source_files_properties(${engine_comparison_source} PROPERTIES COMPILE_DEFINITIONS
        GENRENDER_MINIATURE_WEIGHTS="${CMAKE_CURRENT_LIST_DIR}/../miniature/weights")
endif()
add_library(engine_comparison OBJECT ${engine_comparison_source})
target_link_libraries(engine_comparison PUBLIC genrender::genrender genrender::scene genrender::reference engine_flags)
