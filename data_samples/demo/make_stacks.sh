#!/usr/bin/env bash
# How the shipped stacks were made: three runs of experiment.toml, filmed by the synthetic camera.
# usage: make_stacks.sh TWINCELL   (writes frames into gamma-*/ beside this script; not part of the demo)
set -euo pipefail
program=$(realpath "${1:?the path of the program twincell}")
cd "$(dirname "${BASH_SOURCE[0]}")"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# name, Gamma, frames per cycle, cycles, height filmed (sigma). A convecting bed needs more frames a cycle: from one
# frame to the next no bead may move half a diameter against its neighbours, or no tracker can tell them apart.
film() {
  "$program" simulate experiment.toml -q -o "$scratch/$1.h5" --set "drive.gamma=$2" --set "time.phases=$3" --set "time.cycles=$4"
  "$program" render "$scratch/$1.h5" -q -o "$scratch/$1" --seed 7 --pixels-per-sigma 12 --margin 20 --max-height "$5" \
    --electrons-per-level 400 --read-noise 0.3 --vignetting 0.06
  rm -f "$1"/*.png
  cp "$scratch/$1"/*.png "$scratch/$1/truth.csv" "$1"
}
film gamma-0.9 0.9 20 2 13
film gamma-1.6 1.6 20 4 16
film gamma-2.5 2.5 48 5 22
