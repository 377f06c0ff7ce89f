# SPDX-License-Identifier: MIT
# What `cmake --install` puts where: a prefix that can be moved afterwards and does not depend on the machine.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(genrender_config_dir ${CMAKE_INSTALL_DATADIR}/cmake/genrender)
set(genrender_pkgconfig_dir ${CMAKE_INSTALL_DATADIR}/pkgconfig)

# pkg-config finds the prefix from where its file lies, unless somebody chose absolute install folders.
if(IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}" OR IS_ABSOLUTE "${CMAKE_INSTALL_DATADIR}")
    set(genrender_pc_includedir ${CMAKE_INSTALL_FULL_INCLUDEDIR})
else()
    file(RELATIVE_PATH genrender_pc_includedir
        /prefix/${genrender_pkgconfig_dir} /prefix/${CMAKE_INSTALL_INCLUDEDIR})
    set(genrender_pc_includedir "\${pcfiledir}/${genrender_pc_includedir}")
endif()

# A file of targets and one for pkg-config a component; the config file gets the packages of all.
set(genrender_config_lists "set(genrender_components ${genrender_defined} ${genrender_adapters})\n")
foreach(component IN LISTS genrender_defined genrender_adapters)
    set(target genrender)
    set(genrender_pc_name genrender)
    set(genrender_pc_part "")
    set(requirements "")
    set(genrender_pc_libs "")
    if(NOT component STREQUAL "core")
        set(target genrender_${component})
        set(genrender_pc_name genrender-${component})
        set(genrender_pc_part " (${component})")
        set(requirements "genrender = ${PROJECT_VERSION}")
    endif()
    set(packages ${genrender_${component}_PACKAGES})
    if(component IN_LIST genrender_adapters)
        set(packages "") # An engine's own, which its user finds.
    endif()
    string(APPEND genrender_config_lists "set(genrender_${component}_PACKAGES ${packages})\n")
    foreach(package IN LISTS packages)
        set(least ${genrender_${package}_LEAST})
        set(mode CONFIG)
        if(genrender_${package}_MODULE)
            set(mode MODULE)
        endif()
        string(APPEND genrender_config_lists
            "set(genrender_${package}_MODE ${mode})\nset(genrender_${package}_LEAST ${least})\n")
        if(genrender_${package}_PKG_CONFIG AND least)
            list(APPEND requirements "${genrender_${package}_PKG_CONFIG} >= ${least}")
        elseif(genrender_${package}_PKG_CONFIG)
            list(APPEND requirements ${genrender_${package}_PKG_CONFIG})
        endif()
        list(APPEND genrender_pc_libs ${genrender_${package}_LIBS})
    endforeach()
    list(JOIN requirements ", " genrender_pc_requires)
    list(JOIN genrender_pc_libs " " genrender_pc_libs)

    install(TARGETS ${target} EXPORT ${target}_targets FILE_SET HEADERS)
    install(EXPORT ${target}_targets NAMESPACE genrender:: FILE genrender_${component}.cmake
        DESTINATION ${genrender_config_dir})
    configure_file(cmake/component.pc.in ${genrender_pc_name}.pc @ONLY)
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${genrender_pc_name}.pc DESTINATION ${genrender_pkgconfig_dir})
endforeach()

configure_package_config_file(cmake/genrenderConfig.cmake.in genrenderConfig.cmake
    INSTALL_DESTINATION ${genrender_config_dir} NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(genrenderConfigVersion.cmake COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES
    cmake/Findutf8proc.cmake
    ${CMAKE_CURRENT_BINARY_DIR}/genrenderConfig.cmake
    ${CMAKE_CURRENT_BINARY_DIR}/genrenderConfigVersion.cmake
    DESTINATION ${genrender_config_dir})
