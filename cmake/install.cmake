include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/twincell)
install(EXPORT twincell-targets NAMESPACE twincell:: DESTINATION ${config_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/twincellConfig.cmake.in
  ${PROJECT_BINARY_DIR}/twincellConfig.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/twincellConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/twincellConfig.cmake ${PROJECT_BINARY_DIR}/twincellConfigVersion.cmake
  DESTINATION ${config_dir})
install(TARGETS twincell)
# What `twincell example` copies; the other samples need the source.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data_samples/example DESTINATION ${CMAKE_INSTALL_DATADIR}/twincell/data_samples)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data_samples/demo/gamma-0.9 ${PROJECT_SOURCE_DIR}/data_samples/demo/gamma-1.6
  DESTINATION ${CMAKE_INSTALL_DATADIR}/twincell/data_samples/demo)
install(FILES ${PROJECT_SOURCE_DIR}/data_samples/demo/twin.toml DESTINATION ${CMAKE_INSTALL_DATADIR}/twincell/data_samples/demo)
install(FILES ${PROJECT_SOURCE_DIR}/data_samples/vibrated-gas/own.csv
  DESTINATION ${CMAKE_INSTALL_DATADIR}/twincell/data_samples/vibrated-gas)
