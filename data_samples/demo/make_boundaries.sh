#!/usr/bin/env bash
# How the simulated boundaries behind the demo's diagram were made: two searches, about a minute.
# usage: make_boundaries.sh TWINCELL   (writes boundaries/*.json beside this script; not part of the demo)
set -euo pipefail
program=$(realpath "${1:?the path of the program twincell}")
cd "$(dirname "${BASH_SOURCE[0]}")/boundaries"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
for onset in bouncing convecting; do
  "$program" sweep run "$onset.toml" -q --folder "$scratch/$onset.sweep"
  "$program" sweep collect "$onset.toml" -q --folder "$scratch/$onset.sweep" -o "$scratch/$onset.json"
  cp "$scratch/$onset.json" .
done
