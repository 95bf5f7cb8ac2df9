#!/bin/sh
# A named member must answer something: what tests/scripts/named.sh tests of check, conform and fuzz holds for
# every other command that names engines.
#   sh tests/scripts/named_others.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh
samples=$(dirname "$raydiff")/samples
[ -x "$samples/refuser" ] || samples=build/samples # a planted bug's program has none of its own
all="pipe:$samples/refuser 0"

# Expected code, a line that the standard output must have, arguments.
says() {
    line=$2
    code=$1
    shift 2
    expect "$code" . "$@"
    grep -qE -- "$line" "$dir/out" "$dir/err" || bad "raydiff $*: no line like /$line/"
}
tree='sphere:n=4 --count 1000'
says 1 "^engine $all answered 0 of 1, refused 1" leaks $tree --engine "$all"
says 1 "^engine $all answered 0 of 1, refused 1" replay fuzz/corpus/sentinel.trial --engine "$all"
says 1 "^engine $all answered 0 of 1, refused 1" replay fuzz/corpus/sentinel.trial --engine "cpu,$all" --brief
says 1 'only teapots' bench error --scene sphere:n=4 --count 64 --rounds 1 --engine "cpu,$all" --layout f32 --tri mt
says 1 'only teapots' bench matrix --scene sphere:n=4 --count 64 --rounds 1 --engine "$all"
says 1 'only teapots' bench spawn --scene sphere:n=4 --count 64 --rounds 1 --engine "$all"
says 1 'only teapots' bench frames --scene sphere:n=4 --frames 2 --size 16x16 --engine "$all" --out "$dir/frames"
says 1 'only teapots' diff sphere:n=2 -w 16 -h 16 --engine "cpu,$all"
says 1 'only teapots' render sphere:n=2 -w 16 -h 16 --out "$dir/x.png" --engine "$all"
says 1 'only teapots' explain sphere:n=2 --ray '0,0,-3 0,0,1' --engine "$all"
says 1 'check: exit code 1' report sphere:n=3 --count 200 --parts check --engine "$all" --out "$dir/r.html"

# leaks where every layout refuses, though none was named and Embree answers: why, once for each; not where one holds it.
tree='sphere:n=6 --count 1000 --leaf 64 --tri mt,woop'
for engine in cpu cpu,embree_robust; do
    for why in 'f32 refused: storage compact: a leaf holds at most 8 triangles' 'rf16 refused: rf16: keeps its items' \
        'nothing ran on a layout: every one refuses$'; do
        says 2 "^  $why" leaks $tree --store compact --engine "$engine"
        [ "$(grep -c "^  $why" "$dir/out")" -eq 1 ] || bad "leaks: not once: $why"
    done
done
expect 0 . leaks $tree --engine cpu
grep -q '^  rf16 refused: rf16: a leaf holds at most 8 items' "$dir/out" || bad 'leaks: why rf16 refuses'
grep -q 'nothing ran' "$dir/out" && bad 'leaks: f32 ran, and yet nothing'
"$raydiff" leaks --help | tr -s '\n ' ' ' | grep -q '2 bad input, an open mesh, a named layout that refuses the scene, or nothing but layouts that do,' ||
    bad 'leaks --help: exit code of layouts that refuse'

# Two pictures of nothing are no evidence.
for nothing in 'soup:n=0' 'rtrs --bounces 0'; do
    expect 1 . diff $nothing --engine cpu,brute -w 48 -h 36
    grep -q '^  vacuous: no path of either hits a triangle$' "$dir/out" || bad "diff $nothing: not vacuous"
done

echo "named_others: $failed failed"
[ "$failed" -eq 0 ]
