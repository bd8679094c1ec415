#!/usr/bin/env bash
# The kernels compiled for AVX2 and AVX-512 must share no function with the rest of the program: of an inline function that
# both emit, the linker keeps one copy, and a processor without those instructions would meet them anywhere.
# Usage: vector_objects_test.sh BUILD_FOLDER
set -euo pipefail
objects=$(find "$1/sim" -name 'kernels_avx*.o')
for set in avx2 avx512; do
  [ -n "$(grep "/kernels_$set[^/]*$" <<<"$objects")" ] || { echo "no object of the $set kernels is under $1/sim"; exit 1; }
done
others=$(find "$1" -name '*.o' ! -name 'kernels_avx*.o' ! -path '*/tests/*')
shared=$(comm -12 \
  <(nm --defined-only $objects | awk '$2 ~ /^[WVu]$/ {print $3}' | sort -u) \
  <(nm --defined-only $others | awk '$2 ~ /^[WVuTDBR]$/ {print $3}' | sort -u) | c++filt)
if [ -n "$shared" ]; then
  echo "defined in a vector object and elsewhere:"
  echo "$shared"
  exit 1
fi
echo "$(nm --defined-only $objects | awk '$2 ~ /^[WVu]$/' | wc -l) weak symbols in the vector objects, none of them elsewhere"
