#!/bin/sh
# The readers of files under libFuzzer, one after the other: sh tests/readers/run.sh FUZZERS SEEDS SECONDS NAME...
# A line while each runs, then a table; exit 1 if there was a crash, a leak, a hang, an input that took
# too long or held too much. What was found is under FUZZERS/found; corpora are kept for the next time.
set -u
fuzzers=$1 seeds=$2 seconds=$3
shift 3
late=${READER_LATE:-10} # seconds that an input may take
mkdir -p "$fuzzers/logs"
table=$fuzzers/table
printf '%-8s %10s %9s %7s %9s %10s %7s %7s  %s\n' entry runs taken edges slowest held times share verdict >"$table"
failed=0

number() { grep -o "$1:* *[0-9]*" "$log" | tail -n 1 | grep -o '[0-9]*$'; }

# One line, rewritten on a terminal.
watch() {
    spent=0
    while kill -0 "$1" 2>/dev/null; do
        sleep 1
        spent=$((spent + 1))
        if [ -t 1 ]; then
            printf '\r%-8s %4d of %d s, %s' "$name" $spent "$seconds" "$(grep '^#' "$log" | tail -n 1 | cut -c1-60)"
        elif [ $((spent % 30)) -eq 0 ]; then
            echo "$name: $spent of $seconds s, $(grep '^#' "$log" | tail -n 1 | cut -c1-60)"
        fi
    done
    [ ! -t 1 ] || printf '\r%80s\r' ''
}

for name; do
    log=$fuzzers/logs/$name
    corpus=$fuzzers/corpus/$name found=$fuzzers/found/$name
    mkdir -p "$corpus" "$found"
    dictionary=tests/readers/dict/$name.dict
    [ -r "$dictionary" ] && dictionary=-dict=$dictionary || dictionary=
    kept=tests/readers/found/$name
    [ -d "$kept" ] || kept=
    # How much memory an input may hold is the entry's to say; these limits are only a net below it.
    nice -n 19 "$fuzzers/fuzz_$name" "$corpus" "$seeds/$name" $kept $dictionary \
        -max_total_time="$seconds" -max_len=16384 -timeout="$late" -rss_limit_mb=2048 \
        -malloc_limit_mb=512 -detect_leaks=1 -print_final_stats=1 \
        -artifact_prefix="$found/" >"$log" 2>&1 &
    child=$!
    watch $child
    wait $child
    code=$?
    verdict=clean
    if [ $code -ne 0 ]; then
        failed=$((failed + 1))
        verdict=$(grep -E 'does not hold|SUMMARY:|ERROR: ' "$log" | head -n 1 | cut -c1-100)
        verdict="FAILED (exit $code) $verdict"
    fi
    said=$(grep "^reader $name inputs" "$log" | tail -n 1)
    field() { echo "$said" | sed -n "s/.* $1 \([0-9.]*\).*/\1/p"; }
    printf '%-8s %10s %9s %7s %6s ms %7s kB %7s %7s  %s\n' "$name" "$(number stat::number_of_executed_units)" \
        "$(field taken)" "$(grep -o 'cov: [0-9]*' "$log" | tail -n 1 | cut -c6-)" "$(field slowest)" \
        "$(field held | awk '{printf "%d", $1 / 1024}')" "$(field times)" "$(field share)" "$verdict" >>"$table"
    tail -n 1 "$table"
done
echo
echo "inputs run and taken as valid, edges covered, the slowest input, the most memory held, as times an"
echo "input of 1 kB or more, and as a share of what may be held (64 times the input and a fixed amount)"
cat "$table"
[ $failed -eq 0 ] || echo "$failed of $# entries failed; inputs under $fuzzers/found, logs under $fuzzers/logs"
[ $failed -eq 0 ]
