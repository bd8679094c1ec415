# twincell_device_code(TARGET): compiles the device kernels to PTX and embeds the text in TARGET. clang does so without the
# CUDA toolkit. Where there is no clang for this, the program is built all the same, and `--device gpu` says so.
set(TWINCELL_DEVICE AUTO CACHE STRING "Device code for graphics cards: AUTO (where clang can compile it), ON or OFF")

# Inlined, a kernel keeps the numbers of a contact in registers. No contraction and no errno: see floating_point.cmake.
set(device_options -x cuda --cuda-device-only -nocudainc -nocudalib --cuda-gpu-arch=sm_70 -Wno-unknown-cuda-version
  -Xclang -fcuda-allow-variadic-functions -Xclang -target-feature -Xclang +ptx63 -std=c++20 -S -O3 -ffp-contract=off -fno-math-errno -mllvm -inline-threshold=100000)

function(twincell_find_device_compiler)
  if(TWINCELL_DEVICE STREQUAL "OFF")
    return()
  endif()
  find_program(TWINCELL_DEVICE_CLANG NAMES clang++ clang++-19 clang++-18 clang++-17 clang++-16 clang++-15 clang++-14)
  if(TWINCELL_DEVICE_CLANG AND NOT DEFINED CACHE{TWINCELL_DEVICE_CLANG_WORKS})
    set(probe ${CMAKE_CURRENT_BINARY_DIR}/device_probe)
    file(WRITE ${probe}.cu "#include <string>\n__attribute__((global)) void f(double* x) { *x = __builtin_fma(*x, *x, *x); }\n")
    execute_process(COMMAND ${TWINCELL_DEVICE_CLANG} ${device_options} ${probe}.cu -o ${probe}.ptx
      RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
    if(result EQUAL 0)
      set(TWINCELL_DEVICE_CLANG_WORKS ON CACHE INTERNAL "clang compiles device code")
    endif()
  endif()
  if(NOT TWINCELL_DEVICE_CLANG_WORKS)
    if(TWINCELL_DEVICE STREQUAL "ON")
      message(FATAL_ERROR "TWINCELL_DEVICE is ON, but no clang++ that compiles for NVPTX was found.")
    endif()
    message(STATUS "Device code: off, no clang++ that compiles for NVPTX was found (Debian: clang)")
  endif()
endfunction()

function(twincell_device_code target)
  set(here ${CMAKE_CURRENT_SOURCE_DIR}/device)
  set(there ${CMAKE_CURRENT_BINARY_DIR}/device_code)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${here}/device_laws.hpp)
  set(texts "")
  set(declarations "")
  set(list "")
  set(outputs "")
  twincell_find_device_compiler()
  if(TWINCELL_DEVICE_CLANG_WORKS AND NOT TWINCELL_DEVICE STREQUAL "OFF")
    file(MAKE_DIRECTORY ${there})
    file(READ ${here}/device_laws.hpp laws)
    string(REGEX MATCHALL "\n  X\\([a-z_]+, [A-Za-z]+, [A-Za-z]+\\)" rows "${laws}")
    foreach(row IN LISTS rows)
      string(REGEX MATCH "X\\(([a-z_]+), ([A-Za-z]+), ([A-Za-z]+)\\)" row "${row}")
      set(name ${CMAKE_MATCH_1})
      set(ptx ${there}/${name}.ptx)
      add_custom_command(OUTPUT ${ptx}
        COMMAND ${TWINCELL_DEVICE_CLANG} ${device_options} -I${PROJECT_SOURCE_DIR} -DTWINCELL_NAME=${name}
          -DTWINCELL_NORMAL=${CMAKE_MATCH_2} -DTWINCELL_TANGENTIAL=${CMAKE_MATCH_3}
          -MD -MF ${ptx}.d -MT ${ptx} ${here}/device_kernels.cu -o ${ptx}
        DEPENDS ${here}/device_kernels.cu DEPFILE ${ptx}.d COMMENT "Compiling device code ${name}" VERBATIM)
      list(APPEND outputs ${ptx})
      string(APPEND texts "twincell_ptx_${name}: .incbin \"${ptx}\"\n.byte 0\n")
      string(APPEND declarations "extern \"C\" const char twincell_ptx_${name}[];\n")
      string(APPEND list "twincell_ptx_${name}, ")
    endforeach()
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/device_code.cpp.in ${there}.cpp @ONLY)
  set_source_files_properties(${there}.cpp PROPERTIES OBJECT_DEPENDS "${outputs}")
  target_sources(${target} PRIVATE ${there}.cpp)
endfunction()
