#!/bin/sh
# What `raydiff diff` takes and leaves out: the pixels of a picture, the names of pictures, engines that do not run here.
#   sh tests/diffs/diffs.sh RAYDIFF
set -u
raydiff=$1
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh
small="-w 48 -h 36"

# The last pixel of each side is in the picture, and the next one is not.
for pixel in 0,0 47,0 0,35 47,35; do
    expect 0 . diff rtrs --engine cpu --pixel $pixel $small
done
for pixel in 48,0 0,36 47,36 48,35 48,36; do
    expect 2 "--pixel: $pixel is not in a picture of 48 x 36" diff rtrs --pixel $pixel $small
done

# Two pictures are known by their names, in front of options and behind them, and behind -- with any first letter.
expect 0 . render rtrs --engine cpu $small --out "$dir/-a.png"
expect 0 . render sphere:n=4 --camera-light-strength 1 --engine cpu $small --out "$dir/-b.png"
expect 0 . diff "$dir/-a.png" "$dir/-a.png"
program=$(cd "$(dirname "$raydiff")" && pwd)/$(basename "$raydiff")
for words in '-- -a.png -b.png' './-a.png -- -b.png' '--max 3 -- -a.png -b.png' './-a.png --max 3 -- -b.png' './-a.png ./-b.png --max 3'; do
    (cd "$dir" && "$program" diff $words) >"$dir/out" 2>"$dir/err"
    code=$?
    [ "$code" -eq 1 ] && grep -q '48 x 36' "$dir/out" || bad "diff $words: exit $code: $(cat "$dir/err")"
done

# An engine that is left out, wherever it stands, is told, and nothing else of what is told is another.
# Mesa keeps 128 bytes of a driver that was unloaded unused, see tests/scripts/cli.sh.
export ASAN_OPTIONS=detect_leaks=0
without() {
    sed '/^left out: /d; s/ --engine [^ ]*//; s/ --driver no-such-driver//' "$dir/out"
    sed '/"left_out": \[/,/^  *\]/d; /^ "exit": /d' "$dir/left.json"
}
for asked in '--pixel 22,17' '--pixel 24,22' "--list 2 --out $dir/left.png"; do
    rm -f "$dir/left.png"
    expect 0 . diff rtrs --engine cpu,embree $small $asked --json "$dir/left.json"
    sed -i 's/"left_out": \[\],/"left_out": [\n ]/' "$dir/left.json"
    without >"$dir/of_two"
    [ ! -e "$dir/left.png" ] || mv "$dir/left.png" "$dir/two.png"
    for engines in vulkan,cpu,embree cpu,vulkan,embree cpu,embree,vulkan; do
        expect 77 . diff rtrs --engine $engines --driver no-such-driver $small $asked --json "$dir/left.json"
        grep -q '^left out: vulkan: ' "$dir/out" || bad "diff $asked: vulkan is left out of $engines, and nothing says so"
        without | cmp -s - "$dir/of_two" || bad "diff $asked: vulkan left out of $engines: $(without | diff - "$dir/of_two" | head -n 4)"
        [ ! -e "$dir/left.png" ] || cmp -s "$dir/left.png" "$dir/two.png" || bad "diff: vulkan left out of $engines: another heat map"
    done
done

echo "diffs: $failed failed"
[ "$failed" -eq 0 ]
