# SPDX-License-Identifier: MIT
# Makes and tests the package of packaging/conan, with the packages of the system and without a remote; all that Conan keeps
# lies in BUILD. Run: cmake -D BUILD=<folder> -D COMPILER=<path> -P conan_recipe.cmake
cmake_minimum_required(VERSION 3.25)
cmake_path(SET root NORMALIZE ${CMAKE_CURRENT_LIST_DIR}/../..)

find_program(CONAN conan)
if(NOT CONAN)
    message("skipped: Conan is not installed")
    return()
endif()

# The recipe names the packages that the components need.
include(${root}/cmake/components.cmake)
set(names_Eigen3 eigen)
file(READ ${root}/packaging/conan/conanfile.py recipe)
foreach(component IN LISTS genrender_components)
    foreach(package IN LISTS genrender_${component}_PACKAGES)
        set(name ${package})
        if(names_${package})
            set(name ${names_${package}})
        endif()
        if(genrender_${package}_PKG_CONFIG AND NOT recipe MATCHES "\"${component}\": {[^}]*\"${name}/")
            message(FATAL_ERROR "conanfile.py: ${component} lacks ${name}, which cmake/components.cmake names")
        endif()
    endforeach()
endforeach()

file(REMOVE_RECURSE ${BUILD})
set(ENV{CONAN_HOME} ${BUILD}/home)
execute_process(COMMAND ${CONAN} profile detect COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CONAN} remote disable "*" COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CONAN} create ${root}/packaging/conan -s compiler.cppstd=20
    -o "genrender/*:system_packages=True"
    -c "tools.build:compiler_executables={'cpp': '${COMPILER}'}" -c tools.build:jobs=1
    -c tools.cmake.cmake_layout:test_folder=${BUILD}/test COMMAND_ERROR_IS_FATAL ANY)
