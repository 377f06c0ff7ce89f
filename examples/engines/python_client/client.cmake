# SPDX-License-Identifier: MIT
# What the project of a client in Python includes after project().
#
#   genrender_python_client(NAME name ENGINE package TITLE text WAY_IN text PACKAGES packages)
#
# Builds the Python module of genrender beside its files in <build>/site, and client_<NAME>, which lets client.py render and
# prints a row of the table. The Python is the first of GENRENDER_ENGINE_PYTHON and build/engines/python, where get.sh puts
# one, that has all packages; the project fails with a sentence `skipped: ...` where there is none.
set(genrender_python_client ${CMAKE_CURRENT_LIST_DIR})
set(GENRENDER_ENGINE_PYTHON python3 CACHE STRING "A Python that may have the packages")

macro(genrender_python_client)
    cmake_parse_arguments(client "" "NAME;ENGINE;TITLE;WAY_IN" "PACKAGES" ${ARGN})
    set(missing "")
    set(python "")
    foreach(candidate IN ITEMS ${GENRENDER_ENGINE_PYTHON} ${genrender_python_client}/../../../build/engines/python/bin/python3)
        execute_process(COMMAND ${candidate} -c "import importlib.util as u, importlib.metadata as m, sys
lacks = [p for p in sys.argv[2:] if u.find_spec(p) is None]
print(sys.executable if not lacks else '', ' '.join(lacks), '' if lacks else m.version(sys.argv[1]), sep='|')"
            ${client_ENGINE} ${client_PACKAGES} OUTPUT_VARIABLE said ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
        if(said MATCHES "^([^|]+)[|][|](.*)$")
            set(python ${CMAKE_MATCH_1})
            set(version ${CMAKE_MATCH_2})
            break()
        elseif(said MATCHES "^[|]([^|]+)[|]")
            string(APPEND missing "${candidate} lacks ${CMAKE_MATCH_1}. ")
        endif()
    endforeach()
    if(NOT python)
        message(FATAL_ERROR "skipped: ${missing}sh examples/engines/${client_NAME}/get.sh build/engines/${client_NAME} installs them")
    endif()

    # The module compiles against this Python's headers.
    set(Python_EXECUTABLE ${python})
    find_package(Python 3.10 QUIET COMPONENTS Interpreter Development.Module)
    if(NOT Python_FOUND)
        message(FATAL_ERROR "skipped: ${python} has no headers for modules in C++ (the package python3-dev)")
    endif()
    set(GENRENDER_COMPONENTS scene reference CACHE STRING "")
    add_subdirectory(${genrender_python_client}/../../.. genrender)
    include(${genrender_python_client}/../client.cmake)
    add_subdirectory(${genrender_python_client}/../../../python genrender_python)
    set(site ${CMAKE_CURRENT_BINARY_DIR}/site)
    set_target_properties(_genrender PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${site}/genrender)
    file(GLOB parts ${genrender_python_client}/../../../python/genrender/*.py)
    add_custom_target(genrender_python_files COMMAND ${CMAKE_COMMAND} -E make_directory ${site}/genrender
        COMMAND ${CMAKE_COMMAND} -E copy ${parts} ${site}/genrender)

    target_sources(engine_comparison PRIVATE ${genrender_python_client}/client.cpp)
    set_source_files_properties(${genrender_python_client}/client.cpp PROPERTIES COMPILE_DEFINITIONS
        "GENRENDER_ENGINE=\"${client_TITLE} ${version}\";GENRENDER_WAY_IN=\"${client_WAY_IN}\";GENRENDER_PYTHON=\"${python}\";\
GENRENDER_PYTHON_SITE=\"${site}:${genrender_python_client}\";GENRENDER_PYTHON_RUN=\"${CMAKE_CURRENT_BINARY_DIR}/run\";\
GENRENDER_CLIENT=\"${CMAKE_CURRENT_SOURCE_DIR}/client.py\"")
    add_executable(client_${client_NAME} $<TARGET_OBJECTS:engine_comparison>)
    set_target_properties(client_${client_NAME} PROPERTIES LINKER_LANGUAGE CXX)
    target_link_libraries(client_${client_NAME} PRIVATE engine_comparison)
    add_dependencies(client_${client_NAME} _genrender genrender_python_files)
endmacro()
