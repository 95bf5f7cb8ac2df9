#!/bin/sh
# The numbers that commands print, by value: text against JSON, and what is made of other numbers (ratios,
# sums, shares) made again from those. sh tests/values/values.sh RAYDIFF
set -u
raydiff=$1
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0

# name, least number of values, what to run with --json FILE
compare() {
    name=$1 least=$2
    shift 2
    "$raydiff" "$@" --json "$dir/json" >"$dir/text" 2>"$dir/err"
    code=$?
    [ "$code" -le 1 ] && awk -f tests/values/flat.awk "$dir/json" >"$dir/flat" &&
        awk -v least="$least" -f tests/values/lib.awk -f "tests/values/$name.awk" "$dir/flat" "$dir/text" && return
    echo "FAILED  raydiff $* (exit $code)"
    failed=$((failed + 1))
}

small='--count 1000 --repeat 3 --threads 1'
compare check 250 check sphere:n=8 soup:n=300 --layout f32,rf16,half4 --engine cpu,fast $small
compare check 100 check soup:n=200 --layout f32,rf16 --engine all --query any $small
# Wrong answers of each kind that members as published give.
compare check 60 check soup:n=400,size=0.5 --layout rtrs_rf,rtrs_direct --engine cpu --box rtrs --tri mt_rtrs $small
compare leaks 200 leaks sphere:n=8 --engine cpu --layout f32,rf16 --count 4000 --threads 1
echo "values: $failed failed"
[ "$failed" -eq 0 ]
