#!/bin/sh
# Files of worlds as a user meets them: every format to every other, what is told, one line for each error and
# nothing written then.
#   sh tests/worlds/world_files.sh RAYDIFF
set -u
raydiff=$1
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh

# What is told of a file, after its name.
told() { sed -n "s|^$1: ||p" "$dir/out"; }
is_told() { [ "$(told "$1")" = "$2" ] || bad "$1: told '$(told "$1")', not '$2'"; }

# A world keeps every bit through all formats and back.
for world in placed-thin placed-scaled:count=9 nest:n=2 crowd:n=50 wall:n=3 twins:k=2; do
    expect 0 . scene convert "$world" "$dir/a.json"
    expect 0 . scene convert "$dir/a.json" "$dir/b.gltf"
    expect 0 . scene convert "$dir/b.gltf" "$dir/c.glb"
    expect 0 . scene convert "$dir/c.glb" "$dir/d.json"
    cmp -s "$dir/a.json" "$dir/d.json" || bad "$world: other bits after .gltf and .glb"
done
is_told "$dir/d.json" '1 mesh, 2 instances, 64 placed triangles'
expect 0 . scene convert mixed "$dir/m.json"
is_told "$dir/m.json" '3 meshes, 32 instances, 1900 placed triangles'
gzip -c "$dir/m.json" >"$dir/z.json.gz"
expect 0 . scene convert "$dir/z.json.gz" "$dir/again.json"
cmp -s "$dir/m.json" "$dir/again.json" || bad 'a zipped world is another one'

# A scene stays one: the same triangles in every format, RTRS's JSON unless a world's is asked for.
expect 0 . scene convert sphere:n=3 "$dir/s.obj"
for end in stl gltf glb ply world.json; do
    expect 0 . scene convert "$dir/s.obj" "$dir/s.$end"
    is_told "$dir/s.$end" '72 triangles, 38 vertices'
    expect 0 . scene convert "$dir/s.$end" "$dir/back.obj"
    [ "$end" = stl ] || cmp -s "$dir/s.obj" "$dir/back.obj" || bad "$end: other bits"
    expect 0 . check "$dir/s.$end" --engine cpu --layout f32 --count 100 --repeat 1
    expect 0 . scene info "$dir/s.$end"
    grep -q 'triangles  *72$' "$dir/out" || bad "$end: info counts other triangles"
done
expect 0 . scene convert "$dir/s.glb" "$dir/s.json"
grep -q '"camera_controller"' "$dir/s.json" || bad "a scene as .json is RTRS's"
grep -q '"raydiff_world": 1' "$dir/s.world.json" || bad "a scene as .world.json is raydiff's"
expect 0 . scene convert rtrs "$dir/r.gltf"
grep -q 'not kept' "$dir/out" || bad 'lights are not kept, and that is not told'
# ASCII STL is read, too.
printf 'solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n' >"$dir/t.stl"
expect 0 . scene convert "$dir/t.stl" "$dir/t.ply"
is_told "$dir/t.ply" '1 triangle, 3 vertices'

# What a glTF file has and a world has not.
cat >"$dir/points.gltf" <<'END'
{"asset": {"version": "2.0"}, "nodes": [{"mesh": 0, "skin": 0}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}, {"attributes": {"POSITION": 0}, "mode": 1}]}]}
END
expect 0 . scene convert "$dir/points.gltf" "$dir/p.json"
grep -q '^left out: 2 primitives of points or lines$' "$dir/out" || bad 'points are left out, and that is not told'
grep -q '^left out: 1 skin, 0 primitives with morph targets; they are placed at rest$' "$dir/out" || bad 'skins'

"$raydiff" scene convert placed-turned "$dir/placed.gltf" >"$dir/out"
sed 's/"attributes": {"POSITION": 0}/&, "targets": [{}]/' "$dir/placed.gltf" >"$dir/morphs.gltf"
expect 0 . scene convert "$dir/morphs.gltf" "$dir/p.json"
grep -q '^left out: 0 skins, 1 primitive with morph targets; they are placed at rest$' "$dir/out" || bad "morph targets: $(cat "$dir/out")"
# It is told, too, where the vertices are moved.
sed 's/"attributes": {"POSITION": 0[^}]*}/&, "targets": [{}]/' "$dir/s.gltf" >"$dir/moved.gltf"
for bits in '' '--bits 12'; do
    expect 0 . scene convert "$dir/moved.gltf" "$dir/p.ply" $bits
    grep -q '^left out: 0 skins, 1 primitive with morph targets; they are placed at rest$' "$dir/out" || bad "morph targets with $bits: $(cat "$dir/out")"
done

# Files beside a file.
mkdir "$dir/below"
cp "$dir/s.obj" "$dir/below/ball.obj"
echo '{"raydiff_world": 1, "meshes": [{"scene": "below/ball.obj"}, {"scene": "soup:n=3"}],
 "instances": [{"mesh": 0}, {"mesh": 1, "mask": 1}]}' >"$dir/named.json"
expect 0 . scene convert "$dir/named.json" "$dir/n.glb"
is_told "$dir/n.glb" '2 meshes, 2 instances, 75 placed triangles'

# Info and list.
expect 0 . scene info "$dir/m.json" sphere:n=3 --json
for key in meshes geometries not_opaque vertices triangles instances inactive mirrored identity placed_triangles filter share; do
    grep -q "\"$key\"" "$dir/out" || bad "scene info --json: no key $key"
done
grep -q '"instances": 32' "$dir/out" || bad 'scene info --json counts instances'
expect 0 . scene info placed-mirrored:count=7
grep -q 'instances  *7, inactive 0, mirrored 7, at the identity 0$' "$dir/out" || bad 'scene info of mirrors'
expect 0 . scene list
for name in placed-identity placed-thin wall nest crowd twins mixed; do
    grep -q "^  $name " "$dir/out" || bad "scene list: no $name"
done
grep -q '(by default 1 mesh, 64 instances, 768 placed triangles)' "$dir/out" || bad 'scene list counts what a wall has'

# One line each, and nothing is written.
expect 2 'mixed: is a world of 3 meshes, 32 instances, 1900 placed triangles; this command takes a scene' precompute --scene mixed --out "$dir/no.json"
expect 2 'is a world of 1 mesh, 2 instances' bench layouts --scene "$dir/a.json"
expect 2 'x.stl: this format holds one mesh in one instance' scene convert crowd "$dir/x.stl"
expect 2 'x.obj: this format holds one mesh in one instance' scene convert crowd "$dir/x.obj"
expect 2 'x.gltf: mesh [02]: .* which glTF cannot hold' scene convert mixed "$dir/x.gltf"
expect 2 'x.glb: mesh [02]: .* which glTF cannot hold' scene convert mixed "$dir/x.glb"
expect 2 'unknown ending; worlds are written' scene convert mixed "$dir/x.fbx"
expect 2 'x.glb: cannot write: No such file' scene convert crowd "$dir/no/x.glb"
expect 2 "unknown scene 'crwod'.*; did you mean crowd\?" scene convert crwod "$dir/x.glb"
expect 2 'crowd: n=0 must be a number from 1' scene convert crowd:n=0 "$dir/x.glb"
expect 2 '^raydiff scene: --seed: ' scene convert wall "$dir/x.glb" --seed 3
wrong() { # what is told, ending, a change of a file
    sed "$3" "$dir/named.json" >"$dir/wrong.$2"
    expect 2 "wrong.$2: *$1" scene convert "$dir/wrong.$2" "$dir/x.json"
}
wrong 'raydiff_world: is 2; this version reads 1' json 's/world": 1/world": 2/'
wrong "instances\[1\]: 'maks' is no member of it" json 's/mask/maks/'
wrong 'instances\[1\].mask: must be a whole number from 0 to 255' json 's/mask": 1/mask": 256/'
wrong 'meshes\[0\].scene: .*gone.obj: No such file' json 's/ball/gone/'
wrong "meshes\[0\].scene: '../below/ball.obj' is no file in the folder" json 's|below|../below|'
wrong 'meshes\[0\].scene: ./wrong.json: is being read|meshes\[0\].scene: .*wrong.json: is being read' json 's|below/ball.obj|wrong.json|'
wrong 'meshes\[0\].primitives: is missing' gltf 's/"raydiff_world"/"x"/'
printf 'glTF\002\000\000\000\024\000\000\000' >"$dir/cut.glb"
expect 2 'cut.glb: byte 12: the header is cut short' scene convert "$dir/cut.glb" "$dir/x.json"
head -c 100 "$dir/s.stl" >"$dir/cut.stl"
expect 2 'cut.stl: byte 80: 72 triangles take 3684 bytes, but the file has 100' scene convert "$dir/cut.stl" "$dir/x.json"
[ -z "$(find "$dir" -name 'x.*')" ] || bad "something was written: $(find "$dir" -name 'x.*')"
[ -z "$(ls "$dir" | grep -i tmp)" ] || bad 'a temporary file was left behind'
[ "$failed" = 0 ] || { echo "$failed failed"; exit 1; }
echo 'worlds: all as expected'
