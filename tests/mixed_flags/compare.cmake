# SPDX-License-Identifier: MIT
# Programs of one object each say what a program of all of them must say, in whatever order these are linked.
# Run: cmake -D "ALONE=program;program;..." -D "TOGETHER=program;program" -D OWN=ON|OFF -P compare.cmake
cmake_minimum_required(VERSION 3.25)

set(expected "")
foreach(program IN LISTS ALONE)
    execute_process(COMMAND ${program} OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
    string(APPEND expected "${output}")
endforeach()
message("${expected}")
if(NOT expected MATCHES "right" OR expected MATCHES "wrong")
    message(FATAL_ERROR "an object alone is wrong")
endif()
# With the flags' own targets alone, each object has registers of its own size, and other bits come of it.
if(OWN)
    foreach(line IN ITEMS "no flags: baseline, 16" "avx2: v3, 32" "avx512: v4, 64")
        string(REGEX MATCH "^[^:]*:" object "${line}")
        if(expected MATCHES "${object}" AND NOT expected MATCHES "${line} bytes")
            message(FATAL_ERROR "expected '${line} bytes'")
        endif()
    endforeach()
endif()
foreach(program IN LISTS TOGETHER)
    execute_process(COMMAND ${program} OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
    if(NOT output STREQUAL expected)
        message(FATAL_ERROR "${program} prints\n${output}expected what its objects print alone")
    endif()
endforeach()
