include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/twincell)
install(EXPORT twincell-targets NAMESPACE twincell:: DESTINATION ${config_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/twincellConfig.cmake.in
  ${PROJECT_BINARY_DIR}/twincellConfig.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/twincellConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/twincellConfig.cmake ${PROJECT_BINARY_DIR}/twincellConfigVersion.cmake
  DESTINATION ${config_dir})
install(TARGETS twincell)
