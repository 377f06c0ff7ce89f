# SPDX-License-Identifier: MIT
# Builds the project of an engine in BUILD and runs its tests; prints `skipped: ...` where the engine is not there.
#   cmake -D ENGINE=<folder> -D BUILD=<folder> [-D COMPILER=<path>] [-D PREFIX=<where the engine is>] -P run_client.cmake
cmake_minimum_required(VERSION 3.25)
set(options -D CMAKE_PREFIX_PATH=${PREFIX})
if(COMPILER)
    list(APPEND options -D CMAKE_CXX_COMPILER=${COMPILER})
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/../${ENGINE} -B ${BUILD} -G Ninja ${options}
    RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(code AND said MATCHES "skipped: [^\n]*")
    message("${CMAKE_MATCH_0}")
    return()
elseif(code)
    message(FATAL_ERROR "${said}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --parallel 1 COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${BUILD} --output-on-failure --no-tests=error
    COMMAND_ERROR_IS_FATAL ANY)
