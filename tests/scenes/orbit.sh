#!/bin/sh
# An orbit of `raydiff render` around a target that is not the origin, from above it: every camera is as far from it
# and as high, looks at it, and is turned by its angle to the side that the angle's sign has; after a whole turn
# it is where it was, to the last digit and pixel. sh tests/scenes/orbit.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh

expect 0 . construct --out "$dir/scene.json" --camera-pos 1.2 2.3 5 0.1 0.65 -0.75 --camera-orbit \
    --light -6 9 4 1 --material 0.8 0.25 0.15 0.8 0.6 0.15 80 --model sphere:n=6 0 --translate -1.1 1 0 \
    --model platonic:which=3 0 --rotate y 20 --translate 1.2 0.8 0.3

# Pictures, degrees from one to the next, the picture that is the first again (0: none), options.
orbit() {
    frames=$1 step=$2 again=$3
    shift 3
    rm -f "$dir"/o-*.png
    expect 0 . render "$dir/scene.json" -w 24 -h 18 --frames "$frames" --out "$dir/o.png" --json "$dir/json" "$@"
    awk -f tests/values/flat.awk "$dir/json" | awk -F= -v frames="$frames" -v step="$step" -v again="$again" '
        function far(what, number, is, most) {
            checked++
            if ((number - is) ^ 2 > most ^ 2) {
                print what ": " number ", not " is
                bad = 1
            }
        }
        function whole(angle) { return angle - 2 * pi * int(angle / (2 * pi) + (angle < 0 ? -0.5 : 0.5)) }
        { v[$1] = $2 }
        END {
            pi = atan2(0, -1)
            split("0.1 0.65 -0.75", at, " ")
            for (i = 0; i < frames; i++) {
                p = "frames." i
                x = v[p ".pos.0"] - at[1]; y = v[p ".pos.1"] - at[2]; z = v[p ".pos.2"] - at[3]
                if (i == 0) { first = atan2(z, x); radius = sqrt(x * x + z * z) }
                turn = i * step * pi / 180
                far(p " angle", v[p ".angle"], turn, 1e-7)
                far(p " radius", sqrt(x * x + z * z), radius, 2e-6)
                far(p " height", v[p ".pos.1"], 2.3, 1e-7)
                far(p " direction", whole(atan2(z, x) - first - turn), 0, 1e-6)
                length_ = sqrt(x * x + y * y + z * z)
                far(p " forward x", v[p ".forward.0"], -x / length_, 1e-6)
                far(p " forward y", v[p ".forward.1"], -y / length_, 1e-6)
                far(p " forward z", v[p ".forward.2"], -z / length_, 1e-6)
            }
            far("start x", v["frames.0.pos.0"], 1.2, 1e-7)
            far("start z", v["frames.0.pos.2"], 5, 1e-7)
            for (k = 0; k < 3 && again > 0; k++)
                far("back at " k, v["frames." again - 1 ".pos." k], v["frames.0.pos." k], 0)
            exit bad || checked < 7 * frames || v["frames.count"] != frames
        }' >"$dir/out" 2>"$dir/err" || bad "orbit of $frames by $step"
    [ "$again" -eq 0 ] || cmp "$dir/o-0001.png" "$dir/o-$(printf %04d "$again").png" >"$dir/out" 2>"$dir/err" ||
        bad "a whole turn of $frames by $step is another picture"
    [ "$(ls "$dir"/o-*.png | wc -l)" -eq "$frames" ] || bad "$frames pictures"
}
orbit 5 72 0
orbit 7 51.4285714285714286 0
orbit 13 30 13 --angle 30
orbit 9 -45 9 --angle -45 --engine embree
orbit 4 360 3 --angle 360 --profile rtrs
orbit 3 0 2 --angle 0
orbit 8 157.5 0 --angle 157.5
cmp "$dir/o-0001.png" "$dir/o-0002.png" >/dev/null && bad "a turn is seen"
echo "orbit: $failed failed"
[ "$failed" -eq 0 ]
