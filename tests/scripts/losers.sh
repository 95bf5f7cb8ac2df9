#!/bin/sh
# Black boxes in campaigns: one that loses what lies beside edges fails over all trials together, a
# published test never does.
#   sh tests/scripts/losers.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh
secret='s/q.rays, 1, 0, /q.rays, 0, 0, /'
band='s/u >= 0.0f \&\& v >= 0.0f/u >= 9e-7f * size \&\& v >= 9e-7f * size/'
sed "$secret" fuzz/samples/sample_tracer.c >"$dir/honest.c"
sed "$secret; $band" fuzz/samples/sample_tracer.c >"$dir/loser.c"
for who in honest loser; do
    cc -O2 -o "$dir/$who" "$dir/$who.c" || exit 4
done
honest="pipe:$dir/honest" loser="pipe:$dir/loser"
campaign='--rays 500 --corpus none --seed 5'
lost='answered 800 trials, .*lost beside edges [0-9]+ of [0-9]+ .at most'

# No answer is WRONG, all of them together are not rounding; which a second run does not forget.
expect 1 . fuzz --trials 800 $campaign --engine "$loser" --dir "$dir/f" --json "$dir/f.json" --jsonl "$dir/f.jsonl" --tap "$dir/f.tap"
grep -q '^findings   0 distinct' "$dir/out" || bad "fuzz: the loser is found by single answers"
grep -qE "$lost" "$dir/out" || bad "fuzz: what was lost beside edges is not counted"
grep -q '"loses": "it loses more hits beside edges' "$dir/f.json" || bad "fuzz --json: no word of it"
grep -q 'loses more hits beside edges' "$dir/f.jsonl" || bad "fuzz --jsonl: no word of it"
grep -q '^not ok .*played' "$dir/f.tap" || bad "fuzz --tap: the loser passes"
expect 1 . fuzz --trials 800 $campaign --engine "$loser" --dir "$dir/f"
grep -qE "$lost" "$dir/out" || bad "fuzz: a second run forgets what was lost"
expect 0 . fuzz --trials 800 $campaign --engine "$honest" --dir "$dir/h"
grep -q 'beside edges' "$dir/out" && bad "fuzz: a published test loses too much"

# conform judges with the displacement that is given: with one that is large enough a
# tracer passes that is WRONG with the default.
cc -O2 -DBUG=1 -o "$dir/wrong" "$dir/honest.c" || exit 4
expect 1 . conform --engine "pipe:$dir/wrong" 'closest.*.sphere.mixed.*'
expect 0 . conform --engine "pipe:$dir/wrong" --displacement 1e6 'closest.*.sphere.mixed.*'
expect 0 . conform --engine "$honest" --displacement 1 'closest.*.sphere.mixed.*'

# A triangle with two equal vertices is a line, whose determinant rounding may make anything: where
# the ray meets that line the published test answers it.
trial() {
    cat >"$dir/line.trial" <<END
raydiff trial 1
expect pipe:honest.-.phantom.outside
origin seed 5 index 0 version 4 stream gen
recipe few
builder median leaf 4 eps 0x1.47ae14p-6
box robust
tri mt
query $1
vertices 2
0x0p+0 0x1.5p+0 0x0p+0
0x1.54p-2 0x0p+0 -0x1.f8p+10
triangles 1
0 1 1
rays 1
0x1.e8a454p+0 0x1.0210cp-3 -0x1.c3p+0 -0x1.e88f14p+0 0x1.2f69e8p+0 -0x1.a8p-3 0x0p+0 inf
end
END
}
for query in closest any; do
    trial $query
    expect 0 . replay "$dir/line.trial" --engine "$honest"
done

echo "losers: $failed failed"
[ "$failed" -eq 0 ]
