# SPDX-License-Identifier: MIT
# Runs every benchmark, every peer whose packages are there and the compiler, and prints one table of it all.
# Run: cmake -D PROGRAMS=a;b -D TABLE=benchmark_table -D COMMANDS=compile_commands.json -D OUT=folder -P measure.cmake
# The environment variable GENRENDER_PEER_PYTHON names the Python of the peers, else it is python3.
cmake_minimum_required(VERSION 3.25)

# A case runs for 3 x 0.1 s and at least three times: medians come of it, and all of it takes minutes.
set(brief --benchmark_repetitions=3 --benchmark_min_time=0.1)

set(results ${OUT}/results)
file(REMOVE_RECURSE ${results})
file(MAKE_DIRECTORY ${results}/peers ${results}/networks)

# Where networks leave their weights for peers.
set(ENV{GENRENDER_NETWORK_FOLDER} ${results}/networks)

function(say text)
    string(TIMESTAMP now "%H:%M:%S")
    message(STATUS "${now} ${text}")
endfunction()

foreach(program IN LISTS PROGRAMS)
    cmake_path(GET program FILENAME name)
    say(${name})
    execute_process(COMMAND ${program} ${brief} --benchmark_out=${results}/${name}.json
        RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE error)
    if(NOT code EQUAL 0)
        message(STATUS "${name} ended with ${code}:\n${output}${error}")
        file(WRITE ${results}/${name}.json "{\"benchmarks\": [{\"run_name\": \"${name}\", \"run_type\": \"iteration\", \
\"error_occurred\": true, \"error_message\": \"the program ended with ${code}\"}]}\n")
    endif()
endforeach()

say("compile times")
execute_process(COMMAND ${CMAKE_COMMAND} -D COMMANDS=${COMMANDS} -D OUT=${results}/translation_units.json
    -P ${CMAKE_CURRENT_LIST_DIR}/compile_times/compile_times.cmake COMMAND_ERROR_IS_FATAL ANY)

set(python python3)
if(DEFINED ENV{GENRENDER_PEER_PYTHON})
    set(python $ENV{GENRENDER_PEER_PYTHON})
endif()
file(GLOB peers ${CMAKE_CURRENT_LIST_DIR}/peers/*.py)
foreach(peer IN LISTS peers)
    cmake_path(GET peer STEM name)
    say("peer ${name}")
    execute_process(COMMAND ${python} -B ${peer} TIMEOUT 240
        RESULT_VARIABLE code OUTPUT_FILE ${results}/peers/${name}.json ERROR_VARIABLE error)
    if(NOT code EQUAL 0)
        # The last line of a traceback is the one that tells, if it came to one.
        string(STRIP "${error}" why)
        string(REGEX REPLACE "^.*\n" "" why "${why}")
        if(why STREQUAL "" OR NOT code MATCHES "^[0-9]+$")
            set(why "${code}")
        endif()
        string(REGEX REPLACE "[\"\\\\]" "'" why "${why}")
        file(WRITE ${results}/peers/${name}.json "{\"missing\": \"${python}: ${why}\"}\n")
    endif()
endforeach()

say("the table, also in ${OUT}/benchmarks.md and benchmarks.json")
execute_process(COMMAND ${TABLE} ${results} --targets ${CMAKE_CURRENT_LIST_DIR}/targets.json --out ${OUT}
    COMMAND_ERROR_IS_FATAL ANY)
