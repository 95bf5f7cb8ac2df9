#!/bin/sh
# The numbers of `raydiff bench` by value: the text against JSON and CSV, ratios, sums and shares made anew from what
# they are made of, bytes and counts against other commands. sh tests/values/values_bench.sh RAYDIFF [BENCHMARK...]
# No speed is expected. Of one round a ratio is that of two speeds, and of two a median is the mean.
set -u
raydiff=$1
shift
. tests/values/compare.sh

# benchmark, least number of values, rounds, arguments: bench_NAME.awk and rows.awk
bench() {
    name=$1 least=$2 rounds=$3
    shift 3
    run bench "$name" "$@" --rounds "$rounds" --json "$dir/json" --csv "$dir/csv" && rows "$name" "$rounds" &&
        values "bench_$name" "$least" $(ls "$dir"/other.flat 2>/dev/null) "$dir/text"
}
# benchmark, rounds: CSV against JSON
rows() {
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat" &&
        awk -v rounds="$2" -v least=10 -f tests/values/lib.awk -f tests/values/rows.awk "$dir/flat" "$dir/csv" || bad "$1: rows of CSV"
}
# Another command's JSON for the checks that follow.
other() {
    run "$@" --json "$dir/other.json" && awk -f tests/values/flat.awk "$dir/other.json" >"$dir/other.flat"
}

# Engines of the GPU where there is one; the rest is the processor's.
play_layouts() {
    scenes='sphere:n=6;soup:n=150'
    other check sphere:n=6 soup:n=150 --layout f32,rf16 --engine cpu --rays bounce --count 400 --repeat 1 --threads 1
    for rounds in 1 2; do
        bench layouts 300 "$rounds" --scene "$scenes" --count 400 --threads 1 --driver hardware
    done
}

for part in ${*:-layouts}; do
    rm -f "$dir/other.flat"
    "play_$part"
    all_seen "bench_$part"
done
echo "values_bench: $failed failed"
[ "$failed" -eq 0 ]
