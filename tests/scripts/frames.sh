#!/bin/sh
# Measured frames as a user meets them: bench frames, bench paper, bench special, render --benchmark.
#   sh tests/scripts/frames.sh BUILD
set -u
raydiff=$1/raydiff
[ -x "$raydiff" ] || { echo "$raydiff: not built"; exit 4; }
. tests/scripts/expect.sh

few="--engine cpu --layout f32,rf16 --size 24x16"

# Files are complete, and say what the table says.
expect 0 . bench frames $few --frames 12 --out "$dir/run"
[ "$(wc -l <"$dir/run.csv")" -eq 25 ] || bad "12 frames of 2 handlers are 24 rows and a head"
grep -q '^cpu rf16,656,"host clock, rays alone",11,1650,' "$dir/run.csv" || bad "the last row"
for word in '"frames": 12' '"warm_up_dropped": 3' '"stopped": false' '"bytes": 656' '"median_ms"'; do
    grep -q "$word" "$dir/run.json" || bad "the JSON has no $word"
done
grep -q 'cpu rf16' "$dir/run.svg" || bad "the chart names no handler"
[ "$(head -c 4 "$dir/run.png" | tail -c 3)" = PNG ] || bad "no PNG"
grep -q '12 frames over 5 turns.* 3 frames to warm up, dropped' "$dir/out" || bad "what was dropped"

expect 0 . render --benchmark --benchmark-frames 4 --benchmark-turns 1 --benchmark-warm-up 0 \
    --benchmark-out "$dir/one" --handler-bvh-rf -w 24 -h 16
grep -q '^RF-BVH (cpu rf16),656,.*,3,270,' "$dir/one.csv" || bad "RTRS's name of the handler"
expect 0 . render --benchmark --benchmark-frames 2 --benchmark-out "$dir/one" --handler blank --camera-fixed -w 16 -h 16
grep -q '^Blank (cpu f32),0,.*,1,0,' "$dir/one.csv" || bad "a fixed camera stands"

# Bad input.
expect 2 "unknown scene 'no:such'" bench frames --scene no:such
expect 2 "one scene" bench frames --scene 'rtrs;soup'
expect 2 "'0' is not a whole number from 1" bench frames --size 0x4
expect 2 "not WIDTHxHEIGHT" bench frames --size 12
expect 2 "'0' is not a whole number from 1" bench frames --frames 0
expect 2 "is not repaired or rtrs" bench frames --profile pretty
expect 2 "not used by benchmark layouts" bench layouts --frames 3
expect 2 "not used by benchmark all" bench --frames 3
expect 2 "not used by benchmark frames" bench frames --quick
expect 2 "cannot write" bench frames $few --frames 2 --out /nonexistent/run
expect 2 "cannot write" bench frames --engine cpu --frames 100000 --out /nonexistent/run # before the work
grep -q written "$dir/out" && bad "what was not written is said to be"
expect 2 "cannot write" render --benchmark --benchmark-out /nonexistent/run -w 16 -h 16
expect 2 "No such file" bench frames $few --bvh "$dir/none.json" --scene rtrs
expect 2 "the paper's are rtrs and" bench paper --scene cornell
expect 2 "--scene: not used by benchmark special" bench special --scene rtrs

# Ctrl-C: the files hold the frames drawn until then.
"$raydiff" bench frames --scene sphere:n=30 --engine cpu --size 256x192 --frames 100000 --out "$dir/cut" \
    >"$dir/out" 2>"$dir/err" &
child=$!
sleep 2
kill -INT "$child"
wait "$child"
code=$?
[ "$code" -eq 130 ] || bad "an interrupted run ends with $code, not 130"
frames=$(sed -n 's/^ "frames": \([0-9]*\),$/\1/p' "$dir/cut.json")
[ "${frames:-0}" -gt 0 ] || bad "an interrupted run kept no frame"
[ "$(wc -l <"$dir/cut.csv")" -eq $((1 + 2 * ${frames:-0})) ] || bad "CSV and JSON of an interrupted run differ"
grep -q '"stopped": true' "$dir/cut.json" || bad "an interrupted run says so"
grep -q '</svg>' "$dir/cut.svg" || bad "the chart of an interrupted run is cut"

echo "frames: $failed failed"
[ "$failed" -eq 0 ]
