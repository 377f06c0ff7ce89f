# SPDX-License-Identifier: MIT
# Counts the instructions of a hot kernel and compares them with the figure in COUNTS, or with UPDATE=ON writes it there.
# Run: cmake -D VALGRIND=... -D PROGRAM=... -D KERNEL=... -D COMPILER=x86_64-GNU-12 -D COUNTS=counts.txt [-D UPDATE=ON] -P count.cmake
cmake_minimum_required(VERSION 3.25)

# Mathematical functions as every x86-64 has them, whichever processor this is.
set(ENV{GLIBC_TUNABLES} "glibc.cpu.hwcaps=-AVX,-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL")
# Valgrind knows no AVX-512, and one code for every processor is compared with one figure.
set(ENV{GENRENDER_VECTOR_TARGET} baseline)
execute_process(COMMAND ${VALGRIND} --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=counted ${PROGRAM} ${KERNEL}
    RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT code EQUAL 0 OR NOT output MATCHES "Collected : ([1-9][0-9]*)")
    message(FATAL_ERROR "${KERNEL}: valgrind counted nothing (exit code ${code}):\n${output}")
endif()
set(count ${CMAKE_MATCH_1})

set(figure 0)
file(READ ${COUNTS} counts)
if(counts MATCHES "\n(${COMPILER} ${KERNEL}) ([0-9]+)\n")
    set(figure ${CMAKE_MATCH_2})
endif()
if(UPDATE)
    string(REGEX REPLACE "\n${COMPILER} ${KERNEL} [0-9]+\n" "\n" counts "${counts}")
    file(WRITE ${COUNTS} "${counts}${COMPILER} ${KERNEL} ${count}\n")
    message("${KERNEL}: ${count} instructions, before ${figure}")
    return()
endif()

math(EXPR least "${figure} * 95 / 100")
math(EXPR most "${figure} * 105 / 100")
message("${KERNEL}: ${count} instructions, the figure is ${figure}")
if(count LESS least OR count GREATER most)
    message(FATAL_ERROR "${KERNEL}: ${count} instructions, expected ${least} to ${most} (${COMPILER} in ${COUNTS}). If the "
        "kernel was meant to change, build the target instruction_counts_update and commit the file.")
endif()
