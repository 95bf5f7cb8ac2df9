#!/bin/sh
# The rows of engine embree have the speed of a plain loop of rtcIntersect1 that knows nothing of raydiff
# (fuzz/samples/engine/embree_engine.c), in one run, in turns and warm: sh tests/bench/fair.sh PATH/raydiff [quick]
# All: of seven runs, in each of which both make their trees anew, the median of each kind of rays is within 5 % on
# three scenes, and the mean over kinds within 2 %: where a tree lies in memory is worth some percent to one of them.
# quick: one run, of up to five tries, on one scene: each kind within 8 %, the mean within 4 %.
# Exit code 77: built without Embree, or its header is not here.
set -u
raydiff=${1?} quick=${2:-} rounds=21 rays=30000
scenes='sphere:n=60;terrain:k=6;terrain:k=7'
each=0.05 mean=0.02
[ "$quick" = quick ] && each=0.08 mean=0.04 rounds=11 scenes='terrain:k=6'
doctor=$("$raydiff" doctor 2>&1)
version=$(echo "$doctor" | sed -n 's/^ *Embree \([34]\)\..*/\1/p' | head -n 1)
if [ -z "$version" ]; then
    echo "$doctor" | grep -q 'built without Embree' && { echo "SKIPPED fair: $raydiff is built without Embree"; exit 77; }
    echo "FAILED  fair: $raydiff has no Embree, and does not say so"
    exit 1
fi
[ -e "/usr/include/embree$version/rtcore.h" ] || { echo "SKIPPED fair: no embree$version/rtcore.h"; exit 77; }
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
cc -O2 -std=c11 -Wall -Wextra -shared -fPIC -I. -DEMBREE="$version" -o "$dir/plain.so" fuzz/samples/engine/embree_engine.c \
    "-lembree$version" || { echo 'FAILED  the sample does not compile'; exit 1; }
# Its answers are Embree's own.
"$raydiff" check sphere:n=20 --engine embree,"inside:$dir/plain.so" --query closest,any --count 2000 --repeat 1 --json "$dir/json" \
    >"$dir/log" 2>&1 || { cat "$dir/log"; echo 'FAILED  the plain loop has wrong answers'; exit 1; }
# Runs in $dir/csv.*: prints what is too far apart, and how far that is; fails if anything is.
near() {
    cat "$dir"/csv.* | awk -F, -v each=$each -v mean=$mean '
        $1 == "benchmark" { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["engine"] ~ /plain/ {
            for (turn = 0; turn < 2; turn++) {
                key = $at["scene"] (turn ? ", warm" : ", in turns") "\t" $at["rays"]
                ratio[key, ++runs[key]] = $at[turn ? "warm" : "ratio"]
            }
        }
        function far(x) { return x > 1 ? x - 1 : 1 - x }
        function told(what, x, limit) {
            if (far(x) > most[limit]) most[limit] = far(x)
            if (!(far(x) <= limit)) { print "  " what ": plain is " x " of embree"; bad = 1 }
        }
        END {
            for (key in runs) {
                n = runs[key]
                for (i = 1; i <= n; i++) { # the median: as many below as above
                    below = 0
                    for (k = 1; k <= n; k++) below += ratio[key, k] < ratio[key, i] || (ratio[key, k] == ratio[key, i] && k < i)
                    if (below == int(n / 2)) median = ratio[key, i]
                }
                split(key, part, "\t")
                told(part[1] ", " part[2], median, each)
                sum[part[1]] += log(median)
                kinds[part[1]]++
                rows++
            }
            for (row in sum) told(row ", mean", exp(sum[row] / kinds[row]), mean)
            printf "%d medians, at most %.1f %% apart; means %.1f %%\n", rows, 100 * most[each], 100 * most[mean]
            exit bad || rows < 8
        }'
}
run() { # number
    "$raydiff" bench fast --scene "$scenes" --engine "inside:$dir/plain.so" --count "$rays" --rounds "$rounds" --csv "$dir/csv.$1" \
        >"$dir/log" 2>&1 || { cat "$dir/log"; echo 'FAILED  bench fast'; exit 1; }
}
for try in 1 2 3 4 5 6 7; do
    if [ "$quick" = quick ]; then
        run 1
        near && exit 0
        [ "$try" -lt 5 ] || break
    else
        run "$try"
    fi
done
[ "$quick" != quick ] && near && exit 0
echo 'FAILED  fair'
exit 1
