#!/usr/bin/env bash
# Runs the commands of a page of the documentation, in order, as a new user would: the indented lines that begin with a
# command. Stops at the first one that fails. `twincell` is the one on the PATH.
# usage: first_page.sh PAGE.md FOLDER   (the folder is empty or absent)
set -euo pipefail
page=$(realpath "$1")
mkdir -p "$2"
cd "$2"
commands=$(grep -E '^    (twincell|cd|mkdir) ' "$page" | sed 's/^    //')
[ "$(wc -l <<<"$commands")" -ge 8 ] || { echo "$page holds fewer than eight commands" >&2; exit 1; }
begin=$SECONDS
said=$(mktemp)
trap 'rm -f "$said"' EXIT
while IFS= read -r command <&3; do
  eval "$command" >"$said" 2>&1 </dev/null || { echo "$command: exit code $?" >&2; cat "$said" >&2; exit 1; }
done 3<<<"$commands"
[ -s twins/report/report.html ] || { echo "$page: twins/report/report.html is missing at the end" >&2; exit 1; }
echo "$(wc -l <<<"$commands") commands of $(basename "$page") in $((SECONDS - begin)) s"
