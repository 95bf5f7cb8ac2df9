#!/bin/sh
# How long a suite takes without a mutation: sh tests/mutation/time.sh OUT SUITE
# Adds "SUITE MILLISECONDS" to OUT/times, or SUITE to OUT/red: of one that is red or skipped no mutation is seen.
# They are those of processors, for what runs beside it must not say which suites a mutation meets.
set -u
out=$1 name=$2
logs=$(mktemp -d) || exit 4
trap 'rm -rf "$logs"' EXIT
command=$(sed -n "s/^$name //p" "$out/suites")
(eval "timeout 600 $command") >"$logs/log" 2>&1 </dev/null
code=$?
if [ "$code" -ne 0 ]; then
    echo "mutation: $name is left out: exit code $code without a mutation" >&2
    echo "$name" >>"$out/red"
    exit 0
fi
times >"$logs/times" # its second line is what the children took: 1m2.34s 0m0.56s
echo "$name $(awk 'NR == 2 { for (i = 1; i <= 2; i++) { split($i, part, /[ms]/); sum += 60 * part[1] + part[2] }
    printf "%.0f", 1000 * sum + 1 }' "$logs/times")" >>"$out/times"
