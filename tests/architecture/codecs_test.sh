#!/usr/bin/env bash
# The program, the Python module and the tests do not link OpenCV's codecs, which would make every start ten times as long; the module
# that is loaded when it is needed does.
# usage: codecs_test.sh BUILD_DIR
set -euo pipefail
needs() { readelf --dynamic --wide "$1" | grep -E 'NEEDED.*libopencv_(imgcodecs|videoio)'; }
module=$1/imaging/libtwincell_codecs.so
needs "$module" >/dev/null || { echo "$module does not link the codecs" >&2; exit 1; }
for file in "$1/twincell" "$1"/python/twincell/_core*.so "$1"/tests/test_*; do
  [[ -f $file && $file != *.cmake ]] || continue
  if needs "$file"; then echo "$file links the codecs; call imaging/codecs/codecs.hpp instead" >&2; exit 1; fi
done
