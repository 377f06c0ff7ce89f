# SPDX-License-Identifier: MIT
# Times the compiler on those files of this folder whose rows FILTER wants and writes OUT as Google Benchmark would, or nothing
# if it wants none.
# Run: cmake -D COMMANDS=compile_commands.json -D OUT=compile_times.json [-D FILTER=kernels] -P compile_times.cmake
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/../support/filter.cmake)

# What most files include is timed more often than what takes longer.
set(repetitions 1)
set(repetitions_of_kernels 3)
set(repetitions_of_umbrella 2)

# A compiler that is a link to a cache compiles all the same.
set(ENV{CCACHE_DISABLE} 1)

file(READ ${COMMANDS} commands)
string(JSON count LENGTH "${commands}")
math(EXPR last "${count} - 1")
set(entries "")
set(is_there FALSE)
foreach(i RANGE ${last})
    string(JSON file GET "${commands}" ${i} file)
    if(NOT file MATCHES "/compile_times/([a-z_]+)\\.cpp$")
        continue()
    endif()
    set(name ${CMAKE_MATCH_1})
    set(is_there TRUE)
    matches_filter(is_wanted compile_time/${name} "${FILTER}")
    if(NOT is_wanted)
        continue()
    endif()
    set(times ${repetitions})
    if(DEFINED repetitions_of_${name})
        set(times ${repetitions_of_${name}})
    endif()
    string(JSON command GET "${commands}" ${i} command)
    string(JSON directory GET "${commands}" ${i} directory)
    separate_arguments(command UNIX_COMMAND "${command}")
    foreach(repetition RANGE 1 ${times})
        string(TIMESTAMP start "%s%f")
        execute_process(COMMAND ${command} WORKING_DIRECTORY ${directory} ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
        string(TIMESTAMP end "%s%f")
        math(EXPR microseconds "${end} - ${start}")
        list(APPEND entries "{\"run_name\": \"compile_time/${name}\", \"run_type\": \"iteration\", \
\"real_time\": ${microseconds}, \"time_unit\": \"us\"}")
    endforeach()
endforeach()
if(NOT is_there)
    message(FATAL_ERROR "${COMMANDS}: has no file of compile_times/, expected those of the benchmarks' build")
endif()
if(entries)
    list(JOIN entries ",\n" entries)
    file(WRITE ${OUT} "{\"benchmarks\": [\n${entries}\n]}\n")
endif()
