#!/bin/sh
# The rows of engine embree have the speed of a plain loop of rtcIntersect1 that knows nothing of raydiff
# (fuzz/samples/engine/embree_engine.c), in one run, in turns and warm: sh tests/bench/fair.sh PATH/raydiff [quick]
# All: within 2 % in each kind of rays on three scenes, of up to five tries. quick: within 5 % on one scene.
# Exit code 77: built without Embree, or its header is not here.
set -u
raydiff=${1?} limit=0.02 rounds=41 rays=30000 tries=5
scenes='sphere:n=60;terrain:k=6;terrain:k=8'
[ "${2:-}" = quick ] && limit=0.05 rounds=15 rays=8000 scenes='terrain:k=6'
version=$(ldd "$raydiff" | sed -n 's/.*libembree\([34]\)\..*/\1/p' | head -n 1)
if [ -z "$version" ]; then
    "$raydiff" doctor 2>&1 | grep -q 'built without Embree' && { echo "SKIPPED fair: $raydiff is built without Embree"; exit 77; }
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
try=1
while :; do
    "$raydiff" bench fast --scene "$scenes" --engine "inside:$dir/plain.so" --count "$rays" --rounds "$rounds" --csv "$dir/csv" \
        >"$dir/log" 2>&1 || { cat "$dir/log"; echo 'FAILED  bench fast'; exit 1; }
    awk -F, -v limit="$limit" '
        $1 == "benchmark" { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["engine"] !~ /plain/ { next }
        {
            rows++
            for (turn = 0; turn < 2; turn++) {
                ratio = $at[turn ? "warm" : "ratio"] - 1
                far = ratio < 0 ? -ratio : ratio
                if (far > most) most = far
                if (!(far <= limit)) { print "  " $at["scene"] " " $at["rays"] (turn ? " warm" : "") ": plain is " 1 + ratio " of embree"; bad = 1 }
            }
        }
        END { printf "%d rows, at most %.1f %% apart\n", rows, 100 * most; exit bad || rows < 4 }' "$dir/csv" && break
    [ "$try" -ge "$tries" ] && { echo "FAILED  fair: in $tries tries"; exit 1; }
    try=$((try + 1))
done
echo "fair: try $try of $tries"
