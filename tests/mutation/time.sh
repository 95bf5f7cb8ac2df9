#!/bin/sh
# How long a suite takes without a mutation: sh tests/mutation/time.sh OUT SUITE
# Adds "SUITE MILLISECONDS" to OUT/times, or SUITE to OUT/red: of one that is red or skipped no mutation is seen.
set -u
out=$1 name=$2
logs=$(mktemp -d) || exit 4
trap 'rm -rf "$logs"' EXIT
command=$(sed -n "s/^$name //p" "$out/suites")
start=$(date +%s%N)
(eval "timeout 600 $command") >"$logs/log" 2>&1 </dev/null
code=$?
if [ "$code" -ne 0 ]; then
    echo "mutation: $name is left out: exit code $code without a mutation" >&2
    echo "$name" >>"$out/red"
    exit 0
fi
echo "$name $((($(date +%s%N) - start) / 1000000))" >>"$out/times"
