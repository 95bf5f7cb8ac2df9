#!/bin/sh
# The numbers of `raydiff bench paper` and `bench special` by value, of one frame: bytes by hand, ratios from times.
# Exit code 77: nothing can draw here. sh tests/values/values_paper.sh RAYDIFF [paper special charts]
set -u
raydiff=$1
shift
. tests/values/compare.sh
skipped=0

# benchmark, least number of values, more
draw_once() {
    name=$1 least=$2
    shift 2
    "$raydiff" bench "$name" --size 16x12 --frames 1 --out "$dir/x" "$@" >"$dir/text" 2>"$dir/err"
    code=$? ran="bench $name" took=0
    # Skipped only if what is missing is named.
    [ "$code" -eq 77 ] && grep -q "vulkan: " "$dir/err" && { skipped=1; return; }
    [ "$code" -eq 0 ] || { bad "$ran: exit $code"; return; }
    cp "$dir/x.json" "$dir/json"
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat" &&
        awk -v rounds=1 -v least=10 -f tests/values/lib.awk -f tests/values/bench/rows.awk "$dir/flat" "$dir/x.csv" || bad "$name: rows of CSV"
    values "bench_$name" "$least" rounds=1 wide=$wide "$dir/text"
}
# benchmark, least number of values, more: with all columns and with those that fit 80
draw() {
    wide=1 && draw_once "$@" --wide
    wide=0 && draw_once "$@"
}
play_paper() {
    draw paper 60 --scene rtrs
    grep -q '</svg>' "$dir/x.svg" || bad 'paper: no plot'
    grep -q '"left_out": "' "$dir/json" && echo 'SKIP no Vulkan device: the performance table has no line of it'
}
# Of two scenes, of which one stands where the paper's second is looked for, each has its rows and its chart.
play_charts() {
    whole=$(realpath "$raydiff")
    mkdir -p "$dir/scenes/fetched"
    "$raydiff" scene convert sphere:n=3 "$dir/scenes/fetched/utah-teapot.obj" >"$dir/text" 2>"$dir/err" || bad 'no second scene'
    (cd "$dir" && "$whole" bench paper --size 8x6 --frames 1 --out x --svg x.svg) >"$dir/text" 2>"$dir/err"
    code=$?
    [ "$code" -eq 0 ] || bad "bench paper of two scenes: exit $code"
    [ "$(grep -o '"scene": "[^"]*"' "$dir/x.json" | sort -u | wc -l)" -eq 2 ] || bad 'paper: not the rows of two scenes'
    if grep -q '"left_out": "' "$dir/x.json"; then
        skipped=1
        return
    fi
    for chart in default teapot; do
        grep -q '</svg>' "$dir/x-$chart.svg" && [ -s "$dir/x-$chart.png" ] || bad "paper: no chart of its scene $chart"
    done
    [ "$(grep -c ': less or more time, and the ratio of times' "$dir/text")" -eq 2 ] ||
        bad 'paper: the words are not of both scenes'
}
# Both pipelines draw the same bits, or it ends with 1.
play_special() {
    wide=1 && draw_once special 30 --wide
    wide=0 && draw_once special 30 --quick # as many frames as are asked for
}

for part in ${*:-paper special}; do
    "play_$part"
    [ $skipped -eq 1 ] || [ "$part" = charts ] || all_seen "bench_$part"
done
echo "values_paper: $failed failed"
[ "$failed" -eq 0 ] || exit 1
[ $skipped -eq 0 ] || { echo 'SKIP no Vulkan device: nothing was drawn by two pipelines'; exit 77; }
