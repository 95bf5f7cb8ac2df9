#!/bin/sh
# The numbers of `raydiff render`, `render --show` and `raydiff diff` by value: against the pixels of the PNG files, the
# segments of every path and the value of every pixel. sh tests/values/values_pictures.sh RAYDIFF [render paths show images engines faults borders]
set -u
raydiff=$1
shift
. tests/values/compare.sh
small='-w 24 -h 18'

# PNG, file of its pixels, or --size of its size
pixels() { sh tests/values/pictures/png.sh ${3-} "$1" >"$2" || bad "$1: no picture"; }

play_render() {
    # A path of one segment without a light: its work is what --show counts.
    one='--bounces 1 --camera-light-strength 0'
    run render sphere:n=6 $small --show boxes --json "$dir/other.json" --out "$dir/boxes.png" &&
        awk -f tests/values/flat.awk "$dir/other.json" >"$dir/other.flat"
    run render sphere:n=6 $small $one --out "$dir/a.png" --json "$dir/json" --paths "$dir/a.csv" && pixels "$dir/a.png" "$dir/a.pixels" &&
        values render 400 "$dir/other.flat" "$dir/a.pixels" "$dir/a.csv" "$dir/text"
    for options in '--handler bvh-rf' '--profile rtrs --handler bvh' '--handler naive' '--engine embree'; do
        run render rtrs -w 31 -h 17 $options --out "$dir/a.png" --json "$dir/json" --paths "$dir/a.csv" &&
            pixels "$dir/a.png" "$dir/a.pixels" && values render 500 "$dir/a.pixels" "$dir/a.csv" "$dir/text"
    done
    run render rtrs $small --frames 5 --out "$dir/f.png" --json "$dir/json" --paths "$dir/a.csv" &&
        pixels "$dir/f-0005.png" "$dir/a.pixels" && values render 500 orbit=1 "$dir/a.pixels" "$dir/a.csv" "$dir/text"
    # Large enough for its milliseconds to be told.
    run render rtrs -w 160 -h 120 --frames 3 --out "$dir/f.png" --json "$dir/json" &&
        pixels "$dir/f-0001.png" "$dir/a.pixels" --size && values render 18 orbit=1 "$dir/a.pixels" "$dir/text"
}
# The paths as JSON are those of the CSV file.
play_paths() {
    for form in csv json; do
        run render rtrs $small --frames 2 --out "$dir/f.png" --paths "$dir/p.$form"
    done
    sed 1d "$dir/p.csv" >"$dir/csv"
    awk -f tests/values/flat.awk "$dir/p.json" | awk -F= '/^segments\.[0-9]+\.[0-9]+=/ {
        split($1, at, ".")
        line = (at[3] == 0 ? "" : line ",") ($2 == "null" ? "" : $2)
        if (at[3] == 7) print line
    }' >"$dir/of_json"
    [ -s "$dir/csv" ] && cmp "$dir/csv" "$dir/of_json" || bad "paths as JSON are others than as CSV"
}
# what, layouts, more
show() {
    what=$1 layouts=$2
    shift 2
    run render "$@" $small --show "$what" --layout "$layouts" --csv "$dir/s.csv" --out "$dir/a.png" --json "$dir/json" &&
        pixels "$dir/a.png" "$dir/a.pixels" --size && values show 400 "$dir/a.pixels" $(ls "$dir/a.csv" 2>/dev/null) "$dir/s.csv" "$dir/text"
}
told() { sed -n "s/^$1=//p" "$dir/flat"; }
# half4 and f32 walk other trees; rtrs_rf with a box test that culls loses hits, which the judge calls WRONG.
play_show() {
    run render cornell:n=3 $small --bounces 1 --layout f32 --out "$dir/a.png" --paths "$dir/a.csv"
    for what in t prim normal boxes triangles depth overlap inflation error class; do
        show $what f32,half4 cornell:n=3
    done
    rm "$dir/a.csv"
    show boxes f32 sphere:n=6
    # What one layout loses is WRONG, and has no t, or another.
    show class f32,rtrs_rf rtrs --box robust
    lost=$(told layers.1.verdicts.wrong)
    [ "${lost:-0}" -gt 0 ] && [ "$(told layers.0.verdicts.wrong)" = 0 ] || bad "$ran: $lost are WRONG"
    show t f32,rtrs_rf rtrs --box robust
    other=$(($(told difference.only_one) + $(told difference.more) + $(told difference.less)))
    [ "$other" = "$lost" ] || bad "$ran: $other are lost, $lost WRONG"
}
play_images() {
    run render rtrs $small --out "$dir/a.png"
    run render rtrs $small --ambience 0.5 --engine embree --out "$dir/b.png"
    run render rtrs $small --profile rtrs --out "$dir/c.png"
    run render cornell:n=3 $small --angle 3 --frames 2 --camera-orbit --out "$dir/d%d.png"
    for pair in 'a a' 'a b' 'b a' 'c b' 'd1 d2' 'a d1'; do
        set -- $pair
        pixels "$dir/$1.png" "$dir/x.a.pixels"
        pixels "$dir/$2.png" "$dir/x.b.pixels"
        run diff "$dir/$1.png" "$dir/$2.png" --json "$dir/json" &&
            values diff_images 16 "$dir/x.a.pixels" "$dir/x.b.pixels" "$dir/text"
        # The exit code is that of the largest difference of any channel.
        most=$(sed -n 's/^largest\.[a-z]*=//p' "$dir/flat" | sort -n | tail -n 1)
        [ "$code" -eq $((most > 0)) ] || bad "$ran: exit $code, differs by $most"
        for max in $most $((most - 1)); do
            [ "$max" -ge 0 ] || continue
            run diff "$dir/$1.png" "$dir/$2.png" --max "$max"
            [ "$code" -eq $((most > max)) ] || bad "$ran: exit $code, differs by $most"
        done
    done
    # Two pictures are compared if one is named, by whatever ending the other has; not if an option writes one.
    run diff "$dir/a.png" "$dir/b.png"
    cp "$dir/text" "$dir/both" && cp "$dir/b.png" "$dir/b.picture"
    for way in "$dir/a.png $dir/b.picture" "-- $dir/a.png $dir/b.picture"; do
        run diff $way && sed 's/b\.picture/b.png/' "$dir/text" | cmp -s - "$dir/both" || bad "$ran: not as with b.png"
    done
    "$raydiff" diff "$dir/a.png" >"$dir/text" 2>"$dir/err"
    [ $? -eq 2 ] && grep -q 'two PNG files are compared, not 1' "$dir/err" || bad 'diff A.png: one picture is no scene'
    for way in "--out $dir/out.png" "--out=$dir/out.png"; do
        rm -f "$dir/out.png"
        run diff rtrs $small --engine cpu,brute $way && [ -s "$dir/out.png" ] && grep -q '^brute against cpu: ' "$dir/text" ||
            bad "$ran: engines are not compared"
    done
    # Where the heat map has each pixel.
    for ambience in 0 0.5; do
        run render sphere:n=6 -w 7 -h 5 --ambience $ambience --out "$dir/h$ambience.png"
    done
    pixels "$dir/h0.png" "$dir/x.a.pixels"
    pixels "$dir/h0.5.png" "$dir/x.b.pixels"
    echo none=0 >"$dir/none"
    run diff "$dir/h0.png" "$dir/h0.5.png" --out "$dir/heat.png" && pixels "$dir/heat.png" "$dir/heat.map" &&
        awk -v least=7000 -f tests/values/lib.awk -f tests/values/pictures/pixels.awk -f tests/values/pictures/heat.awk "$dir/none" \
            "$dir/x.a.pixels" "$dir/x.b.pixels" "$dir/heat.map" "$dir/text" || bad "$ran: heat map"
}
play_engines() {
    # So many lights and bounces that the pixels which differ are explained in several parts.
    for light in $(seq 32); do echo "--light $((light % 7 - 3)) $((light % 5 + 2)) $((light % 9 - 4)) 0.1"; done >"$dir/lights"
    run construct --out "$dir/lit.json" --camera-fixed --camera-pos 0 0.5 1.6 0 0 0 $(cat "$dir/lights") \
        --material 0.3 0.5 0.7 0.3 0.7 0.5 10 --model sphere:n=16 0
    compare_engines "$dir/lit.json --bounces 64" 32 24 '--layout rtrs_rf'
    compare_engines cornell:n=4 48 36
    compare_engines 'rtrs --profile rtrs' 48 36
}
compare_engines() { # scene, width, height, options of engines that walk trees
    scene="$1 -w $2 -h $3" trees=${4-}
    run render $scene $trees --engine cpu --out "$dir/a.png" --paths "$dir/a.csv"
    run render $scene --engine embree --out "$dir/b.png" --paths "$dir/b.csv"
    for side in a b; do pixels "$dir/$side.png" "$dir/$side.pixels"; done
    scene="$scene $trees --engine cpu,embree,brute"
    run diff $scene --json "$dir/json" &&
        values diff_engines 400 engine=embree "$dir/a.csv" "$dir/b.csv" "$dir/a.pixels" "$dir/b.pixels" "$dir/text"
    # Three of the pixels that differ, and one that does not.
    for pixel in $(sed -n 's/^  pixel \([0-9,]*\) .*/\1/p' "$dir/text" | head -n 3) 24,20; do
        run diff $scene --pixel "$pixel" --json "$dir/json" &&
            values diff_pixel 60 "$dir/a.pixels" "$dir/b.pixels" "$dir/text"
    done
}

# Faults: of a tracer with a bug, where it was built.
play_faults() {
    # Nothing to hit, and nothing asked: no evidence.
    for nothing in 'soup:n=0' 'rtrs --bounces 0'; do
        run diff $nothing $small --engine cpu,brute --json "$dir/json" && values diff_engines 20 engine=none "$dir/text"
        grep -q '"vacuous": true' "$dir/json" || bad "diff $nothing: not vacuous in JSON"
    done
    for bug in "$(dirname "$raydiff")/samples/tracer_bug1" build/samples/tracer_bug1; do
        [ -x "$bug" ] || continue
        run diff sphere:n=6 --camera-light-strength 1 $small --engine "cpu,pipe:$bug" --json "$dir/json" &&
            values diff_engines 40 engine=none "$dir/text"
        return
    done
}

# Under four lights some values are so near a rounding border that another pow rounds them otherwise. Without such a
# driver, or with a pow that is the same, there is nothing to see.
play_borders() {
    run construct --out "$dir/plane.json" --camera-fixed --camera-pos 0 0 3 0 0 0 --light -6 9 4 1 --light 3 1 8 0.7 \
        --light -3 1 8 0.7 --light 0 -3 8 0.7 --material 0.3 0.5 0.7 0.3 0.7 0 10 --model grid:n=4,height=0 0
    plane="$dir/plane.json -w 400 -h 300 --engine cpu,vulkan"
    "$raydiff" diff $plane --list 7 --json "$dir/json" >"$dir/borders" 2>"$dir/err"
    [ $? -ne 77 ] || { echo "SKIP values beside a border: $(tail -n 1 "$dir/err")"; return; }
    first=$(sed -n 's/^  pixel \([0-9,]*\) border: .*/\1/p' "$dir/borders" | head -n 1)
    [ -n "$first" ] || { echo "SKIP values beside a border: there is none"; return; }
    run diff $plane --pixel "$first" --json "$dir/other.json" && awk -f tests/values/flat.awk "$dir/other.json" >"$dir/other.flat" &&
        awk -f tests/values/flat.awk "$dir/json" >"$dir/flat" && sh tests/values/fields.sh diff_engines "$dir/flat" "$dir/seen" &&
        cat "$dir/text" >>"$dir/borders" &&
        awk -v least=40 -v list=7 -f tests/values/lib.awk -f tests/values/pictures/diff_borders.awk "$dir/flat" "$dir/other.flat" "$dir/borders" ||
        bad "values beside a border"
}

# What is wrong is excused of members as published alone: a layout, a box test, or the builder, if there is one. A tree from
# a file has none, whatever the profile's would be. Answers, pictures and what is shown of them are excused alike.
play_published() {
    "$raydiff" precompute --scene rtrs --builder median --out "$dir/whole" 2>"$dir/err" || bad 'published: no tree'
    # Of every third leaf less than a third is left in x.
    perl -pe 's/("item_count":[1-9]\d*,"bounds":\{"min":\[)([^,]+)(,[^\]]+\],"max":\[)([^,]+)/$n++ % 3 ? $& : $1 . $2 . $3 . ($2 + 0.3 * ($4 - $2))/ge' \
        "$dir/whole" >"$dir/cut"
    for of in "--bvh $dir/cut" "--bvh $dir/whole" '--builder rtrs --leaf 2' '--builder median'; do
        for members in 'f32 robust' 'f32 rtrs' 'rtrs_rf_paper robust' 'f32 watertight'; do
            with="$of --engine cpu --layout ${members% *} --box ${members#* }"
            want=0
            case $of,$members in *cut,'f32 robust' | *cut,*watertight) want=1 ;; esac
            for command in 'diff rtrs --profile repaired' 'diff rtrs --profile rtrs' 'render rtrs --profile repaired' 'render rtrs --profile rtrs' \
                'check rtrs --rays primary --count 6000 --repeat 1 --brute 0 --tri mt'; do
                case $command in
                diff*) run $command $(echo "$with" | sed 's/ cpu / cpu,brute /') -w 96 -h 72 --json "$dir/json" ;;
                render*) run $command $with -w 96 -h 72 --show class --out "$dir/class.png" ;;
                *) run $command $with ;;
                esac
                [ "$code" -eq "$want" ] || bad "$ran: exit $code, not $want"
            done
        done
    done
}

# Of two layouts side by side each has the verdicts that it has alone, and the exit code is the worse of theirs. Where four
# hundredths are cut off the leaves' boxes in x, coarse layouts still hold them.
play_beside() {
    "$raydiff" precompute --scene rtrs --builder median --out "$dir/whole" 2>"$dir/err" || bad 'beside: no tree'
    perl -pe 's/("item_count":[1-9]\d*,"bounds":\{"min":\[)([^,]+)(,[^\]]+\],"max":\[)([^,]+)/$1 . $2 . $3 . ($2 + 0.96 * ($4 - $2))/ge' \
        "$dir/whole" >"$dir/cut"
    for tree in whole cut; do
        for layout in f32 tiny8 cwbvh80; do verdicts $tree $layout && cp "$dir/verdicts" "$dir/$layout.0" && echo "$code" >"$dir/$layout.code"; done
        for pair in f32,tiny8 tiny8,f32 cwbvh80,tiny8 f32,cwbvh80; do
            verdicts $tree $pair
            for layer in 0 1; do
                case $layer in 0) layout=${pair%,*} ;; *) layout=${pair#*,} ;; esac
                sed -n "s/^layers\.$layer\.//p" "$dir/verdicts" >"$dir/of"
                sed -n "s/^layers\.0\.//p" "$dir/$layout.0" | cmp -s - "$dir/of" || bad "$ran: $layout has other verdicts than alone"
            done
            [ "$code" -eq "$(sort -n "$dir/${pair%,*}.code" "$dir/${pair#*,}.code" | tail -n 1)" ] || bad "$ran: exit $code is not the worse"
        done
        sum=$(cat "$dir"/*.code | sort -u | tr -d '\n')
        [ "$sum" = "$([ $tree = cut ] && echo 01 || echo 0)" ] || bad "beside, $tree: exit codes $sum of each alone"
    done
}
verdicts() { # tree, layouts
    run render rtrs --show class --engine cpu --box robust --bvh "$dir/$1" --layout "$2" -w 192 -h 144 --out "$dir/a.png" --json "$dir/json" &&
        awk -f tests/values/flat.awk "$dir/json" | grep '^layers\.[01]\.verdicts' >"$dir/verdicts"
}

for part in ${*:-render paths show images engines faults borders published beside}; do
    "play_$part"
    case $part in
    render | show) all_seen $part ;;
    images) all_seen diff_images ;;
    engines) all_seen diff_engines diff_pixel ;;
    esac
done
echo "values_pictures: $failed failed"
[ "$failed" -eq 0 ]
