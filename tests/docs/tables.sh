#!/bin/sh
# Tables of measurements in the documents are what is recorded (tests/docs/tables.pl), and a changed digit in any of their
# rows is noticed: sh tests/docs/tables.sh
set -u
failed=0
perl tests/docs/tables.pl --each || failed=1
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
[ "$failed" -eq 0 ]
