# SPDX-License-Identifier: MIT
# What `cmake --install` puts where: a prefix that can be moved afterwards and does not depend on the machine.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(genrender_config_dir ${CMAKE_INSTALL_DATADIR}/cmake/genrender)
set(genrender_pkgconfig_dir ${CMAKE_INSTALL_DATADIR}/pkgconfig)

install(TARGETS genrender EXPORT genrender_targets FILE_SET HEADERS)
install(EXPORT genrender_targets NAMESPACE genrender:: FILE genrenderTargets.cmake DESTINATION ${genrender_config_dir})

configure_package_config_file(cmake/genrenderConfig.cmake.in genrenderConfig.cmake
    INSTALL_DESTINATION ${genrender_config_dir})
write_basic_package_version_file(genrenderConfigVersion.cmake COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES
    ${CMAKE_CURRENT_BINARY_DIR}/genrenderConfig.cmake
    ${CMAKE_CURRENT_BINARY_DIR}/genrenderConfigVersion.cmake
    DESTINATION ${genrender_config_dir})

# pkg-config finds the prefix from where its file lies, unless somebody chose absolute install folders.
if(IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}" OR IS_ABSOLUTE "${CMAKE_INSTALL_DATADIR}")
    set(genrender_pc_includedir ${CMAKE_INSTALL_FULL_INCLUDEDIR})
else()
    file(RELATIVE_PATH genrender_pc_includedir
        /prefix/${genrender_pkgconfig_dir} /prefix/${CMAKE_INSTALL_INCLUDEDIR})
    set(genrender_pc_includedir "\${pcfiledir}/${genrender_pc_includedir}")
endif()
configure_file(cmake/genrender.pc.in genrender.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/genrender.pc DESTINATION ${genrender_pkgconfig_dir})
