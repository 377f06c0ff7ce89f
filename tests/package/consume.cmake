# SPDX-License-Identifier: MIT
# Builds and runs the toy programs of COMPONENTS in BUILD in one WAY: find_package, add_subdirectory or pkg_config; without
# the packages of other components, and with FLAGS, those of the build that asks. WITH_INSTANCES: and one that compiles the
# instances apart. Run with cmake -P.
cmake_minimum_required(VERSION 3.25)
include(${SOURCE}/cmake/components.cmake)
file(REMOVE_RECURSE ${BUILD})
string(REPLACE "," ";" COMPONENTS "${COMPONENTS}")

if(WAY STREQUAL "pkg_config")
    file(MAKE_DIRECTORY ${BUILD})
    set(ENV{PKG_CONFIG_PATH} ${PREFIX}/share/pkgconfig)
    foreach(component IN LISTS COMPONENTS)
        string(REPLACE "genrender-core" "genrender" module genrender-${component})
        execute_process(COMMAND pkg-config --cflags --libs ${module}
            OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
        separate_arguments(flags UNIX_COMMAND "${FLAGS} ${flags}")
        execute_process(COMMAND ${COMPILER} -std=c++20 ${CMAKE_CURRENT_LIST_DIR}/toy/${component}.cpp ${flags}
            -o ${BUILD}/toy_${component} COMMAND_ERROR_IS_FATAL ANY)
    endforeach()
else()
    if(WAY STREQUAL "find_package")
        set(where -D CMAKE_PREFIX_PATH=${PREFIX} -D WITH_INSTANCES=${WITH_INSTANCES})
    else()
        set(where -D GENRENDER_SOURCE_DIR=${SOURCE})
    endif()
    foreach(component IN LISTS genrender_components)
        foreach(package IN LISTS genrender_${component}_PACKAGES)
            if(NOT component IN_LIST COMPONENTS)
                list(APPEND where -D CMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
            endif()
        endforeach()
    endforeach()
    execute_process(COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/toy -B ${BUILD} -G ${GENERATOR}
        -D CMAKE_CXX_COMPILER=${COMPILER} -D "CMAKE_CXX_FLAGS=${FLAGS}" -D "COMPONENTS=${COMPONENTS}" ${where}
        COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --parallel 2 COMMAND_ERROR_IS_FATAL ANY)
    # A library used as a sub-project brings no tests and installs nothing of its own.
    execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${BUILD}/prefix COMMAND_ERROR_IS_FATAL ANY)
    if(EXISTS ${BUILD}/prefix/include)
        message(FATAL_ERROR "the sub-project installs itself with its parent")
    endif()
endif()

set(programs ${COMPONENTS})
if(WITH_INSTANCES)
    list(APPEND programs compiled)
endif()
foreach(program IN LISTS programs)
    execute_process(COMMAND ${BUILD}/toy_${program} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
