# SPDX-License-Identifier: MIT
# An overlay port of the tree that it lies in; packaging/README.md says how to use it.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(VCPKG_BUILD_TYPE release) # There is nothing but headers.

set(components inspection evaluation c)
foreach(feature IN ITEMS scene reference)
    if(feature IN_LIST FEATURES)
        list(APPEND components ${feature})
    endif()
endforeach()
vcpkg_cmake_configure(
    SOURCE_PATH "${SOURCE_PATH}"
    OPTIONS
        -DGENRENDER_BUILD_TESTS=OFF
        -DGENRENDER_BUILD_EXAMPLES=OFF
        "-DGENRENDER_COMPONENTS=${components}"
)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH share/cmake/genrender)
vcpkg_fixup_pkgconfig()

file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
