# SPDX-License-Identifier: MIT
# Prints what each program and each peer measures, by the head of its file: the tables of README.md, or with -D CHECK=README.md
# compares them with that file.
# Run: cmake [-D CHECK=benchmarks/README.md] -P benchmarks/contents.cmake
cmake_minimum_required(VERSION 3.25)
set(room ${CMAKE_CURRENT_LIST_DIR})

set(text "| program | measures |\n|---|---|\n")
file(GLOB programs RELATIVE ${room} ${room}/*/*.bench.cpp)
foreach(program IN LISTS programs)
    file(READ ${room}/${program} source)
    # The comment's lines behind that of the licence.
    string(REGEX MATCH "^// SPDX[^\n]*\n((// [^\n]*\n)+)" head "${source}")
    string(REGEX REPLACE "\n?// " " " head "${CMAKE_MATCH_1}")
    string(STRIP "${head}" head)
    string(APPEND text "| `${program}` | ${head} |\n")
endforeach()

string(APPEND text "\n| peer | of the rows |\n|---|---|\n")
file(GLOB peers RELATIVE ${room} ${room}/peers/*.py)
foreach(peer IN LISTS peers)
    file(READ ${room}/${peer} source)
    string(REGEX MATCH "\nKERNELS = ([^\n]*)\n" kernels "${source}")
    string(REGEX REPLACE "\"" "`" kernels "${CMAKE_MATCH_1}")
    string(REGEX REPLACE "[][]" "" kernels "${kernels}")
    string(APPEND text "| `${peer}` | ${kernels} |\n")
endforeach()

if(NOT DEFINED CHECK)
    message("${text}")
    return()
endif()
file(READ ${CHECK} readme)
string(FIND "${readme}" "${text}" place)
if(place EQUAL -1)
    message(FATAL_ERROR "${CHECK}: does not tell what the programs' heads tell, expected\n${text}")
endif()
