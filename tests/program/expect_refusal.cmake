# SPDX-License-Identifier: MIT
# Runs PROGRAM with the arguments after `--` and expects the exit code CODE and TEXT on its error stream.
# Run: cmake -D PROGRAM=... -D CODE=... -D TEXT=... -P expect_refusal.cmake -- arguments
set(arguments "")
set(seen FALSE)
foreach(i RANGE ${CMAKE_ARGC})
    if(seen AND i LESS CMAKE_ARGC)
        list(APPEND arguments "${CMAKE_ARGV${i}}")
    elseif("${CMAKE_ARGV${i}}" STREQUAL "--")
        set(seen TRUE)
    endif()
endforeach()

execute_process(COMMAND ${PROGRAM} ${arguments} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE error)
string(FIND "${error}" "${TEXT}" position)
if(NOT code EQUAL CODE OR position EQUAL -1)
    message(FATAL_ERROR "exit code ${code}, expected ${CODE}; error stream, expected '${TEXT}' in it:\n${error}")
endif()
