#!/bin/sh
# raydiff fuzz --steps: every trial is a life, the folder remembers it, and what does not go with it is refused.
# bisect and export of trials with steps.
#   sh tests/life/lives.sh BUILD/raydiff
set -u
raydiff=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
. tests/scripts/expect.sh
root=$PWD
cd "$dir" || exit 4
campaign='fuzz --jobs 1 --engine cpu --layout f32 --corpus none --rays 20'

expect 0 . $campaign --steps --trials 40 --dir lives
has 'a campaign of lives' 'findings +0 distinct'
head -n 1 lives/findings.jsonl | grep -q '|steps=yes|' || bad 'the folder does not remember --steps'
expect 0 . fuzz --jobs 1 --trials 50 --dir lives
has 'it goes on' 'after 40 generated ones'
tail -n 1 lives/findings.jsonl | grep -q '|steps=yes|' || bad 'it goes on without steps'
expect 0 . $campaign --trials 40 --dir plain
expect 2 '--steps yes: the campaign in plain has none' $campaign --steps --trials 50 --dir plain
expect 0 . $campaign --steps --worlds --trials 40 --dir worlds
has 'a campaign of lives of worlds' 'findings +0 distinct' 'moved +[1-9][0-9]* trees refitted, [1-9]'
expect 0 . fuzz --jobs 1 --trials 50 --dir worlds
tail -n 1 worlds/findings.jsonl | grep -q '|steps=yes|' || bad 'it goes on without steps'
expect 2 '--steps: not used with --pairs' fuzz --steps --pairs 2 --trials 3 --dir none
[ ! -e none ] || bad 'a folder is made for what is refused'

# --- contestants
expect 2 '[0-9]+ contestants .2 of --engine, on each of [0-9]+ layouts if one is needed., and at most 32 take part' \
    fuzz --trials 1 --engine cpu,fast --layout every --dir many
expect 0 . fuzz --trials 64 --rays 20 --jobs 1 --corpus none --engine cpu,brute,kd --layout f32 --dir few
expect 2 '33 contestants' fuzz --trials 1 --engine cpu,brute \
    --layout "$("$raydiff" list layouts | sed -n 's/^  \([a-z0-9_]*\) .*/\1/p' | head -n 32 | paste -sd, -)" --dir many
"$raydiff" fuzz --pairs 1 --trials 2560 --rays 5 --jobs 1 --engine kd,brute,cpu --layout f32 --builder median \
    --dir pairs >"$dir/out" 2>"$dir/err"
grep -qE 'kd answered [1-9][0-9]* trials' "$dir/out" || bad 'an engine with all its own is drawn with --pairs'

# --- bisect and export: of a trial with steps what its last tree holds, else one line
sed 's/^query .*/&\nsteps refit:jitter:3/' "$root/fuzz/corpus/eighth-slot.trial" >steps.trial
grep -q '^steps' steps.trial || bad 'a trial with steps'
expect 0 . replay steps.trial --engine cpu
expect 0 . explain steps.trial --engine cpu --layout f32
expect 2 'steps.trial: a trial with steps is not bisected: replay it' bisect steps.trial --engine cpu
for engine in embree embree_robust rayquery; do
    expect 2 'steps.trial: its steps are not exported for an engine that builds its own tree' \
        export steps.trial --engine $engine --to finding.c
done
[ ! -e finding.c ] || bad 'a file is written for what is refused'
for form in c amber text; do
    expect 0 . export steps.trial --engine vulkan --form $form --to finding.$form
    [ -s finding.$form ] || bad "$form is not written"
done

# --- a world with steps: replayed, and else refused in one line
sed 's/^query .*/&\nsteps refit:drift:3,rebuild:hide:2,refit:exchange:1/' "$root/fuzz/corpus/inactive-instance.trial" \
    >world.trial
grep -q '^steps' world.trial || bad 'a trial of a world with steps'
expect 0 'world.trial: .*clean' replay world.trial --brief --engine cpu,fast,embree_robust
expect 77 'world.trial: is of a world with steps: replay it' explain world.trial --engine cpu --layout f32
expect 2 'world.trial: a trial with steps is not bisected: replay it' bisect world.trial --engine cpu
expect 2 'world.trial: is a trial of a world: --form text writes' export world.trial --engine vulkan --to finding.c
expect 2 'world.trial: its steps are not exported' export world.trial --form text --to world.text
sed 's/^steps .*/steps refit:leap/' world.trial >leap.trial
expect 2 "leap.trial:[0-9]+: 'refit:leap': 'leap' is no motion" replay leap.trial --engine cpu
sed 's/^steps .*/steps refit:drift/' steps.trial >drift.trial
expect 2 "'drift' moves instances, which only worlds have" replay drift.trial --engine cpu
[ "$failed" -eq 0 ] && echo 'campaigns of lives: as they should be'
exit "$failed"
