# SPDX-License-Identifier: MIT
# Flags of this project's own tests, examples and benchmarks. They are linked PRIVATE and never reach a user's build.
set(CMAKE_CXX_EXTENSIONS OFF)
option(GENRENDER_WARNINGS_AS_ERRORS "Refuse code of this project that warns" OFF)
set(GENRENDER_SANITIZERS "" CACHE STRING "Value of -fsanitize= for tests and examples: empty, address,undefined or thread")

# What was compiled before is not compiled again, where ccache is installed; precompiled headers need leniency with times.
find_program(GENRENDER_CCACHE ccache)
if(GENRENDER_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
        CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${GENRENDER_CCACHE})
endif()

add_library(genrender_developer_flags INTERFACE)
target_compile_options(genrender_developer_flags INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow
    $<$<BOOL:${GENRENDER_WARNINGS_AS_ERRORS}>:-Werror>
    # g++ 12 warns in optimised code of xtensor's sorting functions, and does so after it forgot that they are a system header;
    # with -march=native also of its own AVX-512 intrinsics.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds -Wno-maybe-uninitialized>)

if(GENRENDER_SANITIZERS)
    # Reports name functions. Their lines cost an eighth of the compile time: configure with -D CMAKE_CXX_FLAGS=-g1 for them.
    target_compile_options(genrender_developer_flags INTERFACE
        -fsanitize=${GENRENDER_SANITIZERS} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    # A null pointer that is read ends a program in AddressSanitizer's report anyway, and checks of every reference are a
    # tenth of the compile time.
    target_compile_options(genrender_developer_flags INTERFACE -fno-sanitize=null)
    # Undefined behaviour inside other projects' headers is theirs, and looking for it there doubles the compile time.
    target_compile_options(genrender_developer_flags INTERFACE
        $<$<CXX_COMPILER_ID:Clang>:-fsanitize-ignorelist=${CMAKE_CURRENT_LIST_DIR}/sanitizer_ignorelist.txt>)
    target_link_options(genrender_developer_flags INTERFACE -fsanitize=${GENRENDER_SANITIZERS})
endif()
