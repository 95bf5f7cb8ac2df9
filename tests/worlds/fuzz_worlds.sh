#!/bin/sh
# Trials of worlds as a user meets them: fuzz --worlds, replay, min, merge; what takes scenes refuses them.
#   sh tests/worlds/fuzz_worlds.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh
has() { grep -qE -- "$2" "$dir/$1" || bad "$1 has no line like /$2/"; }
small="--rays 100 --jobs 2 --corpus none"
published="--engine cpu --layout rtrs_rf --faithful"

# What cannot be.
expect 2 '--pairs: draws members for scenes, so not with --worlds' fuzz --worlds --pairs 1 --dir "$dir/none"
expect 77 '^raydiff fuzz: cpu_stackless traces scenes, not worlds$' fuzz --worlds --engine cpu,cpu_stackless --trials 64 --dir "$dir/fast"

# An honest engine is right in every world.
expect 0 . fuzz --worlds $small --engine cpu,brute --trials 320 --feedback --dir "$dir/clean"
has out '^trials     [0-9]+ .*, [1-9][0-9]* mutants$'
has out '^           brute answered [0-9]+ trials, refused 0$'
has out '^findings   0 distinct'

# A layout as published loses the last instance, too. Whatever the workers, the folder is the same.
expect 1 . fuzz --worlds $small $published --trials 192 --seed 9 --dir "$dir/a" --json "$dir/a.json"
has out '^new      cpu\.rtrs_rf\.missed\.unexplained  [0-9]+ times, smallest: 1 triangle, 1 ray$'
has out '^new      cpu\.rtrs_rf\.tree\.triangle_lost  [0-9]+ times, smallest: 1 triangle, 0 rays$'
grep -q '|worlds=yes|' "$dir/a/findings.jsonl" || bad "the option is in the folder"
grep -q '"opinion":"[^"]*mask 0x[0-9A-F]* flags 0x[0-9A-F]*, got nothing, expected instance ' "$dir/a/findings.jsonl" ||
    bad "a finding has what the ray may meet and where the triangles are"
expect 1 . fuzz --worlds --rays 100 --jobs 1 --corpus none $published --trials 192 --seed 9 --dir "$dir/b"
expect 2 '--seed 8: the campaign in .*/a has 9 ' fuzz --dir "$dir/a" --seed 8
expect 1 . fuzz --dir "$dir/a" --trials 192 --jobs 1 --corpus none # goes on with worlds, of which none is left
has out '^trials     0 .*, after 192 generated ones of earlier runs$'
for folder in "$dir"/a/cpu.*; do
    for file in first smallest; do
        cmp -s "$folder/$file.trial" "$dir/b/${folder##*/}/$file.trial" || bad "$folder/$file.trial is the same in both"
    done
done
small_one=$dir/a/cpu.rtrs_rf.missed.unexplained/smallest.trial
large=$dir/a/cpu.rtrs_rf.missed.unexplained/first.trial
[ "$(head -1 "$small_one")" = "raydiff trial 2" ] || bad "a world's trial has version 2"
[ "$(grep -c . "$small_one")" -le 24 ] || bad "the smallest is small"
grep -qx 'instances 1' "$small_one" || bad "of one instance"

# Scenes and worlds are no campaign together.
expect 0 . fuzz $small --engine cpu --layout f32 --trials 64 --dir "$dir/scenes"
expect 2 '--worlds yes: the campaign in .*/scenes has none ' fuzz --worlds --dir "$dir/scenes"
mkdir "$dir/corpus"
cp "$small_one" fuzz/corpus/sentinel.trial "$dir/corpus"
expect 1 . fuzz --worlds --rays 40 --jobs 1 $published --corpus "$dir/corpus" --trials 64 --no-shrink --dir "$dir/of-worlds"
has out '^trials     65 .*, 1 of the corpus$'
expect 1 . fuzz --rays 40 --jobs 1 $published --corpus "$dir/corpus" --trials 64 --no-shrink --dir "$dir/of-scenes"
has out '^trials     65 .*, 1 of the corpus$'

# Shards, merged, are one run.
for shard in 1 2; do
    expect 1 . fuzz --worlds $small $published --trials 192 --seed 9 --shard $shard/2 --dir "$dir/shard$shard"
done
expect 0 . merge --to "$dir/merged" "$dir/shard1" "$dir/shard2"
expect 0 . merge --to "$dir/whole" "$dir/a"
expect 0 . min "$dir/merged"
for folder in "$dir"/a/cpu.*; do
    cmp -s "$folder/first.trial" "$dir/merged/${folder##*/}/first.trial" || bad "$folder: the first of shards is that of one run"
    cmp -s "$folder/smallest.trial" "$dir/merged/${folder##*/}/smallest.trial" || bad "$folder: shrunk, too"
done

# Again, smaller, and nothing that is small is made smaller.
expect 1 . replay "$large" --json "$dir/replay.json"
grep -qx "   \"instances\": $(sed -n 's/^instances //p' "$large")" "$dir/replay.json" || bad "replay --json has the instances"
has out '^  trial    [0-9]+ instances?, [0-9]+ triangles?, 100 rays, '
has out ' missed unexplained, ray [0-9]+ .*; mask 0x[0-9A-F]+ flags 0x[0-9A-F]+, got nothing, expected instance [0-9]+ geometry [0-9]+ triangle [0-9]+ <- expected$'
expect 0 . replay "$large" --as-expected --brief --engine cpu
expect 0 . replay "$large" --engine brute --brief
expect 0 . min "$large" --out "$dir/small.trial" --json "$dir/min.json"
[ "$(grep -c '"instances": 1$' "$dir/min.json")" -eq 1 ] || bad "min --json has the instances"
has out '^  before   [0-9]+ instances?, [0-9]+ triangles?, 100 rays,'
has out '^  after    1 instance, 1 triangle, 1 ray, 3 vertices,'
expect 0 . min "$dir/small.trial" --out "$dir/same.trial"
cmp -s "$dir/small.trial" "$dir/same.trial" || bad "the smallest stays as it is"

# Its own rays are explained, all together.
expect 1 . explain "$large" --engine cpu --wide
has out ', query (closest|any): 100 rays of set its own, modes its own: [0-9]+ WRONG: '
has out '^cause  world_box: top level, .*: rtrs_rf: .*triangle [0-9]+'
expect 1 . explain "$dir/small.trial"
has out '^conclusion: WRONG: 1 of 1 answers, by world_box$'
sed '/^rays 1/,$s/ 255 0 #/ 17 4 #/' "$dir/small.trial" >"$dir/masked.trial"
expect 1 . explain "$dir/masked.trial"
has out '^the first, ray 0, mask 0x11, flags 0x004:'
expect 0 . explain "$large" --engine brute
has out '^conclusion: no answer is wrong$'
expect 2 "raydiff explain: --rays: .*small.trial brings its own" explain "$dir/small.trial" --rays random
expect 2 "raydiff explain: --modes: .*small.trial brings its own" explain "$dir/small.trial" --modes all
expect 2 "raydiff explain: --index: .*small.trial is a world; it is for scenes" explain "$dir/small.trial" --index 0
# What takes scenes says so in one line.
expect 2 "raydiff export: .*/small.trial: is a trial of a world: --form text writes" export "$dir/small.trial"
printf 'raydiff 1\nfrom 284c1685c959d337 1 2 mixed mixed\nm\nm\n' >"$dir/answers"
"$raydiff" verify <"$dir/answers" >"$dir/out" 2>"$dir/err"
[ $? -eq 2 ] && grep -q "'from' is for a scene, but 'mixed' is a world now" "$dir/err" ||
    bad "verify refuses the answers of version 1 to a world"

# A file that was cut, or of another kind, is named with its line.
sed 's/^geometries 1/geometries 2/' "$small_one" >"$dir/cut.trial"
expect 2 "cut.trial:[0-9]+: 'mesh' is needed here, not 'instances'" replay "$dir/cut.trial"
sed 's/^raydiff trial 2/raydiff trial 1/' "$small_one" >"$dir/cut.trial"
expect 2 'cut.trial:[0-9]+: filters are of worlds' replay "$dir/cut.trial"

echo "fuzz_worlds: $failed failed"
[ "$failed" -eq 0 ]
