# SPDX-License-Identifier: MIT
# Compiles the header FILE of include/ for the folder PRECOMPILED, where g++ looks for it first.
cmake_minimum_required(VERSION 3.25)
set(flags -std=c++20)
include(${CMAKE_CURRENT_LIST_DIR}/include_folders.cmake)
string(REGEX REPLACE "^.*/include/" "" name ${FILE})
cmake_path(GET name PARENT_PATH folder)
file(MAKE_DIRECTORY ${PRECOMPILED}/${folder})
execute_process(COMMAND ${COMPILER} ${flags} -w -x c++-header ${FILE} -o ${PRECOMPILED}/${name}.gch COMMAND_ERROR_IS_FATAL ANY)
