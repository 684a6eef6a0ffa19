# SPDX-License-Identifier: MIT
# `cmake --install`: headers, libraries, the CMake package (find_package(sagitta), with COMPONENTS render for the second library)
# and pkg-config's sagitta.pc and sagitta-render.pc.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/sagitta)

install(DIRECTORY include/sagitta DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(EXPORT sagitta-targets NAMESPACE sagitta:: DESTINATION ${package_dir})
configure_package_config_file(cmake/sagitta-config.cmake.in ${PROJECT_BINARY_DIR}/sagitta-config.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sagitta-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sagitta-config.cmake ${PROJECT_BINARY_DIR}/sagitta-config-version.cmake
  DESTINATION ${package_dir})

# pkg-config files find their prefix from where they lie, so an installed tree may be moved.
file(RELATIVE_PATH pc_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" pc_prefix "${pc_prefix}")
configure_file(cmake/sagitta.pc.in sagitta.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/sagitta.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

if(TARGET sagitta-render-static)
  install(EXPORT sagitta-render-targets NAMESPACE sagitta:: DESTINATION ${package_dir})
  install(FILES cmake/RenderDependencies.cmake DESTINATION ${package_dir})
  set(pc_exr "")
  if(OPENEXR_FOUND)
    set(pc_exr ", OpenEXR")
  endif()
  configure_file(cmake/sagitta-render.pc.in sagitta-render.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/sagitta-render.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()
