#!/usr/bin/env bash
# The demo gives what data_samples/demo/expected.csv says, and the report is whole.
# usage: demo_test.sh SOURCE_DIR SCRATCH
set -euo pipefail
report=$2/demo_report
said=$("$1/data_samples/demo/demo.sh" "$report")
while IFS=, read -r gamma n_l experiment simulation; do
  [ "$gamma" != gamma ] || continue
  grep -Eq "^ *$gamma(0*) .* $n_l[.]00 +$experiment +$simulation +same$" <<<"$said" ||
    { echo "Gamma = $gamma, N_l = $n_l is not $experiment / $simulation in:"; echo "$said"; exit 1; }
done <"$1/data_samples/demo/expected.csv"
[ "$(wc -l <<<"$said")" -eq 10 ] && ! grep -v '^report: ' <<<"$said" | grep -q '.\{101\}' ||
  { echo "These are not ten lines of at most 100 columns:"; echo "$said"; exit 1; }
grep -q "^report: $report/report.html$" <<<"$said"
[ -s "$report/report.html" ]
! grep -Eq '(src|href)="https?://' "$report/report.html"
for figure in phase_diagram thresholds s_k s_j; do
  for form in svg png gp dat; do [ -s "$report/figures/$figure.$form" ] || { echo "$figure.$form is missing"; exit 1; }; done
done
echo "$said"
