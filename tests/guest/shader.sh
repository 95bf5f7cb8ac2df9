#!/bin/sh
# Tracers that are one compute shader, from the command line: the sample agrees, as GLSL and as SPIR-V; a
# planted bug is found by a campaign and shrunk; what is wrong with a file is told in one line.
# usage: sh tests/guest/shader.sh PATH/raydiff
set -u
. tests/guest/outsiders.sh
sample=$root/fuzz/samples/engine/trace.comp
changed() { sed "$2" "$sample" >"$1" && ! cmp -s "$1" "$sample" || bad "$1 is the sample"; }

cp "$sample" trace.comp
"$raydiff" check sphere:n=2 --engine shader:trace.comp --count 20 --repeat 1 >out 2>&1
missing=$(grep -m 1 -oE 'built without glslang|vulkan: no (loader|device).*' out)
if [ -n "$missing" ]; then
    echo "SKIP shaders that trace: $missing"
    exit 77
fi
expect 0 '1 of 1 rows agree, 0 of 2000 answers WRONG' check sphere:n=4 --engine shader:trace.comp --count 2000 --repeat 1
expect 0 '1 of 1 rows agree' check needles --query any --engine shader:trace.comp --count 500 --repeat 1
expect 0 '1 of 1 rows agree' check sphere:n=4 --engine shader:./trace.comp --workgroup 17 --count 500 --repeat 1
changed fixed.comp 's/local_size_x_id = 0/local_size_x = 32/'
expect 0 '1 of 1 rows agree' check sphere:n=4 --engine shader:fixed.comp --count 500 --repeat 1
if command -v glslangValidator >/dev/null; then
    glslangValidator -V --quiet -o trace.spv trace.comp >out 2>&1 || bad 'glslangValidator'
    expect 0 '2 of 2 rows agree' check sphere:n=4 --engine shader:trace.comp,shader:trace.spv --count 500 --repeat 1
    head -c 202 trace.spv >cut.spv
    expect 2 'cut.spv: no SPIR-V module: 202 bytes are no words' check sphere --engine shader:cut.spv
    head -c 200 trace.spv >short.spv
    expect 2 'short.spv: ' check sphere --engine shader:short.spv
fi
expect 0 '1 passed, 0 failed' conform 'closest.shader:./trace.comp.-.-.-.mt.soup.vertices.1'
expect 77 'traces scenes, not worlds' check mixed --engine shader:trace.comp --count 50
expect 1 'cannot list all hits' check soup --query all --engine shader:trace.comp --count 50

# --- what the device holds: three words for each vertex and each triangle, and as much for the rays of any scene
for scene in sphere:n=2 sphere:n=7 soup:n=500; do
    expect 0 . check "$scene" --engine shader:trace.comp --count 40 --repeat 1 --json j.json
    awk -f "$root/tests/values/flat.awk" j.json | awk -F= '
        { v[$1] = $2 }
        END { print v["rows.0.memory_bytes"] - 12 * (v["scenes.0.vertices"] + v["scenes.0.triangles"]) }'
done | sort -u >rays
[ "$(cat rays)" -ge $((40 * 48)) ] 2>/dev/null || bad "a scene is not told with what it takes: $(tr '\n' ' ' <rays)"

# --- a bug is found, and shrunk
changed bug.comp 's/u + v <= 1.0/u <= 1.0 \&\& v <= 1.0/'
expect 1 'WRONG  *-  *shader:bug.comp' check sphere:n=4 --engine shader:bug.comp --count 500 --repeat 1
expect 1 'new  *shader:bug.comp.-.phantom' fuzz --trials 10 --engine shader:bug.comp --corpus none --no-shrink --dir found
finding=$(ls found/shader=bug.comp.-.phantom*/*.trial | head -n 1)
expect 0 . min "$finding" --engine shader:bug.comp --out small.trial
grep -q '^triangles 1$' small.trial || bad 'min leaves one triangle'
expect 1 'STILL FAILS' replay --brief small.trial --engine shader:bug.comp
expect 2 'name its file: --engine shader:PATH' replay small.trial
cp trace.comp bug.comp
expect 0 'does not fail' replay --brief small.trial --engine shader:./bug.comp

# --- answers that are none
changed holes.comp 's/hit\[number\] = best;/hit[number \& ~1u] = best;/'
expect 3 'its answer to ray 1 names triangle [0-9]+ of 128, or was never written' \
    check sphere:n=4 --engine shader:holes.comp --count 500 --repeat 1

# --- what is wrong with a file
changed binding.comp 's/binding = 3/binding = 5/'
expect 2 'binding.comp: binding 5: there are 0 to 3' check sphere --engine shader:binding.comp
changed set.comp 's/(std430, binding = 3)/(std430, set = 1, binding = 3)/'
expect 2 'set.comp: descriptor set 1: there is 0' check sphere --engine shader:set.comp
changed wide.comp 's/local_size_x_id = 0/local_size_x = 8, local_size_y = 8/'
expect 2 'wide.comp: a workgroup of 8 x 8 x 1' check sphere --engine shader:wide.comp
changed double.comp 's/float det = dot(e1, p)/float det = float(double(dot(e1, p)))/'
expect 2 'double.comp: it needs 1 capabilities beyond Shader' check sphere --engine shader:double.comp
changed typo.comp 's/float det/floot det/'
expect 2 "typo.comp:[0-9]+: 'floot'" check sphere --engine shader:typo.comp
expect 2 'none.comp: No such file' check sphere --engine shader:none.comp
# The longest name, and one that is longer by one.
name=$(printf '%0152d' 0)
expect 2 'No such file' check sphere --engine "shader:$name"
expect 2 "is longer than 159 characters" check sphere --engine "shader:0$name"
[ "$failed" -eq 0 ] && echo 'tracers that are one shader: as they should be'
exit "$failed"
