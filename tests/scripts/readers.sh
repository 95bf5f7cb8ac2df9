#!/bin/sh
# The readers of files without a fuzzer: every entry plays its seeds and all that was ever found. Each
# must take an input and refuse one, or its seeds show nothing: sh tests/scripts/readers.sh BUILD
set -u
build=$1
bad=0
for source in tests/readers/entry_*.c; do
    name=$(basename "$source" .c)
    name=${name#entry_}
    kept=tests/readers/found/$name
    [ -d "$kept" ] || kept=
    log=$build/readers/$name.log
    large=$build/readers/seeds/large/$name
    [ -d "$large" ] || large=
    "$build/readers/$name" "$build/readers/seeds/$name" $large $kept >"$log" 2>&1
    code=$?
    said=$(grep "^reader $name inputs" "$log")
    if [ $code -ne 0 ] || [ -z "$said" ]; then
        echo "$name: exit code $code; the last lines of $log:"
        tail -n 3 "$log"
        bad=1
        continue
    fi
    echo "$said"
    inputs=$(echo "$said" | sed 's/.* inputs \([0-9]*\) .*/\1/')
    taken=$(echo "$said" | sed 's/.* taken \([0-9]*\) .*/\1/')
    if [ "$taken" -eq 0 ] || { [ "$name" != play ] && [ "$taken" -eq "$inputs" ]; }; then
        echo "$name: $taken of $inputs seeds are taken: some must be, and some must not"
        bad=1
    fi
done
exit $bad
