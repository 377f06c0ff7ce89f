# SPDX-License-Identifier: MIT
# Builds, tests and runs the clients of engines, each a project of its own folder here, and prints one table of their rows.
#
#   cmake -D BUILD=<folder> [-D ENGINES=<names>] [-D PYTHON=<path>] [-D COMPILER=<path>] [-D OPTIONS=<list>] -P table.cmake
#
# OPTIONS are further arguments for configuring. A client's project defines the target client_<folder>, which links
# engine_comparison and prints a row; -D GENRENDER_ENGINE_PYTHON tells it the Python whose packages it may use: PYTHON, else the
# one that the environment variable GENRENDER_PEER_PYTHON names, else python3. A project whose engine is not there fails with a
# sentence `skipped: ...`. A `-` in a row is filled in here: lines of code without comments, of files `network.*` and of all
# others, each with what they include of another client's folder; and the seconds of the processor's time in which the client's
# own files were compiled and linked, for Python genrender's module, small where they were before. Fails if a client does;
# engines that are skipped do not count.
cmake_minimum_required(VERSION 3.25)
set(here ${CMAKE_CURRENT_LIST_DIR})

if(NOT ENGINES)
    file(GLOB projects RELATIVE ${here} ${here}/*/CMakeLists.txt)
    list(TRANSFORM projects REPLACE "/CMakeLists.txt" "" OUTPUT_VARIABLE ENGINES)
endif()
if(NOT PYTHON)
    set(PYTHON python3)
    if(DEFINED ENV{GENRENDER_PEER_PYTHON})
        set(PYTHON $ENV{GENRENDER_PEER_PYTHON})
    endif()
endif()
set(options -D GENRENDER_ENGINE_PYTHON=${PYTHON})
if(OPTIONS)
    list(APPEND options ${OPTIONS})
endif()
if(COMPILER)
    list(APPEND options -D CMAKE_CXX_COMPILER=${COMPILER})
endif()

# Lines of files that hold something else than a comment.
function(lines_of result)
    set(count 0)
    foreach(file IN LISTS ARGN)
        file(READ ${file} text)
        string(REGEX REPLACE "[][;]" "" text "${text}")
        string(REGEX MATCHALL "[^\n]+" lines "${text}")
        list(FILTER lines EXCLUDE REGEX "^ *(//.*|#( .*)?|#!.*)?$")
        list(LENGTH lines length)
        math(EXPR count "${count} + ${length}")
    endforeach()
    set(${result} ${count} PARENT_SCOPE)
endfunction()

# Appends to a list of files what these include of other clients' folders.
function(add_shared_files list)
    foreach(file IN LISTS ${list})
        file(STRINGS ${file} includes REGEX "^#include \"[.][.]/[a-z_]+/[a-z_]+[.]hpp\"")
        list(FILTER includes EXCLUDE REGEX "/comparison[.]hpp") # the library's side
        list(TRANSFORM includes REPLACE "^#include \"[.][.]|\"$" "")
        list(TRANSFORM includes PREPEND ${here})
        list(APPEND ${list} ${includes})
    endforeach()
    set(${list} ${${list}} PARENT_SCOPE)
endfunction()

set(rows "")
set(skipped "")
set(failed "")
foreach(engine IN LISTS ENGINES)
    set(build ${BUILD}/${engine})
    message(STATUS "${engine}: configuring")
    execute_process(COMMAND ${CMAKE_COMMAND} -S ${here}/${engine} -B ${build} -G Ninja ${options}
        RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said)
    if(code AND said MATCHES "skipped: ([^\n]*(\n  [^\n ][^\n]*)*)")
        string(REGEX REPLACE "[ \n]+" " " sentence "${CMAKE_MATCH_1}")
        string(APPEND skipped "skipped: ${engine}: ${sentence}\n")
        continue()
    elseif(code)
        message("${said}")
        list(APPEND failed ${engine})
        continue()
    endif()
    message(STATUS "${engine}: compiling")
    execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} --target engine_comparison RESULT_VARIABLE code)
    if(NOT code)
        # The shell tells the processor's time of what it started, in its second line.
        execute_process(COMMAND sh -c "\"$0\" --build \"$1\" --target \"$2\" >&2; code=$?; times; exit $code"
            ${CMAKE_COMMAND} ${build} client_${engine} RESULT_VARIABLE code OUTPUT_VARIABLE times)
    endif()
    set(seconds -)
    if(times MATCHES "\n([0-9]+)m([0-9]+)[.,]?[0-9]*s ([0-9]+)m([0-9]+)")
        math(EXPR seconds "60 * (${CMAKE_MATCH_1} + ${CMAKE_MATCH_3}) + ${CMAKE_MATCH_2} + ${CMAKE_MATCH_4}")
    endif()
    if(NOT code)
        execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} RESULT_VARIABLE code)
    endif()
    if(NOT code)
        execute_process(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${build} --output-on-failure --no-tests=ignore
            RESULT_VARIABLE code)
    endif()
    if(NOT code)
        message(STATUS "${engine}: running")
        execute_process(COMMAND ${build}/client_${engine} RESULT_VARIABLE code OUTPUT_VARIABLE said)
    endif()
    if(code)
        list(APPEND failed ${engine})
    endif()

    # Text is replaced by position: a row holds neither brackets nor semicolons.
    file(GLOB network ${here}/${engine}/network.*)
    add_shared_files(network)
    file(GLOB glue ${here}/${engine}/*.[chp]pp ${here}/${engine}/*.py ${here}/${engine}/*.[ch])
    list(REMOVE_ITEM glue ${network})
    add_shared_files(glue)
    lines_of(of_network ${network})
    lines_of(of_glue ${glue})
    string(REGEX MATCHALL "[^\n|]+ \\|[^\n]*" lines "${said}")
    foreach(line IN LISTS lines)
        string(REGEX REPLACE "^([^|]*\\|[^|]*\\|) - (\\|)" "\\1 ${of_network} + ${of_glue} \\2" line "${line}")
        string(REGEX REPLACE "^([^|]*\\|[^|]*\\|[^|]*\\|) - (\\|)" "\\1 ${seconds} \\2" line "${line}")
        string(APPEND rows "| ${line} |\n")
    endforeach()
endforeach()

if(rows)
    message("
| engine | way in | lines (network + glue) | compile s | greatest difference | run s against the reference network | \
library outside the denoiser |
|---|---|---|---|---|---|---|
${rows}")
endif()
message("${skipped}")
if(failed)
    list(JOIN failed ", " failed)
    message(FATAL_ERROR "these clients fail: ${failed}")
endif()
