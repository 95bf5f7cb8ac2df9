#!/bin/sh
# raydiff leaks on worlds: watertight members miss nothing inside an instance, however it is placed; seams between
# instances are counted and not judged; text and JSON have the same numbers.
#   sh tests/worlds/leaks_worlds.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh
few='--count 4000 --layout f32 --builder median'

# One row's misses: ENGINE TRI.
misses() {
    awk -v engine="$1" -v tri="$2" '
        /^verdict/ { for (i = 1; i <= NF; i++) at[$i] = i; next }
        at["engine"] && $at["engine"] == engine && (!at["tri"] || $at["tri"] == tri) { print $at["misses"] }' "$dir/out"
}

# Inside one instance: Moeller and Trumbore's test leaks and promises nothing, Woop's is kept.
for world in placed-identity placed-turned placed-stretched placed-mirrored placed-far placed-sheared nest mixed wall crowd:n=30; do
    expect 0 . leaks $world --engine cpu,brute --tri mt,woop --box watertight $few --json "$dir/leaks.json"
    grep -q "^$world: [0-9]* placed triangles, [0-9]* instances, each closed" "$dir/out" || bad "leaks $world: is not told of"
    for engine in cpu brute; do
        [ "$(misses $engine woop)" = 0 ] || bad "leaks $world: $engine leaks with woop"
        [ "$(misses $engine mt)" -gt 4 ] || bad "leaks $world: $engine does not leak with mt: rays meet no edges"
        grep -Eq "^kept  *[-f32]* *$engine  *woop" "$dir/out" || bad "leaks $world: $engine with woop promises nothing"
        grep -Eq "^counted  *[-f32]* *$engine  *mt" "$dir/out" || bad "leaks $world: $engine with mt promises something"
    done
    told=$(misses cpu mt)
    grep -q "\"misses\": $told[,}]" "$dir/leaks.json" || grep -A3 '"misses"' "$dir/leaks.json" | grep -qw "$told" ||
        bad "leaks $world: not $told misses in JSON"
    tail -n 1 "$dir/out" | grep -qx 'conclusion: 4 rows: 2 kept, 0 broken, 2 counted' || bad "leaks $world: another conclusion"
done
grep -Eq '"seams": false' "$dir/leaks.json" && grep -Eq '"instances": 30' "$dir/leaks.json" || bad "leaks --json: instances"
[ "$(wc -L <"$dir/out")" -le 80 ] || bad "leaks: lines are longer than 80 columns"

# A box test that is not watertight promises nothing.
expect 0 . leaks placed-turned --engine cpu --tri woop --box robust $few
grep -q '^counted ' "$dir/out" || bad "leaks: robust boxes promise something"

# Several layouts and box tests: each row has the numbers that it has alone, bits that differ among them.
rows() { sed -n '/^layout /,/^what it means/p' "$dir/out" | grep -v '^layout \|^what' | tr -s ' ' | sort; }
together="leaks wall --engine cpu,vulkan --tri mt,woop --count 2000 --builder median --leaf 2 --wide"
"$raydiff" $together --layout f32,rf16 --box watertight,rtrs,robust >"$dir/out" 2>"$dir/err"
case $? in
77) echo "SKIP vulkan: $(tail -n 1 "$dir/err")" ;;
*)
    rows >"$dir/together"
    for layout in f32 rf16; do
        for box in watertight rtrs robust; do
            "$raydiff" $together --layout $layout --box $box >"$dir/out" 2>"$dir/err"
            rows
        done
    done | sort >"$dir/alone"
    [ "$(wc -l <"$dir/alone")" -eq 24 ] || bad "leaks wall: not 24 rows"
    cmp -s "$dir/together" "$dir/alone" || bad "leaks wall: rows are not as alone: $(diff "$dir/together" "$dir/alone" | head -n 2)"
    ;;
esac

# Seams: nothing is judged, not even by the profile that forbids misses.
expect 0 . leaks room --engine cpu --tri mt,woop --box watertight $few --profile dxr --json "$dir/leaks.json"
grep -q '^room: 192 placed triangles, 6 instances, closed only together' "$dir/out" || bad "leaks room: seams are not told of"
grep -q '^seams between instances: counted, not judged$' "$dir/out" || bad "leaks room: is judged"
[ "$(grep -c '^counted' "$dir/out")" -eq 2 ] && [ "$(misses cpu mt)" -gt 4 ] || bad "leaks room: seams are not counted"
grep -Eq '"seams": true' "$dir/leaks.json" || bad "leaks --json: no seams"
expect 1 . leaks placed-turned --engine cpu --tri mt --box watertight $few --profile dxr
grep -q 'BROKEN: [0-9]* missed' "$dir/out" || bad "leaks: DXR forbids misses inside an instance"

# Instances in parts: seams between parts of one instance leak nothing. box.obj is a closed box of 10 * 10 tiles a side,
# stretched and sheared: most seams of its parts lie along axes.
awk 'BEGIN {
    n = 10
    for (face = 0; face < 6; face++)
        for (i = 0; i <= n; i++)
            for (j = 0; j <= n; j++) {
                axis = int(face / 2)
                p[axis] = face % 2 * 2 - 1
                p[(axis + 1) % 3] = 2 * i / n - 1
                p[(axis + 2) % 3] = 2 * j / n - 1
                print "v", p[0], p[1], p[2]
            }
    for (face = 0; face < 6; face++)
        for (i = 0; i < n; i++)
            for (j = 0; j < n; j++) {
                a = face * (n + 1) * (n + 1) + i * (n + 1) + j + 1
                print face % 2 ? "f " a " " a + n + 1 " " a + n + 2 " " a + 1 : "f " a " " a + 1 " " a + n + 2 " " a + n + 1
            }
}' >"$dir/box.obj"
cat >"$dir/box.world.json" <<'JSON'
{"raydiff_world": 1, "meshes": [{"scene": "box.obj"}], "instances": [
 {"mesh": 0, "transform": [0.7, 0, 0, 5,  0, 0.3, 0, 1,  0, 0, 1.1, 2]},
 {"mesh": 0, "transform": [0, 0.7, 0, -5,  0.3, 0, 0, 1,  0, 0, -1.1, 2]},
 {"mesh": 0, "transform": [1, 4, 0, 0,  0, 1, 0, 20,  0, 0, 1, 0]}]}
JSON
for world in placed-turned placed-stretched placed-mirrored placed-sheared crowd:n=30 "$dir/box.world.json"; do
    expect 0 . leaks $world --engine cpu --tri woop --box watertight --count 20000 --layout f32,cwbvh80 \
        --builder sah_sweep --leaf 1 --braid 32
    tail -n 1 "$dir/out" | grep -qx 'conclusion: 2 rows: 2 kept, 0 broken, 0 counted' || bad "leaks $world --braid: leaks"
done
# The option is used: with parts the top is more than the layout holds.
expect 0 . leaks crowd:n=5000,size=1 --engine cpu --tri woop --box watertight --count 1000 --layout rf16 --leaf 1
expect 2 . leaks crowd:n=5000,size=1 --engine cpu --tri woop --box watertight --count 1000 --layout rf16 --leaf 1 --braid 8
grep -q 'rf16 refused: top level' "$dir/out" || bad "leaks --braid: the top has no parts"
expect 2 '^raydiff leaks: sphere:n=2: --braid: is of worlds, not of scenes$' leaks sphere:n=2 --engine cpu --braid 2 $few
expect 2 'rf16: a child record index is at most 32767' explain crowd:n=5000,size=1 --layout rf16 --leaf 1 --count 100 --braid 8
expect 0 . check mixed --engine cpu --layout f32 --count 200 --braid 8 --json "$dir/braid.json"
grep -q '^tree: median, leaf 4, braid 8: ' "$dir/out" || bad "check --braid is not told"
grep -q '"braid": 8' "$dir/braid.json" || bad "check --braid is not in the JSON"
expect 0 . check mixed --engine cpu --layout f32 --count 200 --json "$dir/whole.json"
bytes() { sed -n 's/^ *"node_bytes": \([0-9]*\),$/\1/p' "$1" | head -n 1; }
[ "$(bytes "$dir/braid.json")" -gt "$(bytes "$dir/whole.json")" ] || bad "check --braid makes no parts"
expect 2 '^raydiff check: --braid: sphere:n=2 is a scene' check sphere:n=2 --engine cpu --count 100 --braid 2
expect 2 '^raydiff explain: --braid: sphere:n=2 is a scene' explain sphere:n=2 --count 100 --braid 2

# Each row once, of a scene and of a world: an engine of trees has one for each of their members, brute one for each
# triangle test, those with a test of their own one.
for scene in sphere:n=6 placed-turned; do
    "$raydiff" leaks $scene --engine cpu,brute,embree,embree_robust --tri mt,woop --builder median,sah_binned \
        --box robust,watertight --layout f32,rf16 --count 1000 --json "$dir/rows.json" >"$dir/out" 2>&1
    awk -f tests/values/flat.awk "$dir/rows.json" |
        sed -nE 's/^rows\.([0-9]+)\.(engine|layout|builder|box|tri)=(.*)/\1 \3/p' |
        awk '{ row[$1] = row[$1] " " $2 } END { for (i in row) print row[i] }' | LC_ALL=C sort >"$dir/rows"
    [ "$(wc -l <"$dir/rows")" -eq $((16 + 2 + 1 + 1)) ] && [ -z "$(uniq -d "$dir/rows")" ] ||
        bad "leaks $scene: $(wc -l <"$dir/rows") rows, of which twice: $(uniq -d "$dir/rows" | head -n 1)"
done

# What is no world to be closed, and options that are of scenes.
cat >"$dir/open.world.json" <<'JSON'
{"raydiff_world": 1, "meshes": [{"scene": "sphere:n=2"}, {"scene": "terrain:k=2"}],
 "instances": [{"mesh": 0}, {"mesh": 1, "transform": [1, 0, 0, 5,  0, 1, 0, 0,  0, 0, 1, 0]}]}
JSON
expect 2 'instance 1: no closed mesh: .*; all instances together: no closed mesh' leaks "$dir/open.world.json" --engine cpu $few
expect 2 '^raydiff leaks: wall: --store: is of scenes, not of worlds$' leaks wall --store compact --engine cpu $few
expect 77 . leaks wall --engine cpu_stackless $few
grep -q 'cpu_stackless traces scenes, not worlds' "$dir/out" || bad "leaks: an engine of scenes is not told of"
expect 1 . leaks wall --engine cpu --count 999 --layout f32
grep -q 'vacuous: 999 rays are aimed' "$dir/out" || bad "leaks: 999 rays are taken for a proof"

echo "leaks_worlds: $failed failed"
[ "$failed" -eq 0 ]
