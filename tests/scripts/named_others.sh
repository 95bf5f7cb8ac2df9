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

# Modes of Embree: one that cannot run here, or of which another ISA runs, is told in one line, and `all` leaves it out.
if "$raydiff" check sphere:n=1 --engine embree:sse2 --count 10 >"$dir/out" 2>&1 || [ $? != 77 ]; then
    cc -shared -fPIC -o "$dir/less.so" tests/embree/shim.c -ldl || bad 'shim.c is not compiled'
    cat >"$dir/less" <<END
#!/bin/sh
EMBREE_LESS=1 LD_PRELOAD=$dir/less.so exec $raydiff "\$@"
END
    chmod +x "$dir/less"
    whole=$raydiff raydiff=$dir/less
    tree='sphere:n=2 --count 200 --repeat 1'
    for mode in 'avx512 no device of ISA avx512 for this processor' 'avx2:8 asked for ISA avx2, it runs sse42' \
        'high:avx:robust asked for ISA avx, it runs sse42'; do
        says 77 "^raydiff check: --engine: Embree: ${mode#* }\$" check $tree --engine "cpu,embree:${mode%% *}"
        [ "$(cat "$dir/out" "$dir/err" | wc -l)" -eq 1 ] || bad "${mode%% *}: not one line"
    done
    says 77 'no device of ISA avx512' check $tree --engine 'embree:avx512*'
    says 2 "no mode of Embree is called 'embree:nope[*]'" check $tree --engine 'embree:nope*'
    says 0 '^conclusion: 96 of 96 rows agree' check $tree --engine embree:all
    raydiff=$whole
    says 0 '^engine embree:sse42:8:high:robust:compact answered 1 of 1' check $tree --engine embree:compact:sse4.2:robust:8:high
    says 0 '^engine embree_robust answered 1 of 1' check $tree --engine embree:robust:1
    says 2 'named twice' check $tree --engine embree_robust,embree:robust
    says 2 'embree:sse2:8 is named twice|.embree:sse2:8. is named twice' check $tree --engine embree:sse2:8,embree:8:sse2
    says 0 '^engine embree:sse2:8 answered 1 of 1' leaks sphere:n=4 --engine embree:sse2:8 --count 1000
    says 0 'passed, 0 failed' conform 'closest.embree:sse2:8.-.-.-.mt.sphere:n=4.primary.1'
    # A finding brings the mode back: replayed and explained without --engine.
    cat >"$dir/mode.trial" <<'END'
raydiff trial 1
expect embree:sse2:4:low.-.missed.scale
builder median leaf 4 eps 0x1p-6
box robust
tri mt
query closest
vertices 3
0x0p+0 0x0p+0 0x0p+0
0x1p+0 0x0p+0 0x0p+0
0x0p+0 0x1p+0 0x0p+0
triangles 1
0 1 2
rays 1
0x1p-2 0x1p-2 0x1p+0 0x0p+0 0x0p+0 -0x1p+0 0x0p+0 inf
end
END
    says 0 '^  embree:sse2:4:low -  *nothing wrong' replay "$dir/mode.trial"
    says 0 'embree:sse2:4:low' explain "$dir/mode.trial"
fi

echo "named_others: $failed failed"
[ "$failed" -eq 0 ]
