#!/bin/sh
# What raydiff bench matrix and bench fast print, number by number: against what raydiff check says of
# the same scene, against each other, and tables against rows. No speed is expected, only that ratios,
# means and the front are those of the speeds that stand there.
#   sh tests/scripts/bench.sh RAYDIFF
set -u
raydiff=$1
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh

# Rows of FILE.csv by the names of their columns: c["bytes"] is the place of one, near(a, b, by) says
# whether two numbers are that close, and wrong(TEXT) that something is not as it should be.
rows() { # file, awk program, variables...
    file=$1 program=$2
    shift 2
    awk -F, "$@" '
        function near(a, b, by) { return a - b <= by && b - a <= by }
        function wrong(text) { print "FAILED  " FILENAME ": " $0 ": " text; bad = 1 }
        FNR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next }
        '"$program"'
        END { exit bad }' "$file" || failed=$((failed + 1))
}
json() { sed -n "s/^ *\"$1\": \([0-9]*\),*$/\1/p" "$2" | head -n 1; }

# A square of two triangles fills its box. Every ray reads the node for its box; one that hits reads it again, and of
# each triangle an item, an index and three vertices, 11 lines.
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n' >"$dir/square.obj"
expect 0 . bench matrix --wide --scene "$dir/square.obj" --rounds 1 --count 500 --threads 1 --engine cpu --layout f32 \
    --csv "$dir/square.csv"
for kind in primary random; do
    expect 0 . check "$dir/square.obj" --builder sah_binned --layout f32 --engine cpu --rays $kind --count 500 \
        --repeat 1 --brute 0 --json "$dir/$kind.json"
done
rows "$dir/square.csv" '$c["engine"] == "cpu" {
    if (!near($c["prim_line_bytes"] * 500, 64 * (500 + 11 * hits_prim), 1)) wrong("prim_line_bytes")
    if (!near($c["rand_line_bytes"] * 500, 64 * (500 + 11 * hits_rand), 1)) wrong("rand_line_bytes")
    if ($c["node_bytes"] != 32 || $c["item_bytes"] != 8 || $c["scene_bytes"] != 72) wrong("bytes")
    if ($c["asked"] != 1000 || $c["leak_rays"] != 0) wrong("rays asked") }' \
    -v hits_prim="$(json hits "$dir/primary.json")" -v hits_rand="$(json hits "$dir/random.json")"

# Engines with trees of their own are looked at in theirs. A dual-split tree of one leaf has two words, and no ray reads
# them that misses the box. A leaf of a k-d tree has a node, and of each triangle a number and 48 bytes, the second
# ones on two lines. The bytes are those that the engines count.
expect 0 . bench matrix --wide --scene "$dir/square.obj" --scene sphere:n=4 --rounds 1 --count 500 --threads 1 \
    --engine kd,dual_split --layout f32 --csv "$dir/own.csv"
expect 0 . check sphere:n=4 --builder sah_binned --layout f32 --engine dual_split --count 100 --repeat 1 --brute 0 \
    --json "$dir/dual.json"
expect 0 . check sphere:n=4 --engine kd --count 100 --repeat 1 --brute 0 --json "$dir/kd.json"
rows "$dir/own.csv" '$c["triangles"] == 2 && $c["engine"] ~ /^(kd|dual_split)$/ {
    dual = $c["engine"] == "dual_split"
    found++
    if (!near($c["prim_line_bytes"] * 500, 64 * (dual ? 11 : 6) * hits_prim, 1)) wrong("prim_line_bytes")
    if (!near($c["rand_line_bytes"] * 500, 64 * (dual ? 11 : 6) * hits_rand, 1)) wrong("rand_line_bytes")
    if ($c["node_bytes"] != 8 || $c["item_bytes"] != (dual ? 8 : 104) || $c["scene_bytes"] != (dual ? 72 : ""))
        wrong("bytes")
}
$c["triangles"] > 2 && $c["engine"] ~ /^(kd|dual_split)$/ {
    dual = $c["engine"] == "dual_split"
    found++
    if ($c["node_bytes"] != (dual ? dual_nodes : kd_nodes) || $c["item_bytes"] != (dual ? dual_items : kd_items))
        wrong("not as check says")
}
END { if (found != 4) wrong("not four rows of own trees") }' \
    -v hits_prim="$(json hits "$dir/primary.json")" -v hits_rand="$(json hits "$dir/random.json")" \
    -v dual_nodes="$(json node_bytes "$dir/dual.json")" -v dual_items="$(json item_bytes "$dir/dual.json")" \
    -v kd_nodes="$(json node_bytes "$dir/kd.json")" -v kd_items="$(json item_bytes "$dir/kd.json")"

# A blind tracer's WRONG answers are those of three checks: nothing stands between the square and the light.
sed 's/size > 0\.0f/size > 1e30f/' fuzz/samples/sample_tracer.c >"$dir/blind.c" && cc -O1 -o "$dir/blind" "$dir/blind.c" || failed=1
expect 1 . bench matrix --wide --scene "$dir/square.obj" --rounds 1 --count 500 --engine "pipe:$dir/blind" --csv "$dir/blind.csv"
blind=0
for rays in primary 'random --seed 1' 'random --seed 2 --query any'; do
    expect 1 . check "$dir/square.obj" --engine "pipe:$dir/blind" --rays $rays --count 500 --repeat 1 --json "$dir/blind.json"
    blind=$((blind + $(json wrong "$dir/blind.json")))
done
rows "$dir/blind.csv" '$c["engine"] ~ /^"?pipe/ {
    found = 1
    # Each is judged two times: when it is asked, and when it is timed.
    if (blind < 300 || $c["judged_wrong"] != 2 * blind || $c["compared"] != 4000) wrong("answers of a blind tracer") }
    END { if (!found) wrong("no row of a blind tracer") }' -v blind="$blind"

# The front anew, and the fastest of ours that lose nothing.
front='{
    count++
    size[count] = $c["bytes_per_triangle"]; speed[count] = $c["mean_ratio"]; line[count] = $0
    error[count] = ($c["lost"] + $c["leaks"]) / ($c["asked"] + $c["leak_rays"])
    front[count] = $c["front"] == "true"; ours[count] = $c["layout"] != "-" && error[count] == 0
    fastest[count] = $c["worth"] == "fastest"
}
END {
    for (i = 1; i <= count; i++) {
        on = 1; first = ours[i]; $0 = line[i]
        for (k = 1; k <= count; k++) {
            if (size[k] <= size[i] && speed[k] >= speed[i] && error[k] <= error[i] &&
                (size[k] < size[i] || speed[k] > speed[i] || error[k] < error[i])) on = 0
            if (ours[k] && speed[k] > speed[i]) first = 0
        }
        if (on != front[i]) wrong("front")
        if (first != fastest[i]) wrong("fastest")
    }
}'

# A closed mesh, everybody who takes part.
scene=sphere:n=4
expect 0 . bench matrix --wide --scene $scene --rounds 3 --count 500 --threads 1 --csv "$dir/m.csv"
cp "$dir/out" "$dir/m.txt"
rows "$dir/m.csv" '{
    n = split("prim rand diff o-shad o-rand", kind, " ")
    product = 1
    for (k = 1; k <= n; k++) {
        ratio = $c[kind[k] "_ratio"]
        if (!(ratio >= $c[kind[k] "_ratio_min"] && ratio <= $c[kind[k] "_ratio_max"])) wrong(kind[k] " spread")
        if ($c["name"] == "embree" && ratio != 1) wrong(kind[k] " ratio to itself")
        product *= k <= 4 ? ratio : 1
    }
    if (!near($c["mean_ratio"] ^ 4 / product, 1, 1e-5)) wrong("mean of the first four")
    bytes = $c["node_bytes"] + $c["item_bytes"] + $c["scene_bytes"]
    if (!near($c["bytes_per_triangle"] * $c["triangles"], bytes, 1e-3)) wrong("bytes per triangle")
    if ($c["rays"] != ($c["engine"] == "cpu" ? 63 : 500)) wrong("rays")
    if ($c["asked"] != 1000 || $c["leak_rays"] != 1000) wrong("rays asked")
    if ($c["layout"] != "-" && ($c["lost"] > 0 || $c["wrong"] > 0 || $c["leaks"] > 0)) wrong("errors")
    if ($c["engine"] == "fast" && $c["held_bytes"] != bytes) wrong("bytes of fast")
    if ($c["name"] == "cpu f32" && $c["mean_ratio"] > 1) wrong("every eighth ray is counted eight times")
    for (k = 1; k <= 3 && $c["layout"] != "-"; k++)
        if (!($c[kind[k] "_line_bytes"] > $c[kind[k] "_beyond_l1"] &&
              $c[kind[k] "_beyond_l1"] >= $c[kind[k] "_beyond_l2"])) wrong("lines of " kind[k])
}'"$front"'
END { if (count < 15) wrong("too few rows") }'

# Of two of one size the slower is on the front, since it loses less.
expect 0 . bench matrix --wide --scene $scene --rounds 3 --count 500 --threads 1 --engine embree_robust --csv "$dir/robust.csv"
rows "$dir/robust.csv" "$front"'END { if (count != 2 || !(error[1] > error[2])) wrong("errors of two") }'

# The bytes are those of raydiff check.
expect 0 . check $scene --builder sah_binned --layout f32 --store compact --engine cpu --count 100 --repeat 1 \
    --brute 0 --json "$dir/compact.json"
rows "$dir/m.csv" '$c["name"] == "cpu f32 compact" {
    if ($c["node_bytes"] != nodes || $c["item_bytes"] != items || $c["scene_bytes"] != 0) wrong("not as check says")
    found = 1 }
    END { if (!found) wrong("no row of compact") }' \
    -v nodes="$(json node_bytes "$dir/compact.json")" -v items="$(json item_bytes "$dir/compact.json")"

# Tables say what the rows say: the name is in columns 3 to 32.
awk -F, '
    function near(a, b, by) { return a - b <= by && b - a <= by }
    function name_of(line) { line = substr(line, 3, 30); sub(/ *$/, "", line); return line }
    function same(is, what, by) { if (!near(is, value[name, what], by)) { print "FAILED  " $0 ": " what; bad = 1 } }
    function part(is, what) { if (is != "-") same(is * value[name, "triangles"], what, 0.06 * value[name, "triangles"]) }
    FNR == NR { if (FNR == 1) split($0, head, ","); else for (i = 1; i <= NF; i++) value[$5, head[i]] = $i; next }
    / speed, least-most/ { sizes = 0 } /^  bytes per triangle/ { sizes = 1 }
    { name = name_of($0) }
    !((name, "triangles") in value) { next }
    {
        n = split("prim rand diff o-shad o-rand", kind, " ")
        rest = substr($0, 33)
        gsub(/[()]/, " ", rest); if (!sizes) gsub(/-/, " ", rest); gsub(/ of /, " ", rest)
        split(rest, f, " ")
        told++
    }
    !sizes {
        for (k = 1; k <= n; k++) {
            same(f[3 * k - 2], kind[k] "_ratio", 0.006)
            same(f[3 * k - 1], kind[k] "_ratio_min", 0.006)
            same(f[3 * k], kind[k] "_ratio_max", 0.006)
        }
        same(f[16], "mean_ratio", 0.006); same(f[17], "mean_warm", 0.006); same(f[18], "prim_mrays", 0.0006)
    }
    sizes {
        part(f[1], "node_bytes"); part(f[2], "item_bytes"); part(f[3], "scene_bytes")
        same(f[4], "bytes_per_triangle", 0.06)
        for (k = 1; k <= 3 && value[name, "layout"] != "-"; k++) {
            same(f[3 * k + 2], kind[k] "_line_bytes", 0.6)
            same(f[3 * k + 3], kind[k] "_beyond_l1", 0.6)
            same(f[3 * k + 4], kind[k] "_beyond_l2", 0.6)
        }
        at = value[name, "layout"] != "-" ? 14 : 8
        same(f[at], "lost", 0); same(f[at + 1], "asked", 0); same(f[at + 2], "wrong", 0)
        same(f[at + 4], "leaks", 0); same(f[at + 5], "leak_rays", 0)
        same(f[at + 6], "allowed", 0); same(f[at + 7], "judged_wrong", 0)
    }
    END { if (told < 30) { print "FAILED  tables of bench matrix have " told + 0 " rows"; bad = 1 } exit bad }
' "$dir/m.csv" "$dir/m.txt" || failed=$((failed + 1))

# bench fast: spreads, means, what all agree on, and the same bytes as in the matrix.
expect 0 . bench fast --scene "$dir/square.obj" --rounds 3 --count 500 --csv "$dir/f.csv"
rows "$dir/f.csv" '{
    if (!($c["ratio"] >= $c["ratio_least"] && $c["ratio"] <= $c["ratio_most"])) wrong("spread")
    if ($c["rays"] == "primary" && $c["missed"] != 0) wrong("missed")
    if (!($c["warm"] >= $c["warm_least"] && $c["warm"] <= $c["warm_most"])) wrong("warm spread")
    if ($c["engine"] == "embree" && ($c["ratio"] != 1 || $c["warm"] != 1)) wrong("ratio to itself") }'
# Named engines race Embree, which is there once; one that is no tracer of the processor is none of them.
expect 0 . bench fast --scene "$dir/square.obj" --rounds 1 --count 100 --engine cpu,embree,fast --csv "$dir/f.csv"
[ "$(cut -d , -f 4 "$dir/f.csv" | sort | uniq -c | tr -s ' ' | tr '\n' ';')" = ' 4 cpu; 4 embree; 1 engine; 4 fast;' ] ||
    bad "bench fast --engine: $(cut -d , -f 4 "$dir/f.csv" | sort | uniq -c | tr '\n' ';')"
expect 2 'runs on a GPU' bench fast --scene "$dir/square.obj" --engine vulkan
expect 2 'tests every triangle' bench fast --scene "$dir/square.obj" --engine cpu,brute
# What is wrong, or proves nothing, ends a run with 1, and its rows and figures are written all the same.
for out in csv json svg; do
    expect 1 . bench error --scene needles:n=1 --count 1 --rays random --engine cpu --layout f32 --tri mt --threads 1 --rounds 1 \
        --$out "$dir/nothing.$out"
    [ -s "$dir/nothing.$out" ] || bad "bench error: exit 1, and no --$out"
done
# So are those of the scenes that can be read, beside one that cannot.
for benchmark in error matrix; do
    for list in "$dir/square.obj;$dir/none.obj" "$dir/none.obj;$dir/square.obj"; do
        rm -f "$dir/one.csv" "$dir/one.svg"
        expect 2 'none.obj: No such file' bench $benchmark --scene "$list" --count 60 --rounds 1 --engine cpu --layout f32 --threads 1 \
            --csv "$dir/one.csv" --svg "$dir/one.svg"
        grep -q "^$benchmark,$dir/square.obj,2," "$dir/one.csv" && grep -q '<svg' "$dir/one.svg" || bad "bench $benchmark of $list: no rows, or no figure"
    done
done
# Without a name no layout as published is played: it tests every node, and its speed compares with nothing.
expect 0 . bench matrix --scene "$dir/square.obj" --count 4 --rounds 1 --threads 1 --engine cpu --csv "$dir/own.csv"
[ "$(grep -c ',cpu,f32,' "$dir/own.csv")" -eq 1 ] && [ "$(grep -c ',cpu,' "$dir/own.csv")" -gt 20 ] && ! grep -q ',rtrs_' "$dir/own.csv" ||
    bad "bench matrix: of its own it plays $(grep ',rtrs_' "$dir/own.csv" | cut -d , -f 5-7)"
# Whatever is named has its rows: each layout with each box test and each triangle test, once for each set of rays.
expect 0 . bench error --scene "$dir/square.obj" --count 20 --rounds 1 --threads 1 --engine cpu,brute --layout f32,rf16 \
    --box robust,watertight,rtrs --tri mt,woop --rays random,edges --csv "$dir/each.csv"
for rays in random edges; do
    for tri in mt woop; do
        echo "$rays brute - - $tri"
        for layout in f32 rf16; do for box in robust watertight rtrs; do echo "$rays cpu $layout $box $tri"; done; done
    done
done | sort >"$dir/named"
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next } $c["engine"] ~ /^(cpu|brute)$/ {
    print $c["rays"], $c["engine"], $c["layout"] == "" ? "-" : $c["layout"], $c["box"] == "" ? "-" : $c["box"], $c["tri"] }' \
    "$dir/each.csv" | sort | diff "$dir/named" - >"$dir/out" || bad "bench error: not what was named: $(head -n 5 "$dir/out")"
# A verdict has its colour, and the conclusion that of the exit code: what agrees is green, what is wrong or proves
# nothing red, what is only counted dim.
for of in needles:n=1 "$dir/square.obj"; do
    for benchmark in layouts 'error --rays random' matrix; do
        "$raydiff" bench $benchmark --scene "$of" --count 1 --rounds 1 --engine cpu --layout f32,rtrs_rf --threads 1 --color always \
            >"$dir/out" 2>"$dir/err"
        code=$?
        esc=$(printf '\033')
        sed -n "s/^$esc\[\([0-9;]*\)m\([a-zA-Z]*\) *$esc\[0m.*/\1 \2/p" "$dir/out" >"$dir/painted"
        awk -v code="$code" '{ seen++ }
            $2 == "bench" { want = code == 0 ? "32" : "1;31" }
            $2 == "agrees" { want = "32" }
            $2 == "counted" { want = "2" }
            $2 ~ /^(WRONG|vacuous)$/ { want = "1;31" }
            $1 != want { print "FAILED " $0; bad = 1 }
            END { exit bad || (code < 2 && seen < 2) }' "$dir/painted" || bad "bench $benchmark $of: exit $code: $(sort "$dir/painted" | uniq -c)"
    done
done
grep -q vacuous "$dir/painted" && bad 'a square that nothing hits'
# A table is explained once, however many numbers of threads it is made for.
expect 0 . bench matrix --scene "$dir/square.obj" --count 60 --engine cpu --layout f32 --rounds 1
[ "$(grep -c 'agrees *cpu' "$dir/out")" -eq 2 ] && [ "$(grep -c '^lost of ' "$dir/out")" -eq 1 ] ||
    bad "bench matrix: not two tables that are explained once"
# What is left out of a scene is told once of it, not of each set of its rays.
for list in sphere:n=2 'sphere:n=2;sphere:n=3'; do
    expect 0 . bench layouts --scene "$list" --count 10 --rounds 1 --driver no-such-driver
    scenes=$(echo "$list" | tr ';' '\n' | wc -l)
    grep ' left out: ' "$dir/out" | sort | uniq -c | awk -v scenes="$scenes" '$1 != scenes { bad = 1 } END { exit bad || NR < 3 }' ||
        bad "bench layouts of $scenes scenes: $(grep ' left out: ' "$dir/out" | sort | uniq -c | head -n 3)"
done
# What there is one of is refused in every list of two, and one of each is taken.
only="--engine cpu --layout f32 --frames 1 --size 8x6 --out $dir/one"
for one in --box=robust,watertight --box=watertight,robust --tri=mt,woop --tri=woop,mt "--scene=$dir/square.obj;sphere:n=2"; do
    expect 2 '^raydiff bench: frames: one scene, one box test and one triangle test' bench frames $only $one
    expect 0 . bench frames $only "${one%%[,;]*}"
done
for one in --layout=rf16,f32 --layout=f32,rf16; do
    expect 2 '^raydiff bench: special: one layout, and its own scenes' bench special $one
done
# What both engines hit is as much by either: what one hits and what it misses.
wall=$dir/wall.obj
"$raydiff" scene convert grid:n=4,height=0 "$wall" >"$dir/out" 2>"$dir/err" || bad "no wall"
expect 0 . bench fast --scene "$wall" --rounds 1 --count 500 --csv "$dir/f.csv"
for engine in embree embree_robust; do
    "$raydiff" check "$wall" --engine $engine --rays bounce --count 500 --repeat 1 --json "$dir/$engine.json" >"$dir/out" 2>"$dir/err"
done
rows "$dir/f.csv" '$c["rays"] == "bounce" && $c["engine"] == "embree" { few = $c["missed"] }
    $c["rays"] == "bounce" && $c["engine"] == "embree robust" { robust = $c["missed"] }
    END { if (few + hits != robust + more || few <= robust) wrong("missed: " few " and " robust ", hits: " hits " and " more) }' \
    -v hits="$(json hits "$dir/embree.json")" -v more="$(json hits "$dir/embree_robust.json")"
expect 0 . bench fast --scene $scene --rounds 1 --count 500 --csv "$dir/f.csv"
rows "$dir/f.csv" '$c["engine"] == "fast" { if (!near($c["bytes_per_triangle"], bytes, 1e-6)) wrong("bytes per triangle") }' \
    -v bytes="$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } $at["name"] == "fast sah_sweep" {
        print ($at["node_bytes"] + $at["item_bytes"] + $at["scene_bytes"]) / $at["triangles"] }' "$dir/m.csv")"

echo "bench: $failed failed"
[ "$failed" -eq 0 ]
