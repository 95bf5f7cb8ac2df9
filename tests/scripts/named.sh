#!/bin/sh
# A named member must answer something. A tracer that refuses everything, or all but a little, makes
# every command that names it end with exit code 1 and a line that counts what it refused.
#   sh tests/scripts/named.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh
samples=$(dirname "$raydiff")/samples
[ -x "$samples/refuser" ] || samples=build/samples # a planted bug's program has none of its own
all="pipe:$samples/refuser 0" opening="pipe:$samples/refuser -1" rays="pipe:$samples/refuser rays"
honest="pipe:$samples/tracer"
vacuous='nothing of it is tested'

# Expected code, a line that the standard output must have, arguments.
says() {
    line=$2
    code=$1
    shift 2
    expect "$code" . "$@"
    grep -qE -- "$line" "$dir/out" "$dir/err" || bad "raydiff $*: no line like /$line/"
}
small='--count 100 --repeat 1'
for who in "$all" "$opening" "$rays"; do
    says 1 "^engine $who answered 0 of 1, refused 1: .*only teapots; vacuous: $vacuous" \
        check --wide sphere:n=4 $small --engine "$who"
    says 1 "^engine $who answered 0 of 1, refused 1: .*$vacuous" check --wide sphere:n=4 $small --engine "cpu,$who"
    says 1 "^engine $who answered 0 of 3, refused 3: .*$vacuous" \
        conform 'closest.*.mt.sphere.[pr]*' --count 20 --engine "$who"
    says 1 'it answered none of the trials' fuzz --trials 8 --rays 50 --corpus none --engine "$who" --dir "$dir/f${#who}"
done

# In files, too; a member that answers is not accused.
says 1 "answered 0 of 1, refused 1" check --wide sphere:n=4 $small --engine "cpu,$all" --json "$dir/check.json"
grep -A 8 '"name": "pipe:' "$dir/check.json" | grep -q '"refused": 1' || bad "check --json: no count of what was refused"
grep -A 8 '"name": "pipe:' "$dir/check.json" | grep -q '"vacuous": true' || bad "check --json: not vacuous"
grep -A 8 '"name": "cpu"' "$dir/check.json" | grep -q '"vacuous": false' || bad "check --json: cpu is accused"
expect 1 . conform 'closest.*.mt.sphere.random.1' --count 20 --engine "$all" --tap --junit "$dir/c.xml"
grep -q "^not ok 2 - engine.$all.answered" "$dir/out" || bad "conform --tap: no case for the engine"
grep -q '^1\.\.2$' "$dir/out" || bad "conform --tap: the plan is not of all cases"
grep -q "name=\"engine.$all.answered\".*<failure.*vacuous" "$dir/c.xml" || bad "conform --junit: no case for the engine"
expect 1 . fuzz --trials 8 --rays 50 --corpus none --engine "cpu,$all" --dir "$dir/g" --json "$dir/g.json" \
    --junit "$dir/g.xml" --tap "$dir/g.tap" --jsonl "$dir/g.jsonl"
grep -A 6 "\"name\": \"$all\"" "$dir/g.json" | grep -q '"refused": 8' || bad "fuzz --json: no count of what was refused"
grep -q "name=\"$all.played\".*<failure" "$dir/g.xml" || bad "fuzz --junit: who refuses all passes"
grep -q "^not ok .* - $all.played" "$dir/g.tap" || bad "fuzz --tap: who refuses all passes"
grep -q "^ok .* - cpu.f32.played" "$dir/g.tap" || bad "fuzz --tap: a member that answers is accused"
grep -q "\"name\": \"$all\".*it answered none of the trials" "$dir/g.jsonl" || bad "fuzz --jsonl: who refuses all passes"

# Nor is it another error that its formula, which is not known, has to be near enough.
for who in "$all" "$opening"; do
    says 1 'answered 0 of ' conform 'closest.*.mt.sphere.[pr]*' --count 20 --engine "$who" --displacement 8
    says 1 'answered 0 of ' check sphere:n=4 $small --engine "$who" --displacement 8
done

# No stand-in passes for it: what it refuses, none passes.
expect 1 . conform --count 20 --engine "$all"
grep -q '^0 passed, 1 failed, ' "$dir/out" || bad "conform: others passed for an engine that refuses all"

# All but a little is as good as all: cases without a triangle are the only ones that it answers.
says 1 'answered 2 of [0-9]+, refused [0-9]+: .*hardly anything of it is tested' conform --hard --quick --engine "$all"

# Its first run stays known when a campaign is resumed; there no trial is left to be played.
campaign="--trials 8 --rays 50 --corpus none"
expect 0 . fuzz $campaign --engine "cpu,$honest" --dir "$dir/h"
says 0 "$honest answered 8 trials, refused 0" fuzz $campaign --dir "$dir/h"
says 1 "$all answered 0 trials, refused 8.*vacuous" fuzz $campaign --dir "$dir/g"

# A member that is named and never asked, or refused everywhere, fails, too.
says 1 '^engine vulkan answered 0 of 0; vacuous: it was not run' \
    conform 'closest.cpu.f32.median.robust.mt.sphere.random.1*' --count 1000 --engine cpu,vulkan
says 1 '^layout bvh2_bf16_scene answered 0 of 1, refused 1' \
    conform 'closest.cpu.bvh2_bf16_scene:compact.median.robust.mt.sphere.random.1*' --layout bvh2_bf16_scene --store compact
expect 2 "no trial matches" conform 'closest.nothing.*' --engine cpu
# What cannot run here at all is skipped, as everywhere.
expect 77 . conform 'closest.rayquery.*.mt.sphere.random.1' --engine rayquery --driver no-such-driver

echo "named: $failed failed"
[ "$failed" -eq 0 ]
