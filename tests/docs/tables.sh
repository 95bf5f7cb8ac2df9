#!/bin/sh
# Tables of measurements in the documents are what is recorded (tests/docs/tables.pl), and a changed digit in any of their
# rows is noticed: sh tests/docs/tables.sh
set -u
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0 changed=0
perl tests/docs/tables.pl || failed=1
cp docs/results.md docs/errors.md docs/paper.md "$dir"
for page in results errors paper; do
    # Rows with a fraction; that of frames of two lines is not recorded.
    for row in $(grep -nE '^\| .*[0-9]\.[0-9]' "docs/$page.md" | grep -v 'another look' | cut -d: -f1); do
        perl -pe 's/(\d)(?=\D*$)/($1 + 5) % 10/e if $. == '"$row" "docs/$page.md" >"$dir/$page.md"
        cmp -s "docs/$page.md" "$dir/$page.md" && { echo "FAILED  docs/$page.md:$row: no digit"; failed=1; }
        perl tests/docs/tables.pl "$dir" >/dev/null && { echo "FAILED  docs/$page.md:$row: a changed digit is not noticed"; failed=1; }
        changed=$((changed + 1))
    done
    cp "docs/$page.md" "$dir"
done
# Bugs that a page names are planted, and explained as it has it.
for row in $(sed -nE 's/^\| [a-zA-Z].*#[0-9]+ \|.*\| (`[A-Z].*)\|$/\1/p' docs/reported-bugs.md | tr -d ' ' | sed 's/`,`/,/; s/`//g'); do
    cause=$(echo "$row" | cut -d'|' -f2 | sed 's/;.*//')
    first=
    for bug in $(echo "$row" | cut -d'|' -f1 | tr , ' '); do
        record=$(cat tests/planted/*.txt | sed -n "/^bug $bug:/,/^\$/p")
        [ -n "$record" ] || { echo "FAILED  docs/reported-bugs.md: $bug is not planted"; failed=1; }
        case $cause in notplayed*) continue ;; esac
        first=${first:-$bug}
        [ "$bug" != "$first" ] || echo "$record" | grep -qE "^caught explain [^ ]+ $cause " ||
            { echo "FAILED  docs/reported-bugs.md: $bug is not explained as $cause"; failed=1; }
    done
    reported=$((${reported:-0} + 1))
done
[ "${reported:-0}" -ge 9 ] || { echo "FAILED  docs/reported-bugs.md: ${reported:-0} rows"; failed=1; }
echo "tables: $changed rows changed by a digit"
[ "$failed" -eq 0 ] && [ "$changed" -ge 90 ]
