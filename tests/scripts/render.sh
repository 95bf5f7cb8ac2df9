#!/bin/sh
# raydiff render as a user meets it: the chain from models to a picture, which is the one stored under
# scenes/; resolutions, handlers and profiles; one line per error and nothing half-written.
#   sh tests/scripts/render.sh RAYDIFF
set -u
raydiff=$1
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh
out="--out $dir/x.png"
small="-w 32 -h 24 $out"

# The size of a PNG file, as "W H".
size_of() { od -An -tu1 -j16 -N8 "$1" | awk '{print $3 * 256 + $4, $7 * 256 + $8}'; }
# Two pictures have the same pixels.
same() { "$raydiff" diff "$1" "$2" >"$dir/diff" 2>&1; }

# Models, scene, tree, picture: a sphere and a dodecahedron over a mirror, with their shadows.
expect 0 . construct --out "$dir/scene.json" --camera-pos 1.2 2.3 5 0.1 0.65 0 --camera-orbit \
    --light -6 9 4 1 --light 8 6 8 0.5 --material 0.8 0.25 0.15 0.8 0.6 0.15 80 \
    --material 0.5 0.55 0.6 0.5 0.1 0.4 30 --material 0.35 0.6 0.3 0.8 0.3 0.1 40 \
    --model sphere:n=24 0 --translate -1.1 1 0 \
    --model platonic:which=3 2 --rotate y 20 --translate 1.2 0.8 0.3 \
    --model grid:n=4,height=0 1 --rotate x -90 --scale 6 1 6
expect 0 . precompute --scene "$dir/scene.json" --builder median --out "$dir/scene.bvh.json"
expect 0 . render "$dir/scene.json" --bvh "$dir/scene.bvh.json" -w 240 -h 180 --ambience 0.08 \
    --out "$dir/reference.png" --json "$dir/reference.json"
same scenes/reference.png "$dir/reference.png" || bad "the picture is scenes/reference.png"
for word in '"closest": 84062' '"shadow": 75240' '"layout": "f32"' '"lights": 2'; do
    grep -q "$word" "$dir/reference.json" || bad "--json has $word"
done
for other in '--handler bvh-rf' '--leaf 1 --box watertight --threads 1'; do
    expect 0 . render --path "$dir/scene.json" $other -w 240 -h 180 --ambience 0.08 $out
    same scenes/reference.png "$dir/x.png" || bad "render $other shows the same"
done
expect 0 . precompute --scene "$dir/scene.json" --out "$dir/loose.bvh.json"
expect 0 . render "$dir/scene.json" --handler-bvh "$dir/loose.bvh.json" $small
grep -q 'warning: .*too small' "$dir/err" || bad "render warns of boxes that are too small"
expect 2 'belong|another scene|triangles' render rtrs --handler-bvh-rf "$dir/scene.bvh.json" $small

# RTRS's three forms of a resolution.
expect 0 . render $small
[ "$(size_of "$dir/x.png")" = '32 24' ] || bad "-w 32 -h 24 gives $(size_of "$dir/x.png")"
expect 0 . render --workgroup-size 8 --bounces 1 $out --json "$dir/x.json"
[ "$(size_of "$dir/x.png")" = '800 600' ] || bad "--workgroup-size alone is a window's size"
grep -q '"workgroup_size": 8' "$dir/x.json" || bad "--workgroup-size 8 is kept"
for size in '33 21 3' '48 64 16' '31 17 1' '1 1 1'; do
    set -- $size
    expect 0 . render -w "$1" -h "$2" $out --json "$dir/x.json"
    [ "$(size_of "$dir/x.png")" = "$1 $2" ] || bad "-w $1 -h $2 gives $(size_of "$dir/x.png")"
    grep -q "\"workgroup_size\": $3," "$dir/x.json" || bad "$1 x $2: the workgroup is $3"
done
expect 0 . render -w 30 -h 20 --workgroup-size 32 $out
grep -q 'over 256: taken as 16' "$dir/err" || bad "a workgroup of 32 is taken as 16, and said so"
expect 2 '--height is missing' render -w 64 $out
expect 2 '--width is missing' render -h 64 $out
expect 2 "--width: '0' is not a whole number from 1 to 16384" render -w 0 -h 5 $out
expect 2 "--height: '16385' is not" render -w 5 -h 16385 $out
expect 2 "--width: '99999999999' is not" render -w 99999999999 -h 5 $out
expect 2 "--width: '1.5' is not" render -w 1.5 -h 5 $out
expect 2 "--workgroup-size: '0' is not" render --workgroup-size 0 $out
expect 0 . render -w 5 -h # the last word: help
expect 2 "--bounces: '65' is not a whole number from 0 to 64" render --bounces 65 $small

# Handlers are members of our tables, in either profile.
handler() { # options, what --json says
    expect 0 . render $1 $small --json "$dir/x.json"
    shift
    for word in "$@"; do
        grep -q "$word" "$dir/x.json" || bad "render --json has no $word"
    done
}
expect 0 . render "$dir/scene.json" --handler bvh -w 48 -h 36 --out "$dir/tree.png"
expect 0 . render "$dir/scene.json" --handler naive -w 48 -h 36 --out "$dir/naive.png"
same "$dir/tree.png" "$dir/naive.png" || bad "a tree shows what every triangle does"
handler '--handler-naive' '"engine": "brute"' '"tree": null' '"tri": "mt"'
handler '--handler bvh' '"layout": "f32"' '"builder": "median"' '"box": "robust"'
handler '--handler bvh-rf' '"layout": "rf16"'
handler '--profile rtrs --handler bvh' '"layout": "rtrs_direct"' '"node_bytes": 2448' '"leaf": 2' '"tri": "mt_rtrs"'
handler '--profile rtrs --handler-bvh-rf' '"layout": "rtrs_rf"' '"node_bytes": 656' '"box": "rtrs"'
handler '--profile rtrs --handler-bvh-rf 0.001 --leaf 6' '"leaf": 6'
handler '--profile rtrs --handler-naive' '"engine": "brute"' '"tri": "mt_rtrs"'
handler '--layout auto --tri woop' '"layout": "rf16"' '"tri": "woop"'
handler '--handler-blank' '"hit_pixels": 0'
handler '--engine embree_robust' '"engine": "embree_robust"' '"tree": null' '"hit_pixels": [1-9]'
expect 2 "'kd' is not naive, bvh, bvh-rf or blank" render --handler kd $small
expect 2 "naive tests every triangle and needs engine cpu or vulkan, not embree" render --handler naive --engine embree $small
expect 2 "'new' is not repaired or rtrs" render --profile new $small
expect 2 'rf16: .*; --layout auto takes one that fits' render soup:n=70000 --handler bvh-rf $small
# A blank scene holds no triangles: a tree of the scene is none of it, and the picture is that without one.
for bvh in '' "--bvh $dir/scene.bvh.json"; do
    expect 0 . render "$dir/scene.json" --handler blank $bvh $small --paths "$dir/blank$(echo "$bvh" | wc -w).csv"
done
cmp -s "$dir/blank0.csv" "$dir/blank2.csv" || bad "a tree beside --handler blank: other paths"
# How an engine draws is asked of one that does: not of one that traces rays alone, nor where all are to.
for how in '--plan steps' '--plan whole' --general; do
    for engine in cpu embree brute 'vulkan --waves' 'vulkan_brute --waves'; do
        expect 2 "^raydiff render: ${how%% *}: not used by engines that do not draw on their own" render sphere --engine $engine $how $small
        case $engine in vulkan*) ;; *) continue ;; esac
        expect 77 . render sphere --engine ${engine% --waves} --driver no-such-driver $how $small
    done
done
expect 2 'goes without --builder' render "$dir/scene.json" --bvh "$dir/scene.bvh.json" --builder median $small

# Light: at the eye where a repaired scene has none; published pictures stay black, and say so.
expect 0 . render sphere $small
grep -q 'one of strength 1 stands at the eye' "$dir/err" || bad "a light at the eye is announced"
for dark in '--profile rtrs' '--camera-light-strength 0'; do
    expect 0 . render sphere $dark $small
    grep -q 'warning: no light .* black' "$dir/err" || bad "render sphere $dark warns"
done
expect 2 '--ambience: not used by the published shader' render rtrs --profile rtrs --ambience 0.5 $small
expect 2 "--ambience: '-1' is below 0" render --ambience -1 $small
expect 2 "--fps: '0' is not above 0" render --fps 0 $small

# Scenes that cannot be shown.
sed 's/"material": 2/"material": 9/' "$dir/scene.json" >"$dir/nine.json"
expect 2 'nine.json: .*material' render "$dir/nine.json" $small
# A scene without a camera is framed as long as the eye's coordinates are floats.
far() { # vertices
    printf 'v %s\nv %s\nv %s\nf 1 2 3\n' "$@" >"$dir/far.obj"
}
for vertices in '1.4e38 0 0,3.4e38 0 0,2e38 1 0' '0 1.4e38 0,0 3.4e38 0,1 2e38 0'; do
    IFS=,
    far $vertices
    unset IFS
    expect 0 . render "$dir/far.obj" $small
done
far '0 -1.4e38 1.4e38' '0 1.4e38 3.4e38' '0 0 2e38'
expect 2 "^raydiff render: $dir/far.obj: the camera's coordinate z is not finite\$" render "$dir/far.obj" $small
far '-1.2e38 0 0' '1.2e38 0 0' '0 1 0'
expect 0 . render "$dir/far.obj" $small
expect 2 'no file, and no generator' render nothing_like_it $small
expect 2 "$dir" render "$dir" $small
expect 2 "one scene" render rtrs --path rtrs $small
expect 2 "unexpected argument 'more'" render rtrs more $small

# The model fills 80 % of the picture, a little less where thin ends fall between pixels; a turn shows all of it.
share() { # file of paths, frame
    awk -F, -v frame="$2" 'NR > 1 && $1 == frame && $4 == 0 {
            if ($2 + 1 > width) width = $2 + 1
            if ($3 + 1 > height) height = $3 + 1
            if ($6 == "") next
            if (!hits++) { left = right = $2; top = bottom = $3 }
            if ($2 < left) left = $2
            if ($2 > right) right = $2
            if ($3 < top) top = $3
            if ($3 > bottom) bottom = $3
        }
        END {
            x = (right - left + 1) / width
            y = (bottom - top + 1) / height
            printf "%d\n", 100 * (x > y ? x : y)
        }' "$1"
}
expect 0 . scene convert sphere:n=6 "$dir/ball.obj"
for scene in soup sphere:n=12 flake:n=2 terrain:k=4 grid:n=8 platonic stack needles "$dir/ball.obj"; do
    expect 0 . render "$scene" --bounces 1 -w 200 -h 150 $out --paths "$dir/p.csv"
    part=$(share "$dir/p.csv" 1)
    [ "$part" -ge 70 ] && [ "$part" -le 90 ] || bad "render $scene: the model has $part % of the picture"
done
expect 0 . render platonic --frames 5 --bounces 1 -w 200 -h 150 --out "$dir/p.png" --paths "$dir/p.csv"
for frame in 1 2 3 4 5; do
    part=$(share "$dir/p.csv" "$frame")
    [ "$part" -ge 20 ] && [ "$part" -le 80 ] || bad "picture $frame of a turn: the model has $part %"
done

# Sequences: an orbiting camera comes back after N pictures.
expect 0 . render --frames 3 --angle 180 -w 40 -h 30 --out "$dir/turn.png" --paths "$dir/turn.csv"
same "$dir/turn-0001.png" "$dir/turn-0003.png" || bad "two half turns are one"
same "$dir/turn-0001.png" "$dir/turn-0002.png" && bad "half a turn changes the picture"
[ -e "$dir/turn-0004.png" ] && bad "three pictures are three"
for frame in 1 2 3; do
    grep -q "^$frame,39,29,0," "$dir/turn.csv" || bad "--paths has picture $frame"
done
grep -q '^2,[0-9]*,[0-9]*,0,0x1\.[0-9a-f]*p+[0-9],[0-9]*,' "$dir/turn.csv" || bad "--paths has t to the bit"
expect 0 . render --frames 2 -w 8 -h 8 --out "$dir/n%02d.png" --paths "$dir/n.json"
[ -s "$dir/n01.png" ] && [ -s "$dir/n02.png" ] || bad "%02d is the number"
for digits in 1 2 3 4 5 6 7 8 9; do
    expect 0 . render -w 8 -h 8 --out "$dir/d$digits-%0${digits}d.png"
    [ -s "$dir/d$digits-$(printf "%0${digits}d" 1).png" ] || bad "a number of $digits digits"
done
for place in %0d %00d %010d %1d %-2d %x %%d %d%d % %d-%; do
    expect 2 "after % stands d or 04d, the picture's number, once" render -w 8 -h 8 --out "$dir/p$place.png"
done
python3 -c 'import json, sys; assert len(json.load(open(sys.argv[1]))["segments"][0]) == 8' "$dir/n.json" ||
    bad "--paths FILE.json is JSON of eight columns"
expect 2 "the scene's camera is fixed; --camera-orbit turns it" render --frames 2 --camera-fixed $small
expect 2 'after % stands d or 04d' render --frames 2 --out "$dir/%s.png"
expect 2 'does not end with .png' render --out "$dir/x.jpg"
expect 2 'ends neither with .csv nor with .json' render --paths "$dir/x.txt" $small

# Outputs are tried before the work.
expect 2 'no_such_folder' render soup:n=200000 --handler naive -w 2000 -h 2000 --out "$dir/no_such_folder/x.png"
expect 2 'no_such_folder' render soup:n=200000 --handler naive -w 2000 -h 2000 $out --json "$dir/no_such_folder/x.json"
expect 2 "$dir" render --out "$dir/folder.png" --json "$dir" -w 8 -h 8
expect 0 . render -w 8 -h 8 $out --json -
head -c 1 "$dir/out" | grep -q '{' || bad "render --json - prints JSON alone"

# Ctrl-C: the pictures that are there are whole.
"$raydiff" render --frames 100000 -w 64 -h 48 --out "$dir/c%05d.png" --json "$dir/c.json" \
    >"$dir/out" 2>"$dir/err" &
pid=$!
tries=0
while [ ! -s "$dir/c00005.png" ] && [ "$tries" -lt 100 ]; do
    sleep 0.1
    tries=$((tries + 1))
done
kill -INT "$pid"
wait "$pid"
[ $? -eq 130 ] || bad "Ctrl-C ends render with 130"
same "$dir/c00005.png" "$dir/c00005.png" || bad "a picture before Ctrl-C can be read"
[ "$(grep -c '"file"' "$dir/c.json")" -eq "$(ls "$dir"/c0*.png | wc -l)" ] || bad "--json after Ctrl-C lists all"
[ -z "$(ls -A "$dir" | grep -E '\.tmp|\.part')" ] || bad "nothing half-written is left"

echo "render: $failed failed"
[ "$failed" -eq 0 ]
