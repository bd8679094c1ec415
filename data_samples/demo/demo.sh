#!/usr/bin/env bash
# The whole loop on the shipped stacks: frames -> trajectory; twin from the first packing; both compared.
# usage: demo.sh [REPORT_FOLDER]   (./run demo builds the program first)
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
program=$root/build/release/twincell
report=${1:-$root/build/demo/report}
work=$root/build/demo
mkdir -p "$work"
export TWINCELL_THREADS=1  # one stack per core instead

# Gamma, frames per cycle and cycles of each shipped stack.
stacks=("0.9 20 2" "1.6 20 4" "2.5 48 5")

twin_of() {
  local gamma=$1 phases=$2 cycles=$3 stack=$here/gamma-$1
  "$program" track "$stack" --cell "$stack/CELL.toml" -q -o "$work/experiment-$gamma.h5"
  "$program" simulate "$here/twin.toml" -q -o "$work/simulation-$gamma.h5" --set "start.from=$work/experiment-$gamma.h5" \
    --set "drive.gamma=$gamma" --set "time.phases=$phases" --set "time.cycles=$cycles"
}

experiments=() simulations=() jobs=()
for stack in "${stacks[@]}"; do
  read -r gamma phases cycles <<<"$stack"
  echo "demo: Gamma = $gamma: tracking $((phases * cycles)) frames, then simulating their twin" >&2
  twin_of "$gamma" "$phases" "$cycles" >"$work/log-$gamma.txt" 2>&1 &
  jobs+=("$!:$gamma")
  experiments+=("$work/experiment-$gamma.h5")
  simulations+=("$work/simulation-$gamma.h5")
done
for job in "${jobs[@]}"; do
  wait "${job%%:*}" || { cat "$work/log-${job#*:}.txt" >&2; echo "demo: the loop failed at Gamma = ${job#*:}." >&2; exit 1; }
done

echo "demo: comparing" >&2
"$program" compare --experiment "${experiments[@]}" --simulation "${simulations[@]}" -q -o "$report"
