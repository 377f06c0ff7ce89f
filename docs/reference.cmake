# SPDX-License-Identifier: MIT
# Makes the reference of the public names in the folder OUT, and fails at names without a comment.
# Run: cmake -D OUT=<folder> [-D SKIP=ON] -P docs/reference.cmake; with SKIP a missing Doxygen is said and no failure.
cmake_minimum_required(VERSION 3.25)
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH root)
cmake_path(ABSOLUTE_PATH OUT NORMALIZE OUTPUT_VARIABLE GENRENDER_DOCS_DIR)

find_program(DOXYGEN doxygen)
if(NOT DOXYGEN AND SKIP)
    message("skipped: Doxygen is not installed")
    return()
elseif(NOT DOXYGEN)
    message(FATAL_ERROR "Doxygen is not installed")
endif()

file(STRINGS ${root}/include/genrender/version.hpp GENRENDER_VERSION REGEX "^#define GENRENDER_VERSION_STRING ")
string(REGEX MATCH "[0-9]+[.][0-9]+[.][0-9]+" GENRENDER_VERSION "${GENRENDER_VERSION}")
file(REMOVE_RECURSE ${GENRENDER_DOCS_DIR}/html)
file(MAKE_DIRECTORY ${GENRENDER_DOCS_DIR})
configure_file(${CMAKE_CURRENT_LIST_DIR}/Doxyfile.in ${GENRENDER_DOCS_DIR}/Doxyfile @ONLY)
execute_process(COMMAND ${DOXYGEN} ${GENRENDER_DOCS_DIR}/Doxyfile WORKING_DIRECTORY ${root} RESULT_VARIABLE result)
file(GLOB_RECURSE headers RELATIVE ${root} ${root}/include/*.hpp)
execute_process(COMMAND awk -f docs/undocumented.awk ${headers} WORKING_DIRECTORY ${root} RESULT_VARIABLE other_result)
if(NOT result EQUAL 0 OR NOT other_result EQUAL 0)
    message(FATAL_ERROR "names without a comment, or comments that Doxygen cannot read: see above")
endif()
message("${GENRENDER_DOCS_DIR}/html/index.html")
