# No contraction: a*b+c fused here and not there makes two spellings of one law differ in the last bit, and a
# crystal that must show exactly zero slips is sensitive to it. Measured price: 7 % of the force pass without
# friction, 18 % with. Where the fast kernel fuses, it does so by name.
add_compile_options(-ffp-contract=off)
# errno from sqrt and friends is never read.
add_compile_options(-fno-math-errno)
if(TWINCELL_NATIVE)
  add_compile_options(-march=native)
  # Highway 1.0 has vectors of Ice Lake, Zen 4 and later only if asked, and then stops where they are native.
  add_compile_definitions(HWY_WANT_AVX3_DL)
endif()
