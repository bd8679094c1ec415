include(GNUInstallDirs)

# twincell_library(NAME ROOMS folder... INTERFACES header... PUBLIC ... PRIVATE ...)
#   Target twincell_NAME, alias twincell::NAME, of every .cpp in the rooms, folders below the current one ("." is the
#   folder itself). INTERFACES are the headers that are installed, relative to the current folder; each may include
#   only installed headers (tests/architecture). With CMAKE_VERIFY_INTERFACE_HEADER_SETS they are compiled one by one.
function(twincell_library name)
  cmake_parse_arguments(arg "" "" "ROOMS;INTERFACES;PUBLIC;PRIVATE" ${ARGN})
  set(patterns)
  foreach(room IN LISTS arg_ROOMS)
    list(APPEND patterns ${CMAKE_CURRENT_SOURCE_DIR}/${room}/*.cpp)
  endforeach()
  file(GLOB sources CONFIGURE_DEPENDS ${patterns})
  add_library(twincell_${name} ${sources})
  add_library(twincell::${name} ALIAS twincell_${name})
  target_sources(twincell_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${arg_INTERFACES})
  target_include_directories(twincell_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/twincell>)
  target_compile_features(twincell_${name} PUBLIC cxx_std_20)
  target_link_libraries(twincell_${name} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:twincell_warnings>)
  set_target_properties(twincell_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  install(TARGETS twincell_${name} EXPORT twincell-targets
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/twincell)
endfunction()

# twincell_orchestrates(TARGET): the target calls what takes the time and takes none itself. Release builds compile it with
# -Og, which saves half of its compile time.
function(twincell_orchestrates target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Og>)
endfunction()

# twincell_in_batches(TARGET [alone...]): compiles the target's files eight at a time, but for those named. They spend most of
# their time on the templates of the same libraries, which are then read once in eight; but one changed file costs its whole
# batch. A name in an unnamed namespace must differ from those of the other files. Files that include themselves once per
# vector instruction set (Highway) must be named. Debug builds compile each file by itself.
function(twincell_in_batches target)
  if(NOT CMAKE_BUILD_TYPE STREQUAL Debug)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
endfunction()

# twincell_reads_once(TARGET header...): the headers that most files of the target include, and those of the standard library
# and fmt, are compiled once for all of them, which saves a quarter of the compile time. A file still includes what it
# uses: the presets dev and tidy compile without.
function(twincell_reads_once target)
  target_precompile_headers(${target} PRIVATE <fmt/format.h> <algorithm> <array> <cmath> <cstdint> <filesystem> <functional>
    <map> <memory> <optional> <span> <sstream> <string> <string_view> <unordered_map> <vector> ${ARGN})
endfunction()
