#!/usr/bin/env bash
# The whole loop on the shipped stacks: for each its trajectory and twins begun from its first packing; all compared.
# usage: demo.sh [REPORT_FOLDER]   (./run demo builds the program first)
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
program=$root/build/release/twincell
report=${1:-$root/build/demo/report}
work=$root/build/demo
mkdir -p "$work"

experiments=() simulations=() jobs=()
for gamma in 0.9 1.6 2.5; do
  echo "demo: Gamma = $gamma: tracking the frames, then simulating their twins" >&2
  # One stack per core instead of threads. The comparison below films the twins once for all.
  TWINCELL_THREADS=1 "$program" match "$here/gamma-$gamma" "$here/gamma-$gamma/CELL.toml" --scene "$here/twin.toml" \
    --no-film -q -o "$work/gamma-$gamma" >"$work/log-$gamma.txt" 2>&1 &
  jobs+=("$!:$gamma")
  experiments+=("$work/gamma-$gamma/experiment.h5")
  simulations+=("$work/gamma-$gamma"/simulation-{1,2,3}.h5)
done
for job in "${jobs[@]}"; do
  wait "${job%%:*}" || { cat "$work/log-${job#*:}.txt" >&2; echo "demo: the loop failed at Gamma = ${job#*:}." >&2; exit 1; }
done

echo "demo: filming the twins, comparing" >&2
"$program" compare --experiment "${experiments[@]}" --simulation "${simulations[@]}" \
  --sweep "$here"/boundaries/{bouncing,convecting}.json -o "$report" --camera "$here/CAMERA.toml" \
  >"$work/comparison.txt" 2>"$work/log-comparison.txt" || { cat "$work/log-comparison.txt" >&2; exit 1; }
# The conclusion, the phases and where the report is; onsets and single differences are in the report.
sed '/^onset of /,/other numbers/d' "$work/comparison.txt"
