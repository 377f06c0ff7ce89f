# SPDX-License-Identifier: MIT
# Runs the port of packaging/vcpkg without vcpkg: with stand-ins for the functions that it calls, each of which does what
# vcpkg's documentation says it does for a package of headers alone. The package lies in PREFIX then.
# Run: cmake -D PREFIX=<folder> -D GENERATOR=<name> -D COMPILER=<path> -D FEATURES=core,<names> -P vcpkg_port.cmake
cmake_minimum_required(VERSION 3.25)
cmake_path(SET root NORMALIZE ${CMAKE_CURRENT_LIST_DIR}/../..)
set(port_folder ${root}/packaging/vcpkg/genrender)

# The port names the packages that the components need.
file(READ ${port_folder}/vcpkg.json manifest)
set(names_Eigen3 eigen3)
set(names_nlohmann_json nlohmann-json)
include(${root}/cmake/components.cmake)
function(expect_dependencies component path)
    string(JSON count LENGTH "${manifest}" ${path})
    set(found "")
    math(EXPR last "${count} - 1")
    foreach(i RANGE ${last})
        string(JSON type TYPE "${manifest}" ${path} ${i})
        if(type STREQUAL "STRING") # Others are tools of vcpkg.
            string(JSON name GET "${manifest}" ${path} ${i})
            list(APPEND found ${name})
        endif()
    endforeach()
    set(expected "")
    foreach(package IN LISTS genrender_${component}_PACKAGES)
        if(genrender_${package}_PKG_CONFIG) # What has none is no package, but threads.
            set(name ${package})
            if(names_${package})
                set(name ${names_${package}})
            endif()
            list(APPEND expected ${name})
        endif()
    endforeach()
    list(SORT found)
    list(SORT expected)
    if(NOT found STREQUAL expected)
        message(FATAL_ERROR "vcpkg.json: ${component} depends on ${found}, and in cmake/components.cmake on ${expected}")
    endif()
endfunction()
expect_dependencies(core dependencies)
foreach(component IN LISTS genrender_components)
    if(NOT component STREQUAL "core" AND genrender_${component}_PACKAGES)
        expect_dependencies(${component} "features;${component};dependencies")
    endif()
endforeach()

function(vcpkg_cmake_configure)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "SOURCE_PATH" "OPTIONS")
    execute_process(COMMAND ${CMAKE_COMMAND} -S ${arg_SOURCE_PATH} -B ${CURRENT_BUILDTREES_DIR} -G ${GENERATOR}
        -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_INSTALL_PREFIX=${CURRENT_PACKAGES_DIR} -D CMAKE_BUILD_TYPE=Release
        ${arg_OPTIONS} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

function(vcpkg_cmake_install)
    execute_process(COMMAND ${CMAKE_COMMAND} --install ${CURRENT_BUILDTREES_DIR} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# Moves the config files to share/<port> and removes the folder `cmake` that they were in. They find the prefix from there.
function(vcpkg_cmake_config_fixup)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "CONFIG_PATH" "")
    set(folder ${CURRENT_PACKAGES_DIR}/share/${PORT})
    file(GLOB files ${CURRENT_PACKAGES_DIR}/${arg_CONFIG_PATH}/*)
    file(COPY ${files} DESTINATION ${folder})
    cmake_path(GET arg_CONFIG_PATH PARENT_PATH parent)
    file(REMOVE_RECURSE ${CURRENT_PACKAGES_DIR}/${parent})
    set(step "get_filename_component(_IMPORT_PREFIX \"\${_IMPORT_PREFIX}\" PATH)\n")
    foreach(file IN LISTS files)
        cmake_path(GET file FILENAME name)
        file(READ ${folder}/${name} text)
        string(REPLACE "${step}${step}${step}" "${step}${step}" text "${text}")
        string(REPLACE "CMAKE_CURRENT_LIST_DIR}/../../../\"" "CMAKE_CURRENT_LIST_DIR}/../../\"" text "${text}")
        file(WRITE ${folder}/${name} "${text}")
    endforeach()
endfunction()

# Writes prefixes of the machine as `${prefix}`; there must be none.
function(vcpkg_fixup_pkgconfig)
    file(GLOB_RECURSE files ${CURRENT_PACKAGES_DIR}/*.pc)
    foreach(file IN LISTS files)
        file(READ ${file} text)
        string(FIND "${text}" ${CURRENT_PACKAGES_DIR} place)
        if(NOT place EQUAL -1)
            message(FATAL_ERROR "${file} names the folder that it is installed to")
        endif()
    endforeach()
endfunction()

function(vcpkg_install_copyright)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "FILE_LIST")
    file(COPY_FILE ${arg_FILE_LIST} ${CURRENT_PACKAGES_DIR}/share/${PORT}/copyright)
endfunction()

set(PORT genrender)
string(REPLACE "," ";" FEATURES "${FEATURES}")
set(CURRENT_PACKAGES_DIR ${PREFIX})
set(CURRENT_BUILDTREES_DIR ${PREFIX}_build)
file(REMOVE_RECURSE ${PREFIX} ${PREFIX}_build)
include(${port_folder}/portfile.cmake)

# What vcpkg asks of every package.
file(GLOB_RECURSE files RELATIVE ${PREFIX} ${PREFIX}/*)
list(FILTER files EXCLUDE REGEX
    "^include/genrender/|^share/genrender/((genrender|Find)[A-Za-z_0-9]*[.]cmake|usage|copyright)$|^share/pkgconfig/[a-z-]+[.]pc$")
if(files OR NOT EXISTS ${PREFIX}/share/genrender/genrenderConfig.cmake)
    message(FATAL_ERROR "the port: share/genrender lacks its files, or these lie elsewhere: ${files}")
endif()
