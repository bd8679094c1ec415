#!/usr/bin/env bash
# Words that a reader outside this project would have to decode, and what the field says. Called by ./run lint.
# CHANGELOG.md and docs/glossary.md may name them: they say what things were called.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
words=(
  'reckon:compute' 'dearer:more expensive' 'huddle:cluster' 'whoever:(name the subject)' 'encounter:collision'
  'spool:store' 'barycentre:centre of mass' 'catch_up:advance' 'rouse:activate' 'held against:checked against'
  'is no whole number:is not a whole number' 'is no error:is not an error' 'otherwise called:called by other names'
  'usual bead:bead of median radius' 'begin anew:start over' 'begins anew:starts over' 'afresh:without history' 'hopeless:(state why)'
)
found=0
for entry in "${words[@]}"; do
  word=${entry%%:*}
  # Only whole words of prose and code; file contents, not names.
  if git grep -n -i -w -e "$word" -e "${word}s" -e "${word}ed" -- '*.hpp' '*.cpp' '*.md' ':!CHANGELOG.md' ':!docs/glossary.md' >&2; then
    echo "words: write '${entry#*:}' instead of '$word'." >&2
    found=1
  fi
done
exit $found
