#!/bin/sh
# raydiff check on worlds as a user meets it: which engines trace them, worlds in which nothing can be hit, and
# findings, whose lines fit a terminal and have the numbers of the JSON.
#   sh tests/worlds/check_worlds.sh RAYDIFF
set -u
raydiff=$1
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh
few='--count 200 --repeat 1'

# The last run printed a line like this.
shown() {
    grep -qE -- "$1" "$dir/out" || bad "no line like /$1/"
}

# Engines that trace no worlds: one line of all, and no row, unless one is named.
expect 0 . check crowd:n=10 --layout f32 $few --json "$dir/all.json"
shown '^  [a-z_, ]*cpu_stackless'
[ "$(tr '\n' ' ' <"$dir/out" | grep -oE 'scenes, +not +worlds' | wc -l)" -eq 1 ] || bad 'engines that trace no worlds have several lines'
grep -q '"engine": "cpu_stackless"' "$dir/all.json" && bad 'an engine that was not named has a row'
expect 77 . check crowd:n=10 --engine cpu_stackless --layout f32,rf16 $few
shown '^  cpu_stackless: traces scenes, not worlds$'
[ "$(grep -c '^  cpu_stackless' "$dir/out")" -eq 1 ] || bad 'a line for each row'
expect 77 . check crowd:n=10 --engine cpu,cpu_stackless,fast --layout f32 $few
shown '^  cpu_stackless: traces scenes, not worlds$'
shown '^engine cpu_stackless answered 0 of 1, cannot run here 1: cpu_stackless traces scenes, not worlds$'
shown '^agrees  *f32  *cpu '
expect 77 . check sphere:n=2 crowd:n=10 --engine cpu_stackless --layout f32 $few
shown '^engine cpu_stackless answered 1 of 2, cannot run here 1: cpu_stackless traces'

# A world in which nothing can be hit: one line, exit code 1; others are still checked.
world() { # file, instances
    echo '{"raydiff_world": 1, "meshes": [{"scene": "sphere:n=2"}, {"vertices": [], "indices": []}], "instances": ['"$2"']}' >"$dir/$1.json"
}
world none ''
world inactive '{"mesh": 0, "mask": 0}'
world no_mesh '{"mesh": null}, {"mesh": null}'
world no_triangle '{"mesh": 1}'
world one '{"mesh": 0, "custom": 3}'
for file in none inactive no_mesh no_triangle; do
    expect 1 "$file.json: vacuous: this world has nothing that a ray can hit" check "$dir/$file.json" --json "$dir/x.json" $few
    [ "$(wc -l <"$dir/err")" -eq 1 ] && [ ! -s "$dir/out" ] || bad "$file: more than one line"
    grep -q '"exit": 1,' "$dir/x.json" && grep -q '"refused": "vacuous: ' "$dir/x.json" || bad "$file: the JSON"
    expect 1 . check "$dir/$file.json" "$dir/one.json" --engine cpu --layout f32 $few
    grep -q '^conclusion: 1 of 1 rows agree' "$dir/out" || bad "$file: the next one is not checked"
done
world second '{"mesh": null}, {"mesh": 0}'
expect 0 . check "$dir/second.json" --engine cpu --layout f32 $few
shown 'second.json: 2 instances, 32 triangles, '
expect 1 . check "$dir/none.json" "$dir/one.json" --engine cpu --layout f32 $few
grep -q 'one.json: 1 instance, 32 triangles, ' "$dir/out" || bad 'one instance'

# Options of scenes, of worlds.
expect 2 'check: --modes: sphere is a scene; only worlds have masks and flags' check sphere --modes all
expect 2 'check: --move: crowd is a world; only scenes are moved' check crowd --move 0.1
expect 2 "check: --steps: sphere: 'drift' moves instances, which only worlds have" check sphere --steps refit,refit:drift
expect 2 "check: --steps: 'refit:leap': 'leap' is no motion: still, .* of a world also drift, turn" check crowd --steps refit:leap
expect 2 'check: --steps: not with --bvh, --move' check crowd --steps refit:drift --move 1
expect 0 . check crowd:n=30 --engine cpu,embree_robust --layout f32 --count 500 --repeat 1 \
    --steps refit:drift:2,refit:hide:1,rebuild:exchange:3
has 'a world after steps' 'after step 1, refit:drift:2: 30 instances'
has 'a refit of both levels' '  trees refitted: f32'
has 'other instances are active' '  trees built again: a refit cannot be stored or is not made'
has 'every step is judged' 'conclusion: 8 of 8 rows agree, 0 of 4000 answers WRONG'
expect 2 'check: --bvh: crowd is a world; a tree file is of a scene' check crowd --bvh "$dir/one.json"
expect 2 'check: --store quantised: crowd is a world; only scenes are decoded' check crowd --store quantised
for modes in all mixed drawn; do
    expect 0 . check crowd:n=10 --modes $modes --engine cpu --layout f32 $few
    shown ", set mixed, masks and flags $modes, seed 1\$"
    sed -n 's/^agrees.* cpu  *[0-9]*  *[0-9]*  *[0-9]*  *\([0-9]*\) .*/\1/p' "$dir/out" >"$dir/hits.$modes"
done
[ "$(cat "$dir/hits.all")" -gt "$(cat "$dir/hits.mixed")" ] && [ "$(cat "$dir/hits.mixed")" -gt "$(cat "$dir/hits.drawn")" ] || bad 'modes admit no less'

# What is WRONG, of an engine over a layout whose boxes shrink once the tree was checked.
sed 's/"mine"/"late"/; s/            out->box\[i\] = box(packed, out->child\[i\]);/{ & static volatile int loads; if (loads++ > 3000) out->box[i].hi[0] = out->box[i].lo[0]; }/' \
    fuzz/samples/layout/mine.c >"$dir/late.c"
cc -std=c17 -O2 -ffp-contract=off -shared -fPIC -I. -o "$dir/late.so" "$dir/late.c" || bad 'a layout is not compiled'
for query in closest all; do
    expect 1 . check crowd:n=40 --engine cpu --layout "$dir/late.so" --query $query --count 2000 --repeat 2 \
        --threads 1 --json "$dir/late.json"
    shown '^(WRONG|BITS) .* ray [0-9]+ o='
    grep -E '^  (world|got|expected|cpu.s):' "$dir/out" >"$dir/lines"
    grep -E '.{81}' "$dir/lines" && bad "$query: a line is longer than 80 columns"
    awk -f tests/values/flat.awk "$dir/late.json" >"$dir/flat"
    awk -F= '{ v[$1] = substr($0, length($1) + 2) }
        function place(of, name,  p) {
            p = of "." name
            if (!((p ".instance") in v)) return "nothing"
            return "instance " v[p ".instance"] " geometry " v[p ".geometry"] " triangle " v[p ".triangle"]
        }
        function tag(custom, front) { return " custom " custom " " (front == "true" ? "front" : "back") }
        END {
            for (k = 0; k < 16; k++) { # those that are WRONG, then other bits
                f = "rows.0.findings." k % 8
                if (!((f ".ray") in v) || (v[f ".against"] == "cpu") != (k > 7)) continue
                w = f ".world"
                printf "  world: mask 0x%02X flags 0x%X\n", v[w ".mask"], v[w ".flags"]
                print "  got: " place(w, "got") (v[w ".got"] == "null" ? "" : tag(v[w ".custom"], v[w ".front"]))
                if (v[f ".against"] == "truth") print "  expected: " place(w, "expected")
                else print "  cpu'"'"'s: " place(w, "expected") (v[w ".expected"] == "null" ? "" : tag(v[w ".expected_custom"], v[w ".expected_front"]))
            }
        }' "$dir/flat" >"$dir/wanted"
    [ $(($(wc -l <"$dir/wanted") % 12)) -eq 0 ] && [ -s "$dir/wanted" ] || bad "$query: not four findings of a kind"
    grep -q 'instance [0-9]* geometry 0 triangle [0-9]*' "$dir/wanted" || bad "$query: no place"
    cmp -s "$dir/lines" "$dir/wanted" || { diff "$dir/lines" "$dir/wanted" | head; bad "$query: the text has other numbers than the JSON"; }
done
echo "check_worlds: $failed failed"
[ "$failed" -eq 0 ]
