#!/bin/sh
# Every trial of fuzz/corpus shows what it did when it was kept: sh tests/conform/corpus.sh RAYDIFF
set -u
log=$(mktemp) || exit 4
trap 'rm -f "$log"' EXIT
"$1" replay --brief --as-expected fuzz/corpus/*.trial >"$log" 2>&1
code=$?
cat "$log"
[ "$code" -eq 0 ] || exit 1
for file in fuzz/corpus/*.trial; do
    expected=$(sed -n 's/^expect //p' "$file") state='STILL FAILS'
    [ "$expected" != clean ] || state=clean
    [ -n "$expected" ] && grep -qxF "$file: $expected: $state" "$log" || { echo "corpus: no such line of $file"; exit 1; }
done
