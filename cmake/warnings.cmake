# Linked privately by our own targets and never exported: a user's compiler flags are the user's.
# -Wnull-dereference is left out: at -O3 g++ 12 sees null behind std::vector. So are -Wstringop-overflow and -Wrestrict, which it
# sees in std::string, and reports where <string> is precompiled. clang-tidy looks for the real ones.
add_library(twincell_warnings INTERFACE)
target_compile_options(twincell_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual
  -Wdouble-promotion -Wformat=2 -Wimplicit-fallthrough -Wunused
  $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow> $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  -Wno-missing-field-initializers)  # designated initialisers name what they set
# Errors only where a preset asks: a newer compiler must not break a user's build, and under the sanitizers g++ 12
# believes that std::regex reads what was never set.
option(TWINCELL_WERROR "Treat warnings as errors" OFF)
if(TWINCELL_WERROR)
  target_compile_options(twincell_warnings INTERFACE -Werror)
endif()
