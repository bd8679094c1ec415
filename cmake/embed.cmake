# twincell_embed(TARGET NAME FILE): the text of FILE becomes `extern const std::string_view twincell::FOLDER::embedded::NAME` of
# TARGET. FOLDER is the current one.
function(twincell_embed target name file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  get_filename_component(folder ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded_${name}.cpp)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/embedded.cpp.in ${source} @ONLY)
  target_sources(${target} PRIVATE ${source})
endfunction()
