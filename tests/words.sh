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
complain() { echo "words: write '$1' instead of '$2'." >&2; found=1; }
for entry in "${words[@]}"; do
  word=${entry%%:*} right=${entry#*:}
  # The word by itself, as a part of some_name, and as a part of SomeName.
  capital=${word^}
  pattern="(^|[^A-Za-z])(${word}|${capital})(s|ed)?(\$|[^a-z])|[a-z0-9]${capital}(s|ed)?(\$|[^a-z])"
  ! git grep -n -E -e "$pattern" -- '*.hpp' '*.cpp' '*.py' '*.js' '*.md' ':!*.min.js' ':!CHANGELOG.md' ':!docs/glossary.md' >&2 || complain "$right" "$word"
  ! git ls-files | grep -E -e "$pattern" >&2 || complain "$right" "$word"
done
exit $found
