#!/usr/bin/env bash
# The whole loop on the shipped stacks: for each its trajectory and twins begun from its first packing; all compared.
# usage: demo.sh [REPORT_FOLDER]   (./run demo builds the program first)
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
program=$root/build/release/twincell
report=${1:-$root/build/demo/report}
work=$root/build/demo
mkdir -p "$work/log"

# twin NAME STACK CELL [OPTION...]: tracks a stack and simulates its twins in the folder NAME of $work. Stacks run side
# by side instead of threads. The comparison below films the twins once for all.
twin() {
  local name=$1 stack=$2 cell=$3
  shift 3
  TWINCELL_THREADS=1 "$program" match "$here/$stack" "$here/$cell" --scene "$here/twin.toml" "$@" \
    --no-film -q -o "$work/$name" >"$work/log/$name.txt" 2>&1 ||
    { cat "$work/log/$name.txt" >&2; echo "demo: the loop failed for $name." >&2; return 1; }
}

# The films at Gamma = 2.8 begin in cycle 8, when the bed has reached its steady state; their twins do the same.
echo "demo: two heights of the bed, three drive strengths: tracking six stacks, simulating three twins of each" >&2
jobs=()
(set -e
 twin ten-layers-0.9 gamma-0.9 gamma-0.9/CELL.toml
 twin ten-layers-1.6 gamma-1.6 gamma-1.6/CELL.toml
 twin six-layers-2.8 six-layers/gamma-2.8.tif six-layers/gamma-2.8.toml --set time.discard=8) & jobs+=($!)
(set -e
 twin six-layers-0.9 six-layers/gamma-0.9.tif six-layers/gamma-0.9.toml
 twin six-layers-1.6 six-layers/gamma-1.6.tif six-layers/gamma-1.6.toml
 twin ten-layers-2.8 gamma-2.8.tif gamma-2.8.toml --set time.discard=8) & jobs+=($!)
for job in "${jobs[@]}"; do wait "$job"; done

echo "demo: filming the twins, comparing" >&2
"$program" compare --experiment "$work"/{six,ten}-layers-{0.9,1.6,2.8}/experiment.h5 \
  --simulation "$work"/{six,ten}-layers-{0.9,1.6,2.8}/simulation-{1,2,3}.h5 \
  --sweep "$here"/boundaries/{bouncing,convecting}.json -o "$report" --camera "$here/CAMERA.toml" \
  >"$work/comparison.txt" 2>"$work/log/comparison.txt" || { cat "$work/log/comparison.txt" >&2; exit 1; }
# Ten lines: what agrees, the phases, and where the report is. Onsets and single differences are in the report.
sed -n '/^Same phase/p; /^They differ/p; /really differ/p; /^  Gamma .*verdict$/,/^onset of /{/^onset of /!p}; /^report: /p' \
  "$work/comparison.txt"
