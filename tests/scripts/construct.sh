#!/bin/sh
# raydiff construct as a user meets it: the paper's command, what is written, one line per error and
# nothing written then; and the chain construct, precompute, check --bvh.
#   sh tests/scripts/construct.sh RAYDIFF
set -u
raydiff=$1
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh

"$raydiff" scene convert platonic:which=3 "$dir/dodecahedron.obj" >/dev/null
"$raydiff" scene convert platonic:which=0 "$dir/tetrahedron.obj" >/dev/null
sphere="--model sphere:n=4 0"
seen="--camera-pos 0 0 -10 0 0 0 --camera-orbit"
out="--out $dir/x.json"

# The paper's own command (B.1), paths aside, from its `--` on.
expect 0 . construct -- --out "$dir/default.json" --camera-pos 0.0 0.0 10.0 0.0 0.0 0.0 \
    --camera-orbit --light 20.0 20.0 20.0 1.5 --light 0.0 50.0 25.0 1.8 --light 30.0 20.0 0.0 1.7 \
    --material 0.4 0.4 0.3 0.6 0.3 0.1 50.0 --material 0.3 0.1 0.1 0.9 0.1 0.0 10.0 \
    --model "$dir/dodecahedron.obj" 0 --model "$dir/tetrahedron.obj" 1
grep -q '2 models, 40 triangles, 24 vertices, 2 materials, 3 lights, camera orbit' "$dir/err" ||
    bad "construct says what it made"
[ "$(grep '"material":' "$dir/default.json" | uniq -c | tr -s ' \n' ' ')" = \
    ' 36 "material": 0 4 "material": 1 ' ] || bad "the paper's materials are 36 times 0, 4 times 1"
expect 0 . scene info "$dir/default.json"
grep -q 'camera from *0.0 0.0 10.0' "$dir/out" || bad "the paper's camera"
# What was built of it goes on to a tree, and to every engine's answers.
expect 0 . precompute --scene "$dir/default.json" --builder median --out "$dir/default.bvh.json"
expect 0 . check "$dir/default.json" --bvh "$dir/default.bvh.json" --engine cpu --count 2000 --repeat 1
expect 0 . check "$dir/default.json" --engine cpu --count 2000 --repeat 1

# Negative numbers, exponents, pairs, any order, and a value behind an equals sign.
expect 0 . construct --camera-fixed --light -20 2e1 -2.5E-3 +1.5 --camera-pos -10 0 -1e1 0 -.5 0 \
    --model "$dir/tetrahedron.obj" 0 "$dir/dodecahedron.obj" default --out="$dir/negative.json"
expect 0 . scene info "$dir/negative.json"
grep -q 'camera from *-10.0 0.0 -10.0' "$dir/out" || bad "negative camera numbers"
grep -q 'camera at *0.0 -0.5 0.0, fixed' "$dir/out" || bad "a fixed camera"
grep -A 5 '"lights"' "$dir/negative.json" | grep -q -- '-20.0' || bad "a negative light"
grep -q -- '-0.0025' "$dir/negative.json" || bad "an exponent"

# Every transform, against the same done by hand.
corner() { # the largest coordinates of a scene
    "$raydiff" scene info "$1" | sed -n 's/.*bounds, most *//p'
}
cat >"$dir/corner.obj" <<'OBJ'
v 1 2 3
v 0 2 3
v 1 0 3
f 1 2 3
OBJ
moved() { # expected largest coordinates, transforms
    most=$1
    shift
    expect 0 . construct $out $seen --model "$dir/corner.obj" default "$@"
    [ "$(corner "$dir/x.json")" = "$most" ] || bad "$*: $(corner "$dir/x.json"), not $most"
}
moved '1.0 2.0 3.0'
moved '0.0 4.0 6.5' --translate -1 2 3.5
moved '0.0 1.0 3.0' --rotate z 90
moved '0.0 1.0 3.0' --rotate 0 0 7 90
moved '2.0 4.0 6.0' --scale 2
moved '2.0 0.0 3.0' --scale 2 -1 1
moved '4.0 4.0 6.0' --translate 1 0 0 --scale 2
moved '3.0 4.0 6.0' --scale 2 --translate 1 0 0
moved '12.0 6.0 5.0' --matrix 2 0 0 10 0 0 2 0 0 1 0 3 0 0 0 1

# Models of one option are as those of an option each, whichever material each has.
for of in '0 1 2' '2 1 0' '1 default 0' 'default 2 2'; do
    together= apart=
    for material in $of; do
        together="$together soup:n=4 $material" apart="$apart --model soup:n=4 $material"
    done
    for models in "--model $together" "$apart"; do
        # shellcheck disable=SC2086 # words of a command
        expect 0 . construct $out $seen --material 0.5 0.1 0.1 0.9 0.1 0 10 --material 0.4 0.1 0.1 0.9 0.1 0 10 \
            --material 0.3 0.1 0.1 0.9 0.1 0 10 $models
        cksum <"$dir/x.json" >>"$dir/made"
        grep '"material":' "$dir/x.json" | sort -u >>"$dir/materials"
    done
    [ "$(sort -u "$dir/made" | wc -l)" -eq 1 ] || bad "models $of: not the same of one option and of several"
    rm "$dir/made"
done
[ "$(sort -u "$dir/materials" | wc -l)" -ge 3 ] || bad "the models do not differ by their materials"

# Generators, binary and zipped meshes; other endings keep the triangles.
"$raydiff" scene convert platonic:which=3 "$dir/d.ply" >/dev/null
gzip -c "$dir/d.ply" >"$dir/d.ply.gz"
expect 0 . construct --out "$dir/many.ply" $seen --model soup:n=5 default "$dir/d.ply.gz" 0 \
    --seed 3 --json
for pair in '"triangles": 41,' '"material": 0,' '"camera": "orbit"' '"default_material": 0'; do
    grep -q "$pair" "$dir/out" || bad "construct --json has no $pair"
done
[ -s "$dir/err" ] && bad "construct --json prints nothing else"
expect 0 . scene info "$dir/many.ply"
grep -q 'triangles *41$' "$dir/out" || bad "a PLY file of 41 triangles"

# Errors: one line, and nothing is written, nor what was there changed.
rm -f "$dir/x.json"
m="--material 0.5 0.1 0.1 0.9 0.1 0 10"
# What stands behind the paper's `--` is refused by the same words.
refuse() {
    expect 2 "$@"
    shift 2
    cp "$dir/err" "$dir/said"
    expect 2 . construct -- "$@"
    cmp -s "$dir/err" "$dir/said" || bad "construct -- $*: another message than without the --"
}
refuse '--out is missing' construct $sphere $seen
refuse '--model is missing' construct $out $seen
refuse '--camera-pos is missing' construct $out $sphere --camera-orbit
refuse '--camera-fixed or --camera-orbit is missing' construct $out $sphere --camera-pos 0 0 1 0 0 0
refuse 'one of them' construct $out $sphere $seen --camera-fixed
refuse 'the camera has no direction' construct $out $sphere --camera-pos 1 2 3 1 2 3 --camera-fixed
refuse '\(sphere:n=4\): material 2, but there are 2, counted from 0 to 1' \
    construct $out $seen $m $m --model sphere:n=4 2
refuse 'material 1, but there is 1' construct $out $seen $m --model sphere:n=4 1
refuse 'material 1, but none is given' construct $out $seen --model sphere:n=4 1
refuse "'-1' is neither a material's index nor 'default'" construct $out $seen --model sphere:n=4 -1
refuse "'1.5' is neither" construct $out $seen --model sphere:n=4 1.5
refuse "'' is neither" construct $out $seen --model sphere:n=4 ''
refuse '1 word follows' construct $out $seen --model sphere:n=4
refuse '3 words follow' construct $out $seen --model sphere:n=4 0 soup
refuse '--model: .* 0 words follow' construct $out $seen --model
refuse '--light: takes 4 numbers.*3 words follow' construct $out $seen $sphere --light 1 2 3
refuse '--light: takes 4 numbers.*8 words follow' construct $out $seen $sphere --light 1 2 3 4 5 6 7 8
refuse '--material: takes 7 numbers.*6 words' construct $out $seen $sphere --material 1 2 3 4 5 6
refuse '--camera-pos: takes 6 numbers.*5' construct $out $sphere --camera-pos 1 2 3 4 5 --camera-fixed
refuse '--camera-fixed: takes nothing, but 1 word' construct $out $sphere --camera-fixed 5
refuse '--camera-pos: is given twice' construct $out $sphere $seen --camera-pos 1 2 3 4 5 6
refuse '--out: is given twice' construct $out $out $sphere $seen
refuse "--out: needs a file" construct --out - $sphere $seen
refuse "--light: 'nan' is not a finite number" construct $out $seen $sphere --light nan 2 3 4
refuse "--light: '-inf' is not" construct $out $seen $sphere --light 1 -inf 3 4
refuse "--light: '1e39' is not" construct $out $seen $sphere --light 1e39 2 3 4
refuse "--light: 'one' is not" construct $out $seen $sphere --light one 2 3 4
refuse "--light: '1,5' is not" construct $out $seen $sphere --light 1,5 2 3 4
refuse "--light: '-x' is not" construct $out $seen $sphere --light -x 2 3 4
refuse "unknown option: '--lights'; did you mean --light\?" construct $out $seen $sphere --lights 1 2 3 4
refuse "unknown option: '--'" construct $out $seen $sphere --
refuse "unexpected argument 'sphere'" construct sphere $out $seen $sphere
refuse "unexpected argument 'y'" construct --out=x y $seen $sphere
refuse '--scale: must follow a --model' construct $out $seen --scale 2 $sphere
refuse '--scale: a factor of 0' construct $out $seen $sphere --scale 1 0 1
refuse '--scale: takes 1 or 3 numbers, but 2' construct $out $seen $sphere --scale 1 2
refuse "--rotate: 'w' is not x, y or z" construct $out $seen $sphere --rotate w 90
refuse '--rotate: an axis of length 0' construct $out $seen $sphere --rotate 0 0 0 90
refuse "--rotate: 'east' is not a finite" construct $out $seen $sphere --rotate x east
refuse '--rotate: takes an axis' construct $out $seen $sphere --rotate 1 0 90
refuse '--translate: takes 3' construct $out $seen $sphere --translate 1 0
refuse '--matrix: takes 16 numbers, but 12' construct $out $seen $sphere --matrix 1 2 3 4 5 6 7 8 9 0 1 2
refuse '--matrix: the last of the four rows' construct $out $seen $sphere \
    --matrix 1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1
refuse '--matrix: its determinant is 0' construct $out $seen $sphere \
    --matrix 1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1
refuse 'out of the range of a float' construct $out $seen $sphere --scale 1e30 --scale 1e30
refuse 'nothing.obj: No such file' construct $out $seen --model "$dir/nothing.obj" 0
refuse "unknown scene 'warp'" construct $out $seen --model warp 0
printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n' >"$dir/flat.obj"
refuse 'flat.obj\): vertex 0 of triangle 0 has no normal.*--fill-normals' \
    construct $out $seen --model "$dir/flat.obj" 0
printf 'v 0 0 0\nv 1 0 0\nv nan 0 0\nf 1 2 3\n' >"$dir/nan.obj"
refuse 'nan.obj:3: ' construct $out $seen --model "$dir/nan.obj" 0
refuse 'no-such-folder' construct --out "$dir/no-such-folder/x.json" $seen $sphere
refuse 'unknown ending' construct --out "$dir/x.scene" $seen $sphere
mkdir "$dir/folder.json"
refuse 'is a directory' construct --out "$dir/folder.json" $seen $sphere
refuse "--seed: 'x' is not a whole number" construct $out $seen $sphere --seed x
ls "$dir"/x* >/dev/null 2>&1 && bad "a refused construct writes something: $(ls "$dir"/x*)"
expect 0 . construct $out $seen --model "$dir/flat.obj" 0 --fill-normals
grep -q 'filled with 0 1 0: 3' "$dir/err" || bad "construct says that it filled 3 normals"
cp "$dir/x.json" "$dir/before"
expect 2 . construct $out $seen --model "$dir/flat.obj" 7
cmp -s "$dir/x.json" "$dir/before" || bad "a refused construct leaves what was there"

echo "construct: $failed failed"
[ "$failed" -eq 0 ]
