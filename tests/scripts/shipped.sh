#!/bin/sh
# What a user meets outside of the checkout: waivers and baseline are part of the program, rows say what
# ran, names of findings are names of files everywhere, outputs are tried before the work.
#   sh tests/scripts/shipped.sh BUILD/raydiff
set -u
raydiff=$(realpath "$1")
. tests/scripts/expect.sh
samples=$(dirname "$raydiff")/samples
[ -x "$samples/tracer_bug1" ] || samples=$(realpath build/samples)
away=$dir/away
mkdir "$away"
here=$(pwd)

# The waivers of the hard cases, where no tests/waivers.txt is.
cd "$away" || exit 4
hard='hard.34-flat-boxes.closest.cpu.f32.median.*.mt'
expect 0 . conform "$hard"
grep -q ' [1-9][0-9]* waived' "$dir/out" || bad "conform: no waiver is part of the program"
echo 'hard.99-nothing.* no such case a://b' >"$dir/waivers"
expect 1 . conform "$hard" --waivers "$dir/waivers"
cd "$here" || exit 4

# A finding that the baseline knows is known to report, too.
one="pipe:env $samples/tracer_bug1" two="pipe:env $samples/tracer_bug2"
campaign='--trials 16 --rays 50 --corpus none --no-shrink'
echo 'pipe:env_tracer_bug1.*.*.* until - a planted bug a://b' >"$dir/baseline"
expect 0 . fuzz $campaign --engine "$one" --dir "$dir/known" --baseline "$dir/baseline"
expect 1 . report --findings "$dir/known" --engine "$one" --parts check --out "$dir/r.html"
expect 0 . report --findings "$dir/known" --engine "$one" --parts check --out "$dir/r.html" \
    --baseline "$dir/baseline" --json "$dir/r.json"
grep -q 'Everything agrees' "$dir/r.html" || bad "report: the banner is red for what the baseline knows"
grep -q 'known: a planted bug' "$dir/r.html" || bad "report: does not say that a finding is known"
grep -q '"failing": 0' "$dir/r.json" || bad "report --json: what is known fails"

# Two peers of one interpreter have two names, which every store of files takes.
expect 1 . fuzz $campaign --engine "$one,$two" --dir "$dir/two"
ls "$dir/two" >"$dir/names"
! grep -q '[]:"<>|*?\\[]' "$dir/names" || bad "fuzz: a folder's name has a byte that stores refuse"
for name in tracer_bug1 tracer_bug2; do
    grep -q "^pipe=env_$name\.-\." "$dir/names" || bad "fuzz: no finding is called after env $name"
done
mkdir "$dir/v1" && cp "$samples/tracer" "$dir/v1/tracer"
expect 2 'both are called pipe:tracer in findings' fuzz $campaign --engine "pipe:$samples/tracer,pipe:$dir/v1/tracer" \
    --dir "$dir/same"

# A folder of an older raydiff is read, and resumed under its names.
cp -r "$dir/known" "$dir/old"
for name in "$dir"/old/pipe=*; do mv "$name" "$dir/old/pipe:${name##*/pipe=}"; done
expect 0 . merge --to "$dir/merged" "$dir/old"
found=$(ls "$dir/known" | grep -c '^pipe=')
[ "$(ls "$dir/merged" | grep -c '^pipe=')" -eq "$found" ] || bad "merge: an older folder's findings are lost"
expect 0 . fuzz $campaign --dir "$dir/old" --baseline "$dir/baseline"
! ls "$dir/old" | grep -q '^pipe=' || bad "fuzz: an older folder's findings are there twice"

# Rows say what ran, with its own bytes.
expect 0 . check --wide sphere:n=20 --engine cpu,fast --layout f32 --count 1000 --repeat 1 --json "$dir/fast.json"
grep -q '^f32  *fast  *own  *woop  *closest' "$dir/out" || bad "check: a row of fast says other tests than it ran"
grep '^f32 ' "$dir/out" | awk '{print $6, $7}' >"$dir/bytes"
[ "$(sort -u "$dir/bytes" | wc -l)" -eq 2 ] || bad "check: fast has the bytes of f32"

# So do those of engines with tests of their own, and of a peer that declares its formula, whatever is asked for.
expect 0 . check --wide sphere:n=20 --engine "cpu,embree,embree_robust,pipe:$samples/tracer" --tri woop --count 100 --repeat 1 \
    --json "$dir/own.json"
for engine in embree embree_robust; do
    grep -q "^-  *$engine  *-  *own  *closest" "$dir/out" || bad "check: a row of $engine says another test than it ran"
done
grep -q '^-  *pipe:[^ ]*  *-  *mt  *closest' "$dir/out" || bad "check: a row of a peer says another test than it declares"
[ "$(grep -c '"tri": "own"' "$dir/own.json")" -eq 2 ] && [ "$(grep -c '"tri": "mt"' "$dir/own.json")" -eq 1 ] ||
    bad "check --json: rows say other tests than ran"

# Who refuses a scene says why in JSON.
expect 2 . check sphere:n=150 --layout rf16 --engine cpu --count 100 --repeat 1 --brute 0 --json "$dir/refused.json"
grep -q '"refused": "rf16: ' "$dir/refused.json" || bad "check --json: no reason of what is refused"

# doctor: 0 here, or the reason why not; nothing is told twice.
"$raydiff" doctor >"$dir/out" 2>"$dir/err"
case $? in
0) ;;
77) echo "SKIP doctor: $(grep -A 1 SKIPPED "$dir/out" | grep why | head -n 1)" ;;
*) bad "doctor: ends neither with 0 nor with 77" ;;
esac
awk '/^    why: /{why = substr($0, 10); next} why != "" && index($0, why) {twice = 1} {why = ""} END {exit twice}' \
    "$dir/out" || bad "doctor: a reason is told twice"
expect 77 . doctor --driver no-such-driver

# An output that cannot be written is told before the work, and one that can be is left as it was.
nowhere=$dir/none/x
for arguments in 'check sphere:n=4 --engine cpu --count 100 --json' 'leaks sphere:n=4 --json' 'conform --json' 'conform --junit' \
    'conform --hard --markdown' 'conform --hard --html' 'bench error --json' 'bench error --csv' 'bench error --svg' \
    'replay fuzz/corpus/sentinel.trial --json' 'explain sphere:n=4 --json' 'diff sphere:n=2 --json' 'doctor --json' \
    'judge sphere:n=4 a b --json' 'min fuzz/corpus/sentinel.trial --json' "fuzz --trials 1 --dir $dir/w --tap" \
    "report sphere:n=2 --out $dir/r2.html --json"; do
    case $arguments in conform\ --json) continue ;; esac
    expect 2 . $arguments "$nowhere"
    grep -q 'cannot write' "$dir/err" || bad "raydiff $arguments: does not say what cannot be written"
    [ ! -s "$dir/out" ] || bad "raydiff $arguments: works before it looks where to"
    [ "$failed" -eq 0 ] || break # the work of the others would take minutes
done
echo before >"$dir/kept"
expect 2 . check sphere --json "$dir/kept" --layout no_such_layout
[ "$(cat "$dir/kept")" = before ] || bad "check --json: a file that is there is cut before the work is done"
expect 2 . check --json "$dir/fresh"
[ ! -e "$dir/fresh" ] || bad "check --json: an empty file is left behind"

# A page of a scene without a wrong answer is a file, too.
expect 0 . explain soup --rays random --count 2000 --json "$dir/none.json"
grep -q '"rays_judged": 2000' "$dir/none.json" && grep -q '"cause": "none"' "$dir/none.json" ||
    bad "explain --json says that nothing is wrong"

echo "shipped: $failed failed"
[ "$failed" -eq 0 ]
