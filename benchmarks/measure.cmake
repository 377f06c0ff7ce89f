# SPDX-License-Identifier: MIT
# Runs every benchmark, every peer whose packages are there and the compiler, and prints one table of it all.
# Run: cmake -P build/bench/benchmarks/measure.cmake [-- OPTIONS], a file that sets PROGRAMS, TABLE, COMPARISON, COMMANDS and OUT
# and includes this one. The environment variable GENRENDER_PEER_PYTHON names the Python of the peers, else it is python3.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/support/filter.cmake)

set(usage "expected options
  --filter REGEX   only rows whose names match, as mix<float>/tokens:64/channels:1280; with a minus in front, only the others
  --compare FILE   the benchmarks.json of an earlier run, beside which the new rows are judged
  --no-peers       none of the programs of others")

# A case runs five times for 0.05 s, and at least five times: medians and their noise come of it, and all of it takes minutes.
set(brief --benchmark_repetitions=5 --benchmark_min_time=0.05)

set(filter "")
set(compare "")
set(with_peers TRUE)
set(is_option FALSE)
set(i 0)
while(i LESS CMAKE_ARGC)
    set(argument "${CMAKE_ARGV${i}}")
    math(EXPR i "${i} + 1")
    set(value "${CMAKE_ARGV${i}}")
    if(NOT is_option)
        if(argument STREQUAL "--")
            set(is_option TRUE)
        endif()
    elseif(argument STREQUAL "--no-peers")
        set(with_peers FALSE)
    elseif(argument MATCHES "^--(filter|compare)$" AND i LESS CMAKE_ARGC)
        set(${CMAKE_MATCH_1} "${value}")
        math(EXPR i "${i} + 1")
    else()
        message(FATAL_ERROR "bench: '${argument}' is no whole option, ${usage}")
    endif()
endwhile()

# Kept, as it may be the very file that this run writes; what is no run is refused before anything is measured.
if(NOT compare STREQUAL "")
    cmake_path(ABSOLUTE_PATH compare)
    execute_process(COMMAND ${COMPARISON} ${compare} ${compare} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
    file(COPY_FILE ${compare} ${OUT}/before.json)
endif()

set(results ${OUT}/results)
file(REMOVE_RECURSE ${results})
file(MAKE_DIRECTORY ${results}/peers ${results}/networks)

# Where networks leave their weights for peers.
set(ENV{GENRENDER_NETWORK_FOLDER} ${results}/networks)

function(say text)
    string(TIMESTAMP now "%H:%M:%S")
    message(STATUS "${now} ${text}")
endfunction()

# The kernels of the rows that were measured.
set(kernels "")
foreach(program IN LISTS PROGRAMS)
    cmake_path(GET program FILENAME name)
    set(of_it --benchmark_filter=${filter})
    execute_process(COMMAND ${program} ${of_it} --benchmark_list_tests OUTPUT_VARIABLE rows ERROR_QUIET
        COMMAND_ERROR_IS_FATAL ANY)
    string(REGEX MATCHALL "[^\n]+" rows "${rows}")
    if(NOT rows)
        continue()
    endif()
    list(TRANSFORM rows REPLACE "/.*" "")
    list(APPEND kernels ${rows})
    say(${name})
    execute_process(COMMAND ${program} ${brief} ${of_it} --benchmark_out=${results}/${name}.json
        RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE error)
    if(NOT code EQUAL 0)
        message(STATUS "${name} ended with ${code}:\n${output}${error}")
        file(WRITE ${results}/${name}.json "{\"benchmarks\": [{\"run_name\": \"${name}\", \"run_type\": \"iteration\", \
\"error_occurred\": true, \"error_message\": \"the program ended with ${code}\"}]}\n")
    endif()
endforeach()

say("compile times")
execute_process(COMMAND ${CMAKE_COMMAND} -D COMMANDS=${COMMANDS} -D OUT=${results}/translation_units.json -D FILTER=${filter}
    -P ${CMAKE_CURRENT_LIST_DIR}/compile_times/compile_times.cmake COMMAND_ERROR_IS_FATAL ANY)
if(NOT kernels AND NOT EXISTS ${results}/translation_units.json)
    message(FATAL_ERROR "bench: no row matches --filter '${filter}', expected part of a name such as mix<float>/tokens:64/channels:1280")
endif()

set(python python3)
if(DEFINED ENV{GENRENDER_PEER_PYTHON})
    set(python $ENV{GENRENDER_PEER_PYTHON})
endif()
file(GLOB peers ${CMAKE_CURRENT_LIST_DIR}/peers/*.py)
foreach(peer IN LISTS peers)
    cmake_path(GET peer STEM name)
    # The line KERNELS = ["attention"] of a peer: importing its packages, to find that it has nothing to do, takes seconds.
    file(STRINGS ${peer} its_kernels REGEX "^KERNELS = ")
    set(is_needed FALSE)
    foreach(kernel IN LISTS kernels)
        string(FIND "${its_kernels}" "\"${kernel}\"" place)
        if(place GREATER_EQUAL 0)
            set(is_needed TRUE)
        endif()
    endforeach()
    if(NOT with_peers OR NOT is_needed)
        continue()
    endif()
    say("peer ${name}")
    execute_process(COMMAND ${python} -B ${peer} --filter=${filter} --seconds 0.25 TIMEOUT 240
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
set(filtered "")
if(NOT filter STREQUAL "")
    set(filtered --filter=${filter})
endif()
execute_process(COMMAND ${TABLE} ${results} --targets ${CMAKE_CURRENT_LIST_DIR}/targets.json --out ${OUT} ${filtered}
    RESULT_VARIABLE table_code)
if(NOT compare STREQUAL "")
    say("beside ${compare}")
    execute_process(COMMAND ${COMPARISON} ${OUT}/before.json ${OUT}/benchmarks.json COMMAND_ERROR_IS_FATAL ANY)
endif()
if(NOT table_code EQUAL 0)
    message(FATAL_ERROR "bench: a row failed, or there is no table")
endif()
