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

# The paper's tables, small.
expect 0 . bench paper --scene rtrs --size 32x24 --frames 2 --out "$dir/paper"
grep -q '^figure8,rtrs,the paper.s,40,24,680,680,1424,2,51,2448,2448,4,14,656,656$' "$dir/paper.csv" ||
    bad "Figure 8 of the default scene"
[ "$(grep -c '^same_tree,rtrs,' "$dir/paper.csv")" -eq 4 ] || bad "four leaf sizes"
grep -q '^paper_frames,rtrs,"RF, leaf 4",published,vulkan,rtrs_rf,rtrs,mt_rtrs,steps,4,27,656,' "$dir/paper.csv" ||
    echo "SKIP no Vulkan device: the performance table has no line of it"
grep -Eq '^ +4 +27 +14 +5 +4 +1296 +864 +1024 +656 +1\.976 +1\.317 +1\.561$' "$dir/out" || bad "ratios of bytes"
grep -q '</svg>' "$dir/paper.svg" || bad "no plot of the tables"
grep -q 'of time saved that is 17.8' "$dir/out" || bad "no paragraph on the 19 %"
grep -q 'WRONG' "$dir/out" && bad "a line's frame is not engine cpu's"

# The pipeline that a scene gets, and the one for every scene: a frame each, too few to say which is faster.
"$raydiff" bench special --size 16x12 --frames 1 --json "$dir/special.json" >"$dir/out" 2>"$dir/err"
code=$?
if [ "$code" -eq 77 ]; then
    echo "SKIP no Vulkan device: nothing was drawn by two pipelines"
else
    [ "$code" -eq 0 ] || bad "bench special ends with $code"
    [ "$(grep -c 'bits equal' "$dir/out")" -ge 3 ] || bad "bench special: both pipelines draw the same bits"
    python3 - "$dir/special.json" <<'END' || bad "bench special: the ratio is general to special"
import json, sys
rows = json.load(open(sys.argv[1]))["rows"]
assert len(rows) >= 3
for row in rows:
    assert row["bits_equal"] is True
    assert abs(row["general_ms"] / row["special_ms"] / row["ratio_median"] - 1) < 1e-4, row
END
fi

echo "frames: $failed failed"
[ "$failed" -eq 0 ]
