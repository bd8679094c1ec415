include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/twincell)
install(EXPORT twincell-targets NAMESPACE twincell:: DESTINATION ${config_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/twincellConfig.cmake.in
  ${PROJECT_BINARY_DIR}/twincellConfig.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/twincellConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/twincellConfig.cmake ${PROJECT_BINARY_DIR}/twincellConfigVersion.cmake
  DESTINATION ${config_dir})
install(TARGETS twincell)

# Manual pages and completion come from the program itself.
install(CODE "
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/manual)
  set(program $<TARGET_FILE:twincell>)
  execute_process(COMMAND \${program} man -q -o ${PROJECT_BINARY_DIR}/manual/man1 OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  foreach(shell bash zsh fish)
    execute_process(COMMAND \${program} completion \${shell} OUTPUT_FILE ${PROJECT_BINARY_DIR}/manual/\${shell} COMMAND_ERROR_IS_FATAL ANY)
  endforeach()")
install(DIRECTORY ${PROJECT_BINARY_DIR}/manual/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} FILES_MATCHING PATTERN "*.1")
install(FILES ${PROJECT_BINARY_DIR}/manual/bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME twincell)
install(FILES ${PROJECT_BINARY_DIR}/manual/zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions RENAME _twincell)
install(FILES ${PROJECT_BINARY_DIR}/manual/fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d RENAME twincell.fish)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN "reproduce" EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/CITATION.cff
  DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
# What `twincell example` copies; the other samples need the source.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data_samples/example DESTINATION ${CMAKE_INSTALL_DATADIR}/twincell/data_samples)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data_samples/demo/gamma-0.9 ${PROJECT_SOURCE_DIR}/data_samples/demo/gamma-1.6
  DESTINATION ${CMAKE_INSTALL_DATADIR}/twincell/data_samples/demo)
install(FILES ${PROJECT_SOURCE_DIR}/data_samples/demo/twin.toml DESTINATION ${CMAKE_INSTALL_DATADIR}/twincell/data_samples/demo)
install(FILES ${PROJECT_SOURCE_DIR}/data_samples/vibrated-gas/own.csv
  DESTINATION ${CMAKE_INSTALL_DATADIR}/twincell/data_samples/vibrated-gas)
