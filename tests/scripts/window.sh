#!/bin/sh
# The window on an invisible screen: it comes up, shows the picture, turns with the arrow keys,
# follows its size, and ends cleanly.
#   sh tests/scripts/window.sh BUILD
set -u
build=$1
raydiff=$build/raydiff
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
skip() {
    echo "SKIP the window: $1"
    exit 77
}
grep -q 'HAVE_SDL2 1' "$build/gen/have_sdl2.h" || skip "compiled without SDL2's headers (libsdl2-dev)"
for tool in Xvfb xdotool; do
    command -v $tool >/dev/null || skip "$tool is missing"
done
. tests/scripts/expect.sh

# A sanitizer counts what it was told to overlook, on standard error.
export LSAN_OPTIONS="${LSAN_OPTIONS:+$LSAN_OPTIONS:}print_suppressions=0"

screen='' shown=''
cleanup() {
    [ -z "$shown" ] || kill "$shown" 2>/dev/null
    [ -z "$screen" ] || kill "$screen" 2>/dev/null
    rm -rf "$dir"
}
trap cleanup EXIT
trap 'exit 1' INT TERM

# The line at the end against the log: how many pictures, their mean time, the last one's angle. A time of 0.1 ms at
# least, so that it is not taken for the angle.
summed() { # NAME
    awk 'FNR == NR { n++; ms += $NF; angle = $4; wrong += $2 != n || $NF < 0.001; next }
        /^[0-9]+ pictures?, / { told++; wrong += $1 != n || ($3 - ms / n) ^ 2 > 0.06 ^ 2 || $9 != sprintf("%.1f", angle * 180 / atan2(0, -1)) }
        END { exit wrong || told != 1 }' "$dir/$1.log" "$dir/out" || bad "$1: the line at the end is not that of the log"
}

# Without a display: one clear line; with --out the picture all the same.
unset DISPLAY WAYLAND_DISPLAY SDL_VIDEODRIVER
small="-w 96 -h 72"
expect 77 . render rtrs --window $small
grep -q 'no window: no display.*--out FILE.png draws without one' "$dir/err" || bad "says what is missing"
[ "$(wc -l <"$dir/err")" -eq 1 ] || bad "an error is one line"
expect 0 . render rtrs --window $small --out "$dir/without.png" --log "$dir/without.log"
summed without
grep -q 'is drawn without one' "$dir/err" || bad "says that there is no window"
expect 0 . render rtrs $small --out "$dir/plain.png"
cmp -s "$dir/without.png" "$dir/plain.png" || bad "without a display the picture is the same"
expect 2 "--json: not used by --window" render rtrs --window --json "$dir/x.json" $small
expect 2 "'0' is not above 0" render rtrs --window --seconds 0 $small
expect 2 'no-such-folder' render rtrs --window $small --out "$dir/no-such-folder/x.png"
expect 2 'no-such-folder' render rtrs --window $small --log "$dir/no-such-folder/x.log"

# A screen; its pixels lie in a file.
mkfifo "$dir/number"
Xvfb -displayfd 3 -screen 0 1000x800x24 -nolisten tcp -fbdir "$dir" 3>"$dir/number" 2>/dev/null &
screen=$!
read -r number <"$dir/number" || skip "Xvfb does not start"
export DISPLAY=":$number"
pixels=$dir/Xvfb_screen0

# begin NAME ARGUMENTS...: starts a window and waits until it is there; *window is its id.
begin() {
    name=$1
    shift
    "$raydiff" render "$@" --window --log "$dir/$name.log" --out "$dir/$name.png" \
        >"$dir/$name.out" 2>"$dir/$name.err" &
    shown=$!
    window=$(timeout 20 xdotool search --sync --onlyvisible --name '^raydiff: ' 2>/dev/null | head -n 1)
    [ -n "$window" ] || bad "$name: no window comes up"
    xdotool windowfocus --sync "$window" 2>/dev/null
    settle
}

# Waits until the screen has stood still for a while, and keeps what is on it.
settle() {
    still=0
    for round in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24; do
        sleep 0.2
        cmp -s "$pixels" "$dir/still" && still=$((still + 1)) || still=0
        [ "$still" -lt 4 ] || return
        cp "$pixels" "$dir/still"
    done
}

hold() { # key
    xdotool keydown "$1"
    sleep 0.3
    xdotool keyup "$1"
    settle
}

# ended NAME: the window must have closed by itself, with exit code 0.
ended() {
    for round in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        kill -0 "$shown" 2>/dev/null || break
        sleep 0.2
    done
    kill -0 "$shown" 2>/dev/null && { bad "$1: it does not end"; kill "$shown"; }
    wait "$shown"
    code=$?
    shown=
    cp "$dir/$1.out" "$dir/out"
    cp "$dir/$1.err" "$dir/err"
    summed "$1"
    [ "$code" -eq 0 ] || bad "$1: exit code $code"
    [ ! -s "$dir/$1.err" ] || bad "$1: it complains"
    echo "passed  window $1"
}

cp "$pixels" "$dir/blank"
begin keys rtrs $small --fps 5 # a machine under load may stall for 10 frames
cp "$dir/still" "$dir/first"
cmp -s "$dir/blank" "$dir/first" && bad "keys: nothing is shown"
hold Left
cp "$dir/still" "$dir/left"
cmp -s "$dir/first" "$dir/left" && bad "keys: Left changes nothing"
hold Right
cp "$dir/still" "$dir/right"
cmp -s "$dir/left" "$dir/right" && bad "keys: Right changes nothing"
place=$(xdotool getwindowgeometry --shell "$window" | sed -n 's/^[XY]=//p' | tr '\n' ' ')
xdotool key Escape
ended keys
# The camera went left, and then back by about as much.
awk '{ if ($4 > most) most = $4; last = $4 }
    END { exit !(NR >= 3 && most > 0.2 && last < most - 0.2) }' "$dir/keys.log" ||
    bad "keys: the camera was turned otherwise: $(cut -d' ' -f4 "$dir/keys.log" | tr '\n' ' ')"
# What was on the screen is the last picture, pixel for pixel.
RAYDIFF_SCREEN="$dir/right $place $dir/keys.png" "$build/tests/test_window" >"$dir/out" 2>&1 ||
    bad "keys: the screen does not show the picture"

# Nothing changes, nothing is drawn; a signal leaves complete files, as the close button would.
begin fixed rtrs $small --camera-fixed
hold Left
kill -TERM "$shown"
ended fixed
[ "$(wc -l <"$dir/fixed.log")" -eq 1 ] || bad "fixed: drawn without a change"
cmp -s "$dir/fixed.png" "$dir/plain.png" || bad "fixed: --out is not the picture"

# Without a size named the picture has the window's.
begin resized rtrs --workgroup-size 16
xdotool windowsize --sync "$window" 208 144
settle
xdotool key Escape
ended resized
grep -q '^picture 1 angle 0 size 800x600 ' "$dir/resized.log" || bad "resized: does not begin at 800x600"
tail -n 1 "$dir/resized.log" | grep -q ' size 208x144 ' || bad "resized: the picture does not follow"

# Ends by itself.
expect 0 . render rtrs --window $small --pictures 1
expect 0 . render rtrs --window $small --seconds 0.2

echo "window: $failed failed"
[ "$failed" -eq 0 ]
