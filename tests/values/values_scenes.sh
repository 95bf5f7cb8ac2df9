#!/bin/sh
# The numbers of `raydiff scene`, `construct`, `precompute` and `judge gen` by value: against the scene as OBJ, trees as
# JSON. sh tests/values/values_scenes.sh RAYDIFF [info list names construct precompute gen]
set -u
raydiff=$1
shift
. tests/values/compare.sh
echo none=0 >"$dir/none" # where there is no JSON

# Corners that coincide or lie on a line, the same triangle thrice in three orders, two vertices of none.
cat >"$dir/odd.obj" <<'END'
v 0 0 0
v 1 0 0
v 0 2 0
v 0 0 -3.5
v 90 -90 90
v 2 0 0
v 7 7 -95
f 1 2 3
f 2 3 1
f 3 2 1
f 1 2 4
f 1 1 2
f 2 2 2
f 1 2 6
END

# Writes the scene as $dir/x.obj and as JSON to $dir/other.flat; what convert tells is so.
converted() {
    run scene convert "$1" "$dir/x.obj"
    told=$(sed -n 's/^.*: \([0-9]*\) triangles\{0,1\}, \([0-9]*\) vert[a-z]*$/\1 \2/p' "$dir/text")
    [ "$told" = "$(grep -c '^f ' "$dir/x.obj") $(grep -c '^v ' "$dir/x.obj")" ] || bad "$ran: tells '$told'"
    case $(cat "$dir/text") in
    *'not kept'*) kept=no ;;
    *) kept=yes ;;
    esac
    run scene convert "$1" "$dir/x.json" && awk -f tests/values/flat.awk "$dir/x.json" >"$dir/other.flat"
}
play_info() {
    for scene in rtrs sphere:n=3 cornell:n=2 grid:n=4,z=-3 platonic soup:n=1 soup:n=0 "$dir/odd.obj"; do
        converted "$scene"
        [ $kept = "$(case $scene in rtrs | cornell*) echo no ;; *) echo yes ;; esac)" ] || bad "$scene: what is not kept is told: $kept"
        run scene info "$scene" --json && cp "$dir/text" "$dir/json" && run scene info "$scene" &&
            values scene_info 30 "$dir/other.flat" "$dir/x.obj" "$dir/text"
    done
    for world in mixed:count=200 placed-mirrored:count=9 placed-thin placed-identity wall:n=3 crowd:n=30; do
        run scene convert "$world" "$dir/x.json" && converts=$(sed 's/^.*: //' "$dir/text")
        awk -f tests/values/flat.awk "$dir/x.json" >"$dir/other.flat"
        run scene info "$world" --json && cp "$dir/text" "$dir/json" && run scene info "$world" && values world_info 20 "$dir/other.flat" "$dir/text"
        [ "$converts" = "$(awk -F '[.=]' '{ v[$3] = $4 }
            END { print v["meshes"] " mesh" (v["meshes"] == 1 ? "" : "es") ", " v["instances"] " instances, " v["placed_triangles"] " placed triangles" }' "$dir/flat")" ] || bad "$world: convert tells $converts"
    done
    # On a grid: as many points an axis as there may be, the nearest one, and the longest way is told.
    for moved in sphere:n=9,8 soup:n=50,12 cornell:n=2,21 terrain:k=4,10 platonic,9; do
        scene=${moved%,*} bits=${moved##*,}
        run scene convert "$scene" "$dir/as.obj" && run scene convert "$scene" "$dir/on.obj" --bits "$bits" && awk -v bits="$bits" '
            FNR == 1 { file++ }
            file == 1 && $1 == "v" { for (k = 0; k < 3; k++) { x = as[n, k] = $(k + 2); x = x < 0 ? -x : x; slack = x * 1e-7 > slack ? x * 1e-7 : slack }; n++ }
            file == 2 && $1 == "v" {
                far = 0
                for (k = 0; k < 3; k++) {
                    at = $(k + 2); d = at - as[m, k]; far += d * d; on[m, k] = at
                    if (m == 0 || at < low[k]) low[k] = at
                    if (m == 0 || at > high[k]) high[k] = at
                }
                if (far > most) most = far
                m++
            }
            file == 3 && /^on a grid of/ { lines++; told = $12; if ($5 != bits || $(NF - 3) != 0 || $(NF - 2) != "triangles") bad = 1 }
            END {
                most = sqrt(most)
                for (k = 0; k < 3; k++) { # the largest power of two whose grid has no more points
                    step = 2 ^ -80
                    while ((high[k] - low[k]) / step > 2 ^ bits - 1) step *= 2
                    for (i = 0; i < m; i++) {
                        d = on[i, k] - as[i, k]; if (d < 0) d = -d
                        at = (on[i, k] - low[k]) / step
                        if ((at - int(at + 0.5)) ^ 2 > (slack / step) ^ 2 || d > step / 2 + slack) bad = 1
                    }
                }
                exit !(n == m && lines == 1 && !bad && told >= most - slack && told <= most * 1.001 + slack)
            }' "$dir/as.obj" "$dir/on.obj" "$dir/text" || bad "scene convert --bits $bits of $scene: $(grep grid "$dir/text")"
    done
    # Several scenes, in their order.
    run scene info rtrs sphere:n=3 --json && cp "$dir/text" "$dir/json" && awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    [ "$(sed -n 's/^scenes.[01].triangles=//p' "$dir/flat" | tr '\n' ' ')" = '40 72 ' ] || bad 'scene info of two scenes'
}
play_construct() {
    seen='--camera-pos 0 1 -8 0 0 0'
    while read -r options; do
        set -- $options
        run construct --out "$dir/made.json" $seen "$@" && cp "$dir/err" "$dir/text2" && run construct --out "$dir/made.json" $seen "$@" --json &&
            cp "$dir/text" "$dir/json" && awk -f tests/values/flat.awk "$dir/made.json" >"$dir/other.flat" &&
            values construct 15 "$dir/other.flat" "$dir/text2"
    done <<END
--camera-orbit --model sphere:n=2 default
--camera-fixed --light 1 2 3 1 --light 4 5 6 2 --light 7 8 9 1 --material 0.4 0.4 0.3 0.6 0.3 0.1 50 --model platonic:which=3 0 --model platonic:which=0 default --translate 2 0 0 --model sphere:n=3 0 --scale -1 1 1
--camera-fixed --fill-normals --material 1 0 0 1 0 0 1 --material 0 1 0 1 0 0 1 --model $dir/odd.obj 1 --model sphere:n=2 0
END
}
play_precompute() {
    for options in 'rtrs --builder rtrs' 'cornell:n=3 --builder rtrs' 'cornell:n=3 --builder sah_sweep' "$dir/odd.obj --builder median --item-count 2" \
        'sphere:n=4 --builder lbvh --item-count 8'; do
        set -- $options
        converted "$1"
        run precompute --scene "$@" --out "$dir/tree.json" && cp "$dir/err" "$dir/text2" &&
            awk -f tests/values/flat.awk "$dir/tree.json" | sed 's/^/tree./' >"$dir/other.flat"
        "$raydiff" precompute --scene "$1" --verify "$dir/tree.json" >"$dir/verified" 2>"$dir/err" # 1: loose boxes
        for layout in f32 rf16; do # of boxes that are too small neither is sound
            "$raydiff" precompute --scene "$@" --layout $layout --out "$dir/packed" 2>"$dir/err" &&
                "$raydiff" precompute --scene "$1" --verify "$dir/packed" >>"$dir/verified" 2>"$dir/err"
        done
        awk -v least=14 -f tests/values/lib.awk -f tests/values/bench/tree.awk -f tests/values/scenes/obj.awk -f tests/values/scenes/precompute.awk "$dir/none" \
            "$dir/other.flat" "$dir/x.obj" "$dir/text2" "$dir/verified" || bad "precompute --scene $options"
    done
}
play_gen() {
    converted sphere:n=2
    for query in closest any; do
        for seed in 1 7; do
            what="sphere:n=2 --query $query --seed $seed --count 40"
            run judge gen $what && cp "$dir/text" "$dir/hex" && run judge gen $what --decimal --out "$dir/decimal" &&
                awk -v least=700 -v query=$query -v count=40 -v seed=$seed -v scene=sphere:n=2 -f tests/values/lib.awk -f tests/values/floats.awk -f tests/values/scenes/obj.awk \
                    -f tests/values/scenes/gen.awk "$dir/none" "$dir/x.obj" "$dir/hex" "$dir/decimal" || bad "judge gen $what"
            sed -n 's/^from \([0-9a-f]*\) .*/\1/p' "$dir/hex" >>"$dir/hashes"
        done
    done
    [ "$(sort -u "$dir/hashes" | wc -l)" -eq 4 ] || bad 'judge gen: other rays, or another query, and the same hash'
}

# The defaults are those that stand there; an end of a range belongs to it, and what is beyond does not.
play_list() {
    run scene list
    awk '/^  [a-z]/ { name = $1 }
        /^    [a-z]+ +[-0-9.e+]+ to / {
            value = $5
            gsub(/[][]/, "", value)
            print name, $1, $2, $4, value
        }' "$dir/text" >"$dir/params"
    [ "$(wc -l <"$dir/params")" -ge 20 ] || bad 'scene list: parameters'
    for name in $(cut -d' ' -f1 "$dir/params" | uniq); do
        all=$(awk -v name="$name" '$1 == name { printf "%s%s=%s", n++ ? "," : "", $2, $5 }' "$dir/params")
        run scene info "$name" && sed 1d "$dir/text" >"$dir/default"
        run scene info "$name:$all" && sed 1d "$dir/text" | cmp -s - "$dir/default" || bad "$name is not $name:$all"
    done
    awk '{
        print 0, $1 ":" $2 "=" $3
        printf "2 %s:%s=%.9g\n2 %s:%s=%.9g\n", $1, $2, $3 - 1 - $3 ^ 2, $1, $2, $4 + 1 + ($4 > 1e6) * $4
    }' "$dir/params" >"$dir/tries"
    while read -r want spec; do
        "$raydiff" scene info "$spec" >"$dir/text" 2>"$dir/err"
        got=$?
        [ "$got" -eq "$want" ] || bad "scene info $spec: exit $got, not $want"
    done <"$dir/tries"
}

# What is named in a list can be named elsewhere: the tables are those of each option's complaint, and one kind is its part.
play_names() {
    run list && cp "$dir/text" "$dir/whole"
    run list '' && cmp -s "$dir/text" "$dir/whole" || bad 'list of all kinds: not the whole list'
    : >"$dir/parts"
    while read -r kind option given; do
        run list $kind || continue
        cat "$dir/text" >>"$dir/parts"
        [ "$(grep -c '^[a-z]' "$dir/text")" -eq 1 ] && grep -q "^$kind" "$dir/text" || bad "list $kind: not one kind"
        names=$(awk '/^  [a-z]/ { printf "%s%s", n++ ? ", " : "", $1 }' "$dir/text")
        # shellcheck disable=SC2086 # words of a command
        "$raydiff" $given --$option nothing >"$dir/text" 2>"$dir/err"
        known=$(sed -n 's/.* are: \([^;]*\).*/\1/p' "$dir/err" | sed 's/, pipe:COMMAND.*//; s/ (see raydiff.*//; s/, \.\.\. .*/, /; s/; did you mean.*//')
        case "$names" in
        "$known") ;;
        "$known"*) [ "$kind" = layouts ] || bad "list $kind: '$names', known are '$known'" ;;
        *) bad "list $kind: '$names', known are '$known'" ;;
        esac
        tables=$((${tables:-0} + 1))
    done <<END
builders builder check soup
layouts layout check soup
box box check soup
triangle tri check soup
queries query check soup
engines engine check soup
END
    for kind in scenes ray storages; do run list $kind && cat "$dir/text" >>"$dir/parts"; done
    cmp -s "$dir/parts" "$dir/whole" || bad 'list: not its parts, one after the other'
    [ "$tables" -eq 6 ] || bad "list: $tables tables"
    # Generators: those of the list of scenes are those with parameters, and what worlds are by default is what convert tells.
    run list scenes && awk '/^  [a-z]/ { print $1 }' "$dir/text" >"$dir/generators"
    run scene list
    awk '/^generators of worlds/ { exit } /^  [a-z]/ { print $1 }' "$dir/text" | cmp -s - "$dir/generators" || bad 'scene list: other generators than list scenes'
    awk '/^  [a-z]/ { name = $1 } sub(/^    \(by default /, "") { sub(/\)$/, ""); print name ": " $0 }' "$dir/text" >"$dir/worlds"
    [ "$(wc -l <"$dir/worlds")" -ge 8 ] || bad 'scene list: worlds'
    while IFS= read -r line; do
        run scene convert "${line%%:*}" "$dir/x.world.json"
        [ "${line%%:*}: $(sed 's/^[^:]*: //' "$dir/text")" = "$line" ] || bad "scene list: $line, but convert tells $(cat "$dir/text")"
    done <"$dir/worlds"
    # Meshes that were fetched: every file but hidden ones, and its bytes.
    program=$(realpath "$raydiff")
    mkdir -p "$dir/sources/scenes/fetched"
    (cd "$dir/sources" && "$program" scene list) | grep -qx '  none here: `make scenes` fetches them' || bad 'scene list: no mesh, and it is not told'
    : >"$dir/sources/scenes/fetched/.hidden.obj"
    printf 'v 0 0 0\n' >"$dir/sources/scenes/fetched/b.obj"
    cp "$dir/odd.obj" "$dir/sources/scenes/fetched/a.obj"
    [ "$(cd "$dir/sources" && "$program" scene list | sed -n '/^fetched/,$s/^  *scenes/scenes/p' | tr -s ' ')" = "scenes/fetched/a.obj $(($(wc -c <"$dir/odd.obj"))) bytes
scenes/fetched/b.obj 8 bytes" ] || bad 'scene list: fetched meshes'
}

for part in ${*:-info list names construct precompute gen}; do
    "play_$part"
    case $part in
    info) all_seen scene_info && all_seen world_info ;;
    construct) all_seen construct ;;
    esac
done
echo "values_scenes: $failed failed"
[ "$failed" -eq 0 ]
