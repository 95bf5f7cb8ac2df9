#!/bin/sh
# The readers of files under AFL++: sh tests/readers/afl.sh FUZZERS SEEDS SECONDS NAME...
# A row per entry; exit 1 if there was a crash or a hang. AFL++ keeps its queue and what it found under
# FUZZERS/out/NAME and goes on from there the next time.
set -u
fuzzers=$1 seeds=$2 seconds=$3
shift 3
mkdir -p "$fuzzers/out" "$fuzzers/logs"
# Containers cannot change how cores are dumped or clocked; hangs count, once they are certain.
export AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES=1 AFL_SKIP_CPUFREQ=1 AFL_NO_UI=1 AFL_NO_AFFINITY=1
export AFL_AUTORESUME=1 AFL_HANG_TMOUT=10000
printf '%-8s %10s %9s %9s %8s %6s\n' entry runs runs/s coverage crashes hangs
failed=0
for name; do
    out=$fuzzers/out/$name
    dictionary=tests/readers/dict/$name.dict
    [ -r "$dictionary" ] && dictionary="-x $dictionary" || dictionary=
    nice -n 19 afl-fuzz -i "$seeds/$name" -o "$out" $dictionary -V "$seconds" -m none -t 2000 \
        -- "$fuzzers/fuzz_$name" >"$fuzzers/logs/$name" 2>&1
    stats=$out/default/fuzzer_stats
    if [ ! -r "$stats" ]; then
        echo "$name: afl-fuzz did not start:"
        tail -n 8 "$fuzzers/logs/$name"
        failed=$((failed + 1))
        continue
    fi
    field() { awk -F' *: *' -v key="$1" '$1 == key { print $2 }' "$stats"; }
    printf '%-8s %10s %9s %9s %8s %6s\n' "$name" "$(field execs_done)" "$(field execs_per_sec)" \
        "$(field bitmap_cvg)" "$(field saved_crashes)" "$(field saved_hangs)"
    [ "$(field saved_crashes)" = 0 ] && [ "$(field saved_hangs)" = 0 ] || failed=$((failed + 1))
done
[ $failed -eq 0 ] || echo "$failed of $# entries failed; see $fuzzers/out"
[ $failed -eq 0 ]
