#!/bin/sh
# raydiff fuzz and raydiff merge as a user meets them: options, going on, peers, merging.
#   sh tests/scripts/fuzz.sh BUILD
set -u
build=$1
raydiff=$build/raydiff
. tests/scripts/expect.sh
has() { grep -qE -- "$2" "$dir/$1" || bad "$1 has no line like /$2/"; }

# What is wrong with the options.
expect 2 "only options are expected" fuzz here
expect 2 "--shard: '3' is not two numbers" fuzz --shard 3
expect 2 '--shard: 4 is more than 3' fuzz --shard 4/3
expect 2 '--shard.*0' fuzz --shard 0/3
expect 2 '--triangles: 9 is more than 8' fuzz --triangles 9-8
expect 2 '--rays' fuzz --rays 0
expect 2 '--jobs' fuzz --jobs 0
expect 2 '--trials' fuzz --trials none
expect 2 "--trial-time: '0' is not a number from" fuzz --trial-time 0
expect 2 "unknown name 'rf17'" fuzz --layout rf17
expect 2 "unknown name 'gpu'" fuzz --engine gpu
expect 2 'no-such-folder/x: No such file' fuzz --dir "$dir/no-such-folder/x"
expect 2 'no-such-corpus is no folder' fuzz --corpus "$dir/no-such-corpus" --dir "$dir/none"
expect 2 'known.txt' fuzz --baseline "$dir/known.txt" --dir "$dir/none"

# A campaign, and going on with it.
small="--rays 40 --jobs 2 --corpus none"
expect 1 . fuzz $small --engine cpu --layout rtrs_rf --faithful --trials 200 --seed 9 --dir "$dir/a" --json "$dir/a.json"
has out '^new      cpu\.rtrs_rf\.missed\.index_shifted  [0-9]+ times, smallest: [1-4] triangles?, 1 ray$'
has out '^         items are numbered one off'
has out '^         raydiff replay .*/a/cpu\.rtrs_rf\.missed\.index_shifted/smallest\.trial$'
has out '^trials     200 '
for key in trials_per_s judged_rays_per_s harness_share harness_to_engines triangles_mean triangles_median \
    rays judged findings signature count first smallest replay state coverage versions restarts seed exit; do
    grep -q "\"$key\": " "$dir/a.json" || bad "fuzz --json: no key $key"
done
[ -s "$dir/a/stats.json" ] || bad "the folder has its stats"
"$raydiff" replay "$dir/a/cpu.rtrs_rf.missed.index_shifted/smallest.trial" --brief >"$dir/out" 2>"$dir/err"
[ $? -eq 1 ] || bad "a finding of a campaign fails when it is replayed"
expect 2 '--seed 8: the campaign in .*/a has 9 ' fuzz --dir "$dir/a" --seed 8
expect 2 '--layout f32: the campaign in .*/a has rtrs_rf ' fuzz --dir "$dir/a" --layout f32
expect 2 '--shard 1/2: the campaign in .*/a has none ' fuzz --dir "$dir/a" --shard 1/2
expect 1 . fuzz $small --dir "$dir/a" --trials 264 --seed 9
has out '^trials     64 .*, after 200 generated ones of earlier runs$'
expect 1 . fuzz $small --dir "$dir/b" --engine cpu --layout rtrs_rf --faithful --trials 9000 --until 2
has out '^findings   [2-9] distinct'
expect 0 . fuzz $small --dir "$dir/c" --engine cpu --builder median --layout f32 --time 1 --triangles 2-5
has out 'triangles \(median [2-6]\)'
expect 77 . fuzz $small --dir "$dir/d" --engine vulkan --driver no-such-driver --trials 64

# --trials counts what is generated; the rest is told beside it.
expect 0 . fuzz --rays 40 --engine cpu --trials 64 --corpus fuzz/corpus --dir "$dir/more"
count=$(sed -n 's/^trials .*, \([0-9]*\) of the corpus$/\1/p' "$dir/out")
has out "^trials     $((64 + ${count:-0})) "
[ "${count:-0}" -gt 0 ] || bad "the trials of the corpus are told"
expect 0 . fuzz --rays 40 --engine cpu --trials 192 --feedback --corpus none --dir "$dir/mutants"
has out '^trials     [0-9]+ .*, [1-9][0-9]* mutants$'

# Whoever mistyped a tracer's command tries again; once a trial was played it stays.
expect 77 . fuzz $small --dir "$dir/again" --engine pipe:no-such-tracer --trials 64
expect 0 . fuzz $small --dir "$dir/again" --engine cpu --layout f32 --trials 64
expect 2 '--engine pipe:no-such-tracer: the campaign in .* has cpu ' fuzz --dir "$dir/again" --engine pipe:no-such-tracer
expect 0 . fuzz $small --dir "$dir/again" --trials 64
has out '^trials     0 .*, after 64 generated ones of earlier runs$'

# A file that cannot be written is told before a trial is played.
for option in json junit tap jsonl; do
    expect 2 'no-such-folder/x: cannot write' fuzz $small --dir "$dir/early" --trials 64 --$option "$dir/no-such-folder/x"
done
[ -e "$dir/early/stats.json" ] && bad "nothing was played"
expect 0 . fuzz $small --dir "$dir/early" --engine cpu --trials 64 --json "$dir/early/x.json"
grep -q '"exit": 0' "$dir/early/x.json" || bad "results may be in the folder"

# Commands that are printed can be typed, blanks and all.
expect 1 . fuzz $small --engine cpu --layout rtrs_rf --faithful --trials 64 --no-shrink --dir "$dir/two words"
printed=$(sed -n 's/^to shrink .*: raydiff //p' "$dir/out")
eval "\"\$raydiff\" $printed" >"$dir/out" 2>"$dir/err" || bad "the command that was printed shrinks a folder"
has out ': [0-9]+ findings, [1-9][0-9]* of them smaller now$'

# A screen is as wide as the terminal, so that no line of it becomes two.
screen() {
    script -qec "stty cols $1; '$raydiff' fuzz $(echo "$small" | sed 's/--jobs 2/--jobs 1/') --engine cpu --layout f32 --time 1 --dir '$dir/screen'" /dev/null \
        >"$dir/out" 2>"$dir/err" </dev/null || bad "fuzz on a terminal"
    tr -d '\r' <"$dir/out" | sed -n "s/.*$(printf '\033')\[K//p" | sed 's/\x1b\[[0-9;]*m//g' >"$dir/rows"
}
if ! script -qec true /dev/null >/dev/null 2>&1 </dev/null; then
    echo "SKIP the screen on a terminal: script(1) gets no pseudo-terminal here"
else
    export TERM=xterm
    screen 30
    grep -q '^workers' "$dir/rows" || bad "a terminal has a screen"
    [ "$(wc -L <"$dir/rows")" -eq 29 ] || bad "a narrow one is used, and not more of it"
    screen 200
    [ "$(wc -L <"$dir/rows")" -le 159 ] || bad "long rows are hard to read"
    TERM=dumb
    screen 80
    [ -s "$dir/rows" ] && bad "a dumb terminal has no screen"
fi

# Every option of it is kept, compared if it is given again, and taken from the folder if not.
every="seed=9 shard=1/2 engine=cpu,vulkan layout=f32 builder=median rays=40 triangles=4-9 driver=stock device=0 workgroup=32"
expect 1 . fuzz $(for one in $every; do echo "--${one%=*} ${one#*=}"; done) --faithful --jobs 1 --corpus none --trials 64 \
    --dir "$dir/every"
for one in seed=8:9 shard=2/2:1/2 engine=brute:cpu,vulkan layout=rf16:f32 builder=rtrs:median rays=41:40 triangles=4-10:4-9 \
    driver=two:stock device=1:0 workgroup=64:32; do
    key=${one%%=*} value=${one#*=}
    expect 2 "--$key ${value%:*}: the campaign in .*/every has ${value#*:} " fuzz --dir "$dir/every" "--$key" "${value%:*}"
done
expect 2 '--faithful yes: the campaign in .*/c has none ' fuzz --dir "$dir/c" --faithful
expect 1 . fuzz --jobs 1 --corpus none --trials 192 --dir "$dir/every"
[ "$(grep -o '"gen=.*|corpus_done=' "$dir/every/findings.jsonl" | sort -u | wc -l)" -eq 1 ] ||
    bad "an option that is not given again is another one"
grep -q "|faithful=yes|rays=40|" "$dir/every/findings.jsonl" || bad "the options are in the folder"
has out '^trials     64 .*, after 64 generated ones of earlier runs$'
for version in 0 4000000000; do
    rm -rf "$dir/old"
    cp -r "$dir/every" "$dir/old"
    sed "s/gen=[0-9]*|/gen=$version|/" "$dir/every/findings.jsonl" >"$dir/old/findings.jsonl"
    expect 2 "made by version $version of the generators" fuzz --trials 200 --dir "$dir/old"
done

# Tracers of others: one with a bug, one that is not there any more when it is asked, one that hangs.
tracer="pipe:$build/samples/tracer"
expect 0 . fuzz $small --engine "$tracer" --trials 128 --dir "$dir/sound"
expect 1 . fuzz $small --engine "${tracer}_bug1" --trials 128 --dir "$dir/bug"
has out '^new      pipe:tracer_bug1\.'
has out 'smallest: [1-4] triangles?, 1 ray$'
printed=$(sed -n 's/^ *raydiff replay//p' "$dir/out" | head -n 1)
eval "\"\$raydiff\" replay --brief $printed" >"$dir/out" 2>"$dir/err"
[ $? -eq 1 ] || bad "the command that was printed plays a tracer's finding"
finding=$(ls -d "$dir"/bug/pipe=tracer_bug1.* | head -n 1)
"$raydiff" replay "$finding/smallest.trial" --brief --engine "${tracer}_bug1" >"$dir/out" 2>"$dir/err"
[ $? -eq 1 ] || bad "a tracer's finding fails when it is replayed"
"$raydiff" replay "$finding/smallest.trial" --brief --engine "$tracer" >"$dir/out" 2>"$dir/err"
[ $? -eq 0 ] || bad "and not with the sound tracer"
expect 3 . fuzz $small --engine pipe:false --trials 64 --dir "$dir/never"
expect 1 . fuzz $small --engine "cpu,pipe:dd bs=1 count=30000 status=none | $build/samples/tracer" --layout f32 --trials 64 \
    --no-shrink --dir "$dir/dies"
has out '^new      pipe:dd_.*\.-\.crash'
has out '^trials     64 '
expect 1 . fuzz $small --engine "cpu,pipe:dd bs=1 count=90000 status=none | $build/samples/tracer; sleep 100" --layout f32 \
    --trials 64 --trial-time 0.5 --no-shrink --dir "$dir/hangs"
has out '^new      pipe:dd_.*\.-\.hang'
has out '^trials     64 '

# A tracer with a constant that does not scale: the page says the cause that the finding has.
sed 's/size > 0\.0f/size > 1e-3f/' fuzz/samples/sample_tracer.c >"$dir/flat.c"
cc -O2 -o "$dir/flat" "$dir/flat.c" || bad "the tracer is compiled"
cat >"$dir/flat.trial" <<'END'
raydiff trial 1
expect pipe:flat.-.missed.scale
builder median leaf 4 eps 0.02
box robust
tri mt
query closest
vertices 3
0 0 0
0.015625 0 0
0 0.015625 0
triangles 1
0 1 2
rays 2
1 1 1 0 0 -1 0 9
0.00390625 0.00390625 1 0 0 -1 0 9
end
END
expect 1 . replay "$dir/flat.trial" --engine "pipe:$dir/flat"
has out 'STILL FAILS'
has out '^cause     scale: '
expect 1 . explain "$dir/flat.trial" --engine "pipe:$dir/flat"
has out '^cause     scale: '
has out '^again     raydiff explain .*flat\.trial --index 1 '
expect 1 . explain "$dir/flat.trial" --engine "pipe:$dir/flat" --cause scale --json "$dir/flat.json"
grep -q '"cause": "scale"' "$dir/flat.json" || bad "explain --json says the cause"
expect 0 . explain "$dir/flat.trial" --engine "pipe:$dir/flat" --cause outside

# Merging.
expect 2 'no folder given' merge --to "$dir/m"
expect 2 'is needed' merge "$dir/a"
expect 2 'no-such' merge --to "$dir/m" "$dir/no-such"
expect 2 'not empty' merge --to "$dir/a" "$dir/b"
expect 2 . merge --to "$dir/m" "$dir/a" "$dir/a"
expect 0 . merge --to "$dir/m" "$dir/a" "$dir/b"
has out '^to     .*/m: [0-9]+ distinct, [0-9]+ in all$'
expect 2 'from raydiff merge, not from a campaign' fuzz --dir "$dir/m"
echo "fuzz: $failed failed"
[ "$failed" -eq 0 ]
