#!/bin/sh
# Pictures of the tree as a user meets them: sums of pixels, files beside the picture, engines,
# what is refused.
#   sh tests/scripts/show.sh RAYDIFF
set -u
raydiff=$1
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh

size="-w 120 -h 90"
scene=terrain:k=5

# The column of a CSV file, added up; empty fields are no values.
sum_of() { awk -F, -v column="$2" 'NR > 1 { sum += $column } END { printf "%d", sum }' "$1"; }
# A number of a JSON file, the n-th line that has it.
json() { grep "\"$2\":" "$1" | sed -n "${3:-1}p" | sed 's/.*: //; s/,$//; s/\.0$//'; }

# Three ways to the same sum: the pixels, the statistics, the engine's own counter.
for what in boxes triangles; do
    expect 0 . render $scene $size --show $what --layout f32,rf16 --out "$dir/a.png" \
        --csv "$dir/a.csv" --json "$dir/a.json"
    [ "$(wc -l <"$dir/a.csv")" -eq $((120 * 90 + 1)) ] || bad "$what: a line a pixel"
    for layer in 1 2; do
        counted=$(json "$dir/a.json" $what $layer)
        [ "$counted" -gt 10000 ] || bad "$what: too few counted: $counted"
        [ "$(sum_of "$dir/a.csv" $((layer + 2)))" = "$counted" ] || bad "$what: CSV, layer $layer"
        [ "$(json "$dir/a.json" sum $layer)" = "$counted" ] || bad "$what: JSON, layer $layer"
        grep -q "counted .*$counted $what.*: the sum of the pixels" "$dir/out" ||
            bad "$what: what is printed, layer $layer"
    done
    difference=$(sum_of "$dir/a.csv" 5)
    [ "$difference" -eq $(($(json "$dir/a.json" sum 2) - $(json "$dir/a.json" sum 1))) ] ||
        bad "$what: sum of the difference"
    [ "$difference" = "$(json "$dir/a.json" sum 3)" ] || bad "$what: JSON of the difference"
    # With the layouts the other way round it is the other sign.
    expect 0 . render $scene $size --show $what --layout rf16,f32 --out "$dir/b.png" \
        --csv "$dir/b.csv"
    [ "$(sum_of "$dir/b.csv" 5)" -eq $((-difference)) ] || bad "$what: B,A is not A,B turned round"
done

# Every picture; the same bytes twice; a layout as published.
for what in t prim normal boxes triangles depth overlap overlap-all inflation error class; do
    expect 0 . render $scene $size --show $what --layout rf16 --out "$dir/one.png"
    "$raydiff" render $scene $size --show $what --layout rf16 --out "$dir/two.png" >/dev/null 2>&1
    cmp -s "$dir/one.png" "$dir/two.png" || bad "$what: not the same picture twice"
    [ "$(head -c 4 "$dir/one.png" | tail -c 3)" = PNG ] || bad "$what: no PNG"
    expect 0 . render $scene $size --show $what --layout f32,rtrs_direct --out "$dir/one.png"
done
# Engines that read no tree.
for what in t prim class error; do
    expect 0 . render $scene $size --show $what --engine brute --out "$dir/one.png"
done
expect 0 . render $scene $size --show boxes --engine brute --out "$dir/one.png"
grep -q 'of the walk in C: engine cpu, not brute' "$dir/err" || bad "whose walk it is, is not said"
# Hits do not depend on the tree.
expect 0 . render $scene $size --show prim --layout f32,rf16 --out "$dir/one.png"
grep -q 'different in 0 of 10800 pixels' "$dir/out" || bad "prim: f32 and rf16 hit otherwise"
# A tree from a file, as JSON and packed.
expect 0 . precompute --scene $scene --builder median --out "$dir/tree.json"
expect 0 . render $scene $size --show boxes --bvh "$dir/tree.json" --layout f32 --csv "$dir/c.csv" \
    --out "$dir/one.png"
"$raydiff" render $scene $size --show boxes --layout f32 --csv "$dir/d.csv" --out "$dir/one.png" \
    >/dev/null 2>&1
cmp -s "$dir/c.csv" "$dir/d.csv" || bad "--bvh: other numbers than the builder's own tree"
expect 0 . precompute --scene $scene --builder median --layout rf16 --out "$dir/tree.rdpk"
for what in t boxes inflation; do
    expect 0 . render $scene $size --show $what --bvh "$dir/tree.rdpk" --csv "$dir/c.csv" \
        --out "$dir/one.png"
    "$raydiff" render $scene $size --show $what --layout rf16 --csv "$dir/d.csv" \
        --out "$dir/one.png" >/dev/null 2>&1
    cmp -s "$dir/c.csv" "$dir/d.csv" || bad "--bvh, packed: $what has other numbers"
done

# Fixed ends of the colours; what is refused.
expect 0 . render $scene $size --show boxes --show-range 0:64 --out "$dir/one.png"
cp "$dir/one.png" "$dir/before.png"
expect 2 "unknown 'foo'; known: t, prim, normal, boxes" render $scene --show foo
expect 2 "at most two" render $scene --show t --layout f32,rf16,rtrs_direct
expect 2 'named twice' render $scene --show t --layout f32,f32
expect 2 '--layout: .* an engine that walks trees' render $scene --show t --engine brute --layout f32,rf16
expect 2 'two are for the difference of --show' render $scene --layout f32,rf16
expect 2 'no range of colours' render $scene --show class --show-range 0:1 --out "$dir/one.png"
expect 2 'is no range' render $scene --show t --show-range 2:1 --out "$dir/one.png"
expect 2 'not LEAST:MOST' render $scene --show t --show-range 2 --out "$dir/one.png"
expect 2 '0 in its middle: -5:5' render $scene --show t --layout f32,rf16 --show-range 0:5
expect 2 '--paths: not used by --show' render $scene --show t --paths "$dir/p.csv" --out "$dir/one.png"
expect 2 'cannot write' render $scene --show t --out "$dir/no/where.png"
expect 2 'cannot write' render $scene --show t --csv "$dir/no/where.csv" --out "$dir/one.png"
expect 2 'rf16: .*larger --leaf' render soup:n=70000 --show boxes --layout f32,rf16 \
    --out "$dir/one.png"
cmp -s "$dir/one.png" "$dir/before.png" || bad "a refused picture changed a file"

echo "show: $failed failed"
[ "$failed" -eq 0 ]
