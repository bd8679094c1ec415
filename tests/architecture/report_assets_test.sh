#!/usr/bin/env bash
# The bundled plotly.js is the one whose digest SOURCE.md states, and nothing that is inlined asks for another file.
# usage: report_assets_test.sh SOURCE_DIR
set -euo pipefail
cd "$1/analysis/report"
stated=$(grep -Eo '^ +[0-9a-f]{64}$' SOURCE.md | tr -d ' ')
read -r found _ < <(sha256sum plotly-basic-*.min.js)
[ "$stated" = "$found" ] || { echo "plotly-basic has digest $found, SOURCE.md states $stated"; exit 1; }
if grep -nE 'https?://|@import|url\(' page.css || grep -nE 'https?://|import\(|fetch\(|XMLHttpRequest' <(grep -v "www.w3.org/2000/svg" page.js); then
  echo "page.css and page.js must ask for nothing outside"; exit 1
fi
