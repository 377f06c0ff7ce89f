# SPDX-License-Identifier: MIT
# Builds and runs the toy project in BUILD in one WAY: find_package, add_subdirectory or pkg_config. Run with cmake -P.
file(REMOVE_RECURSE ${BUILD})

if(WAY STREQUAL "pkg_config")
    file(MAKE_DIRECTORY ${BUILD})
    set(ENV{PKG_CONFIG_PATH} ${PREFIX}/share/pkgconfig)
    execute_process(COMMAND pkg-config --cflags --libs genrender
        OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    separate_arguments(flags UNIX_COMMAND "${flags}")
    execute_process(COMMAND ${COMPILER} -std=c++20 ${CMAKE_CURRENT_LIST_DIR}/toy/toy.cpp ${flags} -o ${BUILD}/toy
        COMMAND_ERROR_IS_FATAL ANY)
else()
    if(WAY STREQUAL "find_package")
        set(where -D CMAKE_PREFIX_PATH=${PREFIX})
    else()
        set(where -D GENRENDER_SOURCE_DIR=${SOURCE})
    endif()
    execute_process(COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/toy -B ${BUILD} -G ${GENERATOR}
        -D CMAKE_CXX_COMPILER=${COMPILER} ${where} COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} COMMAND_ERROR_IS_FATAL ANY)
    # A library used as a sub-project brings no tests and installs nothing of its own.
    execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${BUILD}/prefix COMMAND_ERROR_IS_FATAL ANY)
    if(EXISTS ${BUILD}/prefix/include)
        message(FATAL_ERROR "the sub-project installs itself with its parent")
    endif()
endif()

execute_process(COMMAND ${BUILD}/toy COMMAND_ERROR_IS_FATAL ANY)
