#!/usr/bin/env bash
# Installs the build tree into a scratch folder and builds a program that knows only find_package(twincell).
# usage: install_test.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install "$1" --prefix "$scratch/prefix" >/dev/null
cmake -S "$2/tests/architecture/outside_program" -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$scratch/prefix" \
  -DCMAKE_BUILD_TYPE=Release >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
cmake --build "$scratch/build" >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
"$scratch/build/outside" "$2/data_samples/demo/gamma-1.6"
"$scratch/prefix/bin/twincell" --version
"$scratch/prefix/bin/twincell" example "$scratch/example" >/dev/null
diff -r "$scratch/prefix/share/twincell/data_samples/demo/gamma-1.6" "$scratch/example/frames"
# Pictures are decoded by a module of the installation.
readelf --dynamic "$scratch/prefix/bin/twincell" | grep RUNPATH | grep -q "$1" && { echo "the installed program refers to the build folder" >&2; exit 1; }
"$scratch/prefix/bin/twincell" info "$scratch/example/frames" >/dev/null
