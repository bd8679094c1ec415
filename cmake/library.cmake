include(GNUInstallDirs)

# twincell_library(NAME SOURCES ... HEADERS ... PUBLIC ... PRIVATE ...)
#   Target twincell_NAME, alias twincell::NAME. HEADERS are public interface: a file set that is installed and,
#   with CMAKE_VERIFY_INTERFACE_HEADER_SETS, compiled one by one.
function(twincell_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  add_library(twincell_${name} ${arg_SOURCES})
  add_library(twincell::${name} ALIAS twincell_${name})
  target_sources(twincell_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${arg_HEADERS})
  target_include_directories(twincell_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/twincell>)
  target_compile_features(twincell_${name} PUBLIC cxx_std_20)
  target_link_libraries(twincell_${name} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:twincell_warnings>)
  set_target_properties(twincell_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  install(TARGETS twincell_${name} EXPORT twincell-targets
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/twincell)
endfunction()
