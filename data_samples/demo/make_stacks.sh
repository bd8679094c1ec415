#!/usr/bin/env bash
# How the shipped stacks were made: six runs of experiment.toml, filmed by the synthetic camera.
# usage: make_stacks.sh TWINCELL   (writes stacks beside this script; needs python3-pil; not part of the demo)
set -euo pipefail
program=$(realpath "${1:?the path of the program twincell}")
cd "$(dirname "${BASH_SOURCE[0]}")"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# frames BEADS GAMMA FRAMES_PER_CYCLE CYCLES HEIGHT FIRST: simulates the laboratory's bed from cycle FIRST on and films
# HEIGHT sigma of it, into $scratch/frames.
frames() {
  rm -rf "$scratch"/*
  "$program" simulate experiment.toml -q -o "$scratch/run.h5" --set "beads.count=$1" --set "drive.gamma=$2" \
    --set "time.phases=$3" --set "time.cycles=$4" --set "time.discard=$6"
  "$program" render "$scratch/run.h5" -q -o "$scratch/frames" --seed 7 --pixels-per-sigma 12 --margin 20 \
    --max-height "$5" --electrons-per-level 400 --read-noise 0.3 --vignetting 0.06
}

# A folder of PNG files with the truth of each frame.
folder() {
  local to=$1; shift
  frames "$@"
  mkdir -p "$to"
  rm -f "$to"/*.png
  cp "$scratch"/frames/*.png "$scratch/frames/truth.csv" "$to"
}

# One TIFF file of many pages, and the description of its cell.
tiff() {
  local to=$1; shift
  frames "$@"
  mkdir -p "$(dirname "$to")"
  python3 - "$scratch/frames" "$to.tif" <<'PYTHON'
import pathlib, sys
from PIL import Image
pages = [Image.open(path) for path in sorted(pathlib.Path(sys.argv[1]).glob("frame_*.png"))]
pages[0].save(sys.argv[2], save_all=True, append_images=pages[1:], compression="tiff_adobe_deflate")
PYTHON
  cp "$scratch/frames/CELL.toml" "$to.toml"
}

# A convecting bed needs more frames a cycle: from one frame to the next no bead may move half a diameter against its
# neighbours, or no tracker can tell them apart. It is filmed from cycle 8 on, when the splash of the start is over.
folder gamma-0.9 100 0.9 20 2 13 0
folder gamma-1.6 100 1.6 20 4 16 0
tiff gamma-2.8 100 2.8 40 5 24 8
tiff six-layers/gamma-0.9 60 0.9 20 2 9 0
tiff six-layers/gamma-1.6 60 1.6 20 4 12 0
tiff six-layers/gamma-2.8 60 2.8 40 5 24 8
