#!/bin/sh
# The last line of a command counts every row that it printed: what is WRONG, what agrees, and what failed, was
# refused or skipped, or proves nothing.
#   sh tests/values/concluded.sh BUILD/raydiff
set -u
raydiff=$1
. tests/scripts/expect.sh
samples=$(dirname "$raydiff")/samples
[ -x "$samples/refuser" ] || samples=build/samples # a planted bug's program has none of its own
misses="pipe:$samples/refuser 1000000"             # answers every ray with a miss
few='--count 500 --repeat 1 --wide'

# Expected code, the whole last line as a pattern, arguments.
ends() {
    code=$1 line=$2
    shift 2
    expect "$code" . "$@"
    tail -n 1 "$dir/out" | grep -qE -- "^$line\$" || bad "raydiff $*: the last line is not /$line/"
}

# Answers that are WRONG are no result that proves nothing.
ends 1 'conclusion: 1 of 2 rows agree, 220 of 1000 answers WRONG' check sphere:n=4 $few --layout f32 --engine "cpu,$misses"
ends 1 'conclusion: 0 of 1 rows agree, 220 of 500 answers WRONG' check sphere:n=4 $few --engine "$misses"
grep -q 'vacuous' "$dir/out" && bad 'check: what is WRONG is called vacuous'
# Of 220 four are shown; what else the row is at fault for is not among the others.
[ "$(grep -c '^WRONG missed ' "$dir/out")" -eq 4 ] && grep -qx '  \.\.\. and 216 more of this row that are WRONG' "$dir/out" ||
    bad 'check: not four of 220 answers and a count of the others'
printf 'r 0.3 0.2 -9 0 0 0 1 100\nr 0.1 0.3 -9 0 0 0 1 100\n' >"$dir/rays"
printf 'm\nm\n' >"$dir/hits"
expect 1 . judge sphere:n=2 "$dir/rays" "$dir/hits"
grep -q 'against the exact truth: 2 of 2 answers WRONG' "$dir/out" || bad 'judge: what is WRONG is not counted'
# A tracer of no formula: its own test, parts that are told apart, words that the glossary has.
sed 's/q.rays, 1, 0, 0, 0}/q.rays, 0, 0, 0, 0}/' tests/peers/refuser.c >"$dir/unknown.c"
cc -O1 -o "$dir/unknown" "$dir/unknown.c" || bad 'a tracer is not compiled'
expect 1 . check sphere:n=4 $few --engine "pipe:$dir/unknown 1000000"
grep -q '^WRONG missed closest\.pipe:.*\.-\.own ray ' "$dir/out" || bad 'check: a formula that is unknown is called one of the table'
grep -q ' missed [0-9]*; displacement p50 .* uM, [0-9]* lost in closed fans; lost beside edges ' "$dir/out" ||
    bad 'check: parts of what a row has are not told apart'
for word in uM 'closed fan' 'lost beside edges'; do
    grep -q "^| $word |" docs/glossary.md || bad "the glossary has no '$word'"
done
expect 1 . judge sphere:n=2 "$dir/rays" "$dir/hits"
grep -q '^tree: ' "$dir/out" && bad 'judge: a tree that no engine walks'
grep -q '^WRONG  *-  *answer:.* -$' "$dir/out" || bad 'judge: the speed of a file'
# What is vacuous is told once.
expect 1 . check soup:n=0 $few --layout f32 --engine cpu
grep -q '^  cpu: vacuous: 0 hits of 500 rays prove nothing$' "$dir/out" || bad 'check: why a row is vacuous'
ends 1 'conclusion: 0 of 1 rows agree, 1 vacuous' check soup:n=0 $few --layout f32 --engine cpu
# Rows that did not run are counted, too.
ends 3 'conclusion: 0 of 1 rows agree, 1 failed' check sphere:n=2 $few --engine 'pipe:sleep 100' --peer-time 1
ends 77 'conclusion: 0 of 1 rows agree, 1 skipped' check sphere:n=2 $few --engine rayquery --driver no-such-driver
ends 2 'conclusion: 1 of 2 rows agree, 1 refused, 0 of 500 answers WRONG' \
    check sphere:n=300 $few --brute 0 --layout rf16,tiny8 --engine cpu
ends 0 'conclusion: 1 of 1 rows agree, 1 as published counted, 0 of 500 answers WRONG' \
    check rtrs $few --layout f32,rtrs_rf --engine cpu

# Of one run each it is not known which layout is faster (that ranges are far enough apart is told by check.awk).
ends 0 'conclusion: 2 of 2 rows agree, 0 of 1000 answers WRONG; speeds cannot be told apart' \
    check sphere:n=8 $few --layout f32,rf16 --engine cpu
grep -q "rf16 on cpu: .* times its speed, within noise\$" "$dir/out" || bad 'check: a speed of one run is told'

# No row twice: an engine with tests of its own is one row, whatever tests are named.
expect 0 . leaks sphere:n=4 --engine cpu,fast,embree,brute,"pipe:$samples/tracer" --layout f32 --count 2000
sed -n '/^verdict/,/^what it means/p' "$dir/out" | sort | uniq -d | grep -q . && bad 'leaks: a row twice'
expect 0 . leaks sphere:n=4 --engine fast --layout f32 --count 2000
grep -q '  1 of 1 rows promise' "$dir/out" || bad 'leaks: engine fast is one row'

# Each command that judges ends with a conclusion.
dxr='leaks sphere:n=4 --engine cpu --layout f32 --tri woop --box watertight --count 2000'
ends 0 'conclusion: 3 rows: [12] kept, 0 broken, [12] counted' leaks sphere:n=4 --engine cpu,embree --layout f32 --tri woop --count 2000
ends 1 'conclusion: 1 rows: 0 kept, 1 broken, 0 counted' $dxr --profile dxr
ends 1 'conclusion: 0 of 1 rows agree, 2 of 2 answers WRONG' judge sphere:n=2 "$dir/rays" "$dir/hits"
"$raydiff" gen sphere:n=4 --count 50 --decimal | awk -f fuzz/samples/tracer.awk | "$raydiff" verify >"$dir/out" 2>"$dir/err"
tail -n 1 "$dir/out" | grep -qx 'conclusion: 1 of 1 rows agree, 0 of 50 answers WRONG' || bad 'verify: no conclusion'
ends 0 'conclusion: 1 of 1 comparison with cpu as it should be' diff rtrs --engine cpu,vulkan --width 16 --height 12
ends 0 'conclusion: [0-9]+ of [0-9]+ engines run, [1-9] of [0-9]+ Vulkan drivers are here' doctor
head -n 1 "$dir/out" | grep -qE 'compiled by (gcc|Clang|.* Clang) [0-9]' || bad 'doctor: which compiler?'
sed -n '/^brute/,/^driver/p' "$dir/out" | grep '^        ' | sort | uniq -d | grep -q . && bad 'doctor: a device is described again'
ends 0 'bench error: [0-9]+ rows?: no answer is WRONG' \
    bench error --scene sphere:n=4 --count 60 --rounds 1 --engine cpu --layout f32 --tri mt

# One is told as one.
expect 1 . check soup:n=1 --rays random --count 1 --layout f32 --engine cpu
grep -q '^soup:n=1: 1 triangle, 3 vertices; 1 ray, set ' "$dir/out" && grep -q ': 1 node, 1 leaf, depth ' "$dir/out" || bad 'check: 1 triangles'

echo "concluded: $failed failed"
[ "$failed" -eq 0 ]
