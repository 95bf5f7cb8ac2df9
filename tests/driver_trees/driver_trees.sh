#!/bin/sh
# raydiff tree on what drivers serialise: a file made here (encode.pl), compared with a world; options that go
# together; and, where there is the driver of Mesa 25.0 (make drivers), what it builds itself.
#   sh tests/driver_trees/driver_trees.sh PROGRAM
set -u
raydiff=$(realpath "$1")
. tests/scripts/expect.sh

lines=tests/driver_trees/two.lvp.txt
made() { perl tests/driver_trees/encode.pl >"$dir/made.as"; }
cat >"$dir/a.obj" <<END
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 2 3
f 4 2 3
END
printf 'v 0 0 0\nv 4 0 1\nv 0 2 0\nf 1 2 3\n' >"$dir/b.obj"
cat >"$dir/two.json" <<END
{"raydiff_world": 1, "meshes": [{"scene": "a.obj"}, {"scene": "b.obj"}],
 "instances": [{"mesh": 0}, {"mesh": 1, "custom": 9, "transform": [1, 0, 0, -1, 0, 1, 0, 0, 0, 0, 1, 0]}, {"mesh": null},
               {"mesh": 0, "mask": 1, "transform": [1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 0]}]}
END
made <$lines
expect 0 . tree "$dir/made.as" "$dir/two.json" --wide
has 'a top level' 'a top level of format lavapipe, 3 instances, with the trees below$' '^  leaves   3 instances' \
    '^  placed   of 3 judged: 0 too small$' ', tree 2 below: a tree of format lavapipe, with its own triangles$' \
    '^SAME: instances and triangles are those of '
expect 0 . tree "$dir/made.as" --format lavapipe
# Handles in another order of their values: trees are numbered by where a handle is first.
sed 's/7f00aa/8f00aa/g' $lines | made
expect 0 . tree "$dir/made.as" "$dir/two.json"
sed '/^instance 3/s/ 1 0 / 3 0 /' $lines | made
expect 1 . tree "$dir/made.as" "$dir/two.json" --wide
has 'another mask' '^DIFFERS: from .*: 1 instances, 0 triangles; first instance 3$'
sed 's/^tri 0 0   0 0 0  4 0 1/tri 0 0   0 0 0  4 0 0.5/' $lines | made
expect 1 . tree "$dir/made.as" "$dir/two.json" --wide
has 'another triangle' '^DIFFERS: from .*: 0 instances, 1 triangles; first instance 1, triangle 0 of its geometry 0$'
sed 's/l1 -1 0 0 3 2 1/l1 -1 0 0 2.5 2 1/' $lines | made
expect 1 . tree "$dir/made.as" --wide
# It lacks 0.5 of sizes 4 + 1.
has 'a box too small' 'of 3 judged: 1 too small, on 1 sides, by at most 2097152 floats and 1.68e\+06 u: instance 1, whose most x is' \
    '^FAULT small: node 3: its box is too small: its most x is 0x1.4p\+1, and instance 1 has 0x1.8p\+1'
sed 's/^box l0 0 0 0 4 2 1/box l0 0 0 0 4 2 0.5/' $lines | made
expect 1 . tree "$dir/made.as" --wide
has 'a fault below' '^FAULT small: node 1: its box is too small: its most z is 0x1p-1, and triangle 0 has 0x1p\+0'
{ echo 'uuid 26.1.0-1'; cat $lines; } | made
expect 2 'made.as: structure at byte 0: of lavapipe 26.1.0-1; that of lavapipe 25.0.x is read' tree "$dir/made.as"
sed '/^handles$/,$d' $lines | made
expect 1 . tree "$dir/made.as" "$dir/a.obj" --wide
has 'without trees' 'a top level of format lavapipe, 3 instances, without the trees' 'SOUND, as far as'
sed -n '/^handles$/,/tri 0 1/p' $lines | sed '/tri 0 1/q' | made
expect 0 . tree "$dir/made.as" "$dir/a.obj"
expect 2 'two.json: a tree of one mesh, the world has 2' tree "$dir/made.as" "$dir/two.json"

# The same world as RADV writes it: a top level with halves below its root.
lines=tests/driver_trees/two.radv.txt
radv() { perl tests/driver_trees/encode_radv.pl >"$dir/radv.as"; }
radv <$lines
expect 0 . tree "$dir/radv.as" "$dir/two.json" --wide
has 'a top level of RADV' 'a top level of format radv, 3 instances, with the trees below$' '^  leaves   3 instances' \
    '^  placed   of 3 judged: 0 too small$' ', tree 2 below: a tree of format radv, with its own triangles$' \
    '^SAME: instances and triangles are those of '
expect 0 . tree "$dir/radv.as" --format radv --json "$dir/radv.json"
sed 's/7f00aa00/ffff9000007f0000/g' $lines | radv
expect 0 . tree "$dir/radv.as" "$dir/two.json"
# A bound of halves that lacks 0.5.
sed 's/^half l0 0 0 0 1 1 1/half l0 0 0 0 1 0.5 1/' $lines | radv
expect 1 . tree "$dir/radv.as" --wide
has 'a half too small' 'of 3 judged: 1 too small, on 1 sides, by at most 8388608 floats .*: instance 0, whose most y is' \
    '^FAULT small: node 1: its box is too small: its most y is 0x1p-1, and instance 0 has 0x1p\+0'
sed 's/l1 -1 0 0 4 2 1/b0 -1 0 0 4 2 1/' $lines | radv
expect 1 . tree "$dir/radv.as" --wide
has 'a circle' '^FAULT cycle: node 3: '
sed 's/l1 -1 0 0 4 2 1/l0 -1 0 0 4 2 1/' $lines | radv
expect 1 . tree "$dir/radv.as" "$dir/two.json" --wide
has 'a leaf twice' '^FAULT shared: node 3: ' '^DIFFERS: from .*; first instance 1$'
sed 's/l1 -1 0 0 4 2 1/=4294967295 nan nan nan nan nan nan/' $lines | radv
expect 1 . tree "$dir/radv.as" "$dir/two.json" --wide
has 'an instance in no box' '^DIFFERS: from .*; first instance 1$'
{ echo 'build 26.1.0'; sed '/^handles$/,$d' $lines; echo 'build 26.0.0'; sed -n '/^handles$/,$p' $lines; } | radv
expect 2 'of the build 26.0.0, below a top level of the build 26.1.0' tree "$dir/radv.as"
{ echo 'driver NVIDIA'; cat $lines; } | radv
expect 2 'of the driver with the UUID NVIDIA; AMD-MESA-DRV, RADV, is read' tree "$dir/radv.as" --format radv
expect 2 'of the driver with the UUID 25.0.7-1; AMD-MESA-DRV, RADV, is read' tree "$dir/made.as" --format radv
expect 2 '--from: a driver writes no trees of format radv' tree soup --from rayquery --format radv

expect 2 '--save needs --from' tree "$dir/made.as" --save "$dir/x"
expect 2 '--driver needs --from' tree "$dir/made.as" --driver stock
expect 2 '--device needs --from' tree "$dir/made.as" --device 0
expect 2 '--from takes a SCENE, and no FILE beside it' tree soup soup --from rayquery
expect 2 "--from: 'vulkan' is not rayquery or a variant" tree soup --from vulkan
expect 2 '--from: .* has other triangles or geometries than the scene' tree soup --from rayquery:nan
expect 2 '--from: a driver writes no trees of format bvh2' tree soup --from rayquery --format bvh2
expect 77 'no device with Vulkan ray queries' tree soup --from rayquery --driver none-of-this-name

# What the driver builds is what is saved, and the world that it was given; each variant's tree is sound but for
# rounding at the top.
if "$raydiff" tree sphere:n=2 --from rayquery --driver mesa25 >/dev/null 2>"$dir/err"; then
    for world in sphere:n=4 crowd:n=30 placed-turned:count=20 placed-mirrored:count=5; do
        "$raydiff" tree $world --from rayquery --driver mesa25 --save "$dir/x.as" --wide >"$dir/built"
        "$raydiff" tree "$dir/x.as" $world --wide >"$dir/read"
        grep -q '^SAME: ' "$dir/read" || bad "$world: differs"
        sed '/^  driver /d; s|^[^:, ]*[:,].*a t|a t|' "$dir/built" >"$dir/one"
        sed 's|^[^:, ]*[:,].*a t|a t|' "$dir/read" | diff "$dir/one" - >"$dir/out" || bad "$world: saved is not built"
        grep '^FAULT ' "$dir/read" | grep -qv '^FAULT small' && bad "$world: other faults than boxes"
    done
    # Rays through what boxes lack. Instance 1 is that of docs/variants.md, whose box lacks most at one side; no ray
    # meets instance 0, whose box lacks the same and stands first among the sides.
    cat >"$dir/one.json" <<END
{"raydiff_world": 1, "meshes": [{"vertices": [3, 0, 0,  0, -3, 0,  0, 3, 0], "indices": [0, 1, 2]}],
 "instances": [{"mesh": 0, "mask": 0, "transform": [1.000000834465027, 0, 0, -2.75,  0, 1, 0, 50,  0, 0, 1, 0]},
               {"mesh": 0, "transform": [1.000000834465027, 0, 0, -2.75,  0, 1, 0, 0,  0, 0, 1, 0]}]}
END
    aimed='  aimed    \([0-9]*\) rays; \([0-9]*\) hit an instance .*; of these \([0-9]*\) are lost, and \([0-9]*\) of those .*'
    "$raydiff" tree "$dir/one.json" --from rayquery --driver mesa25 --aim 2000 --wide --json "$dir/json" >"$dir/out"
    set -- $(sed -n "s/^$aimed/\1 \2 \3 \4/p" "$dir/out")
    # Each side has every second ray. Some are lost in a larger box, too: the triangle is missed there.
    [ "$#" -eq 4 ] &&
        [ "$1" -eq 2000 ] && [ "$2" -gt 100 ] && [ "$2" -lt 1000 ] && [ "$3" -gt 100 ] && [ "$3" -le "$2" ] &&
        [ "$4" -gt 100 ] && [ "$4" -lt "$3" ] || bad "rays through what boxes lack: $*"
    for field in "aimed ${1-}" "hit ${2-}" "lost ${3-}" "found ${4-}"; do
        grep -q "^ *\"${field% *}\": ${field#* },*$" "$dir/json" || bad "aimed: JSON has another number: $field"
    done
    grep -q '^LOST: instance 1, most x: ray ' "$dir/out" || bad 'the ray that is lost is told'
    expect 0 . tree "$dir/two.json" --from rayquery:serialise --driver mesa25 # an instance has no mesh
    for way in fast_build compact clone update update_into serialise u16:stride20 scaled; do
        expect 0 . tree sphere:n=4 --from "rayquery:$way" --driver mesa25
    done
    # What a driver that is not known builds cannot be read: nothing is wrong with the scene.
    if cc -D_GNU_SOURCE -shared -fPIC -O1 -I. -o "$dir/libforeign.so" tests/driver_trees/foreign_layer.c 2>"$dir/err"; then
        cat >"$dir/foreign.json" <<END
{"file_format_version": "1.1.0", "layer": {"name": "VK_LAYER_RAYDIFF_foreign", "type": "GLOBAL",
 "library_path": "$dir/libforeign.so", "api_version": "1.3.0", "implementation_version": "1", "description": "foreign"}}
END
        export VK_LAYER_PATH="$dir" VK_INSTANCE_LAYERS=VK_LAYER_RAYDIFF_foreign
        expect 77 'of the driver with the UUID 6e6f6e65206f66207468657365000000; lavapipe 25.0.x is read' \
            tree sphere:n=2 --from rayquery --driver mesa25 --save "$dir/foreign.as"
        unset VK_LAYER_PATH VK_INSTANCE_LAYERS
        [ ! -e "$dir/foreign.as" ] || expect 2 'of the driver with the UUID 6e6f6e65206f' tree "$dir/foreign.as"
    else
        echo "SKIP a driver that is not known: $(head -n 1 "$dir/err")"
    fi
else
    echo "SKIPPED: mesa25 builds nothing here: $(head -n 1 "$dir/err")"
fi
echo "driver_trees: $failed failed"
[ "$failed" -eq 0 ]
