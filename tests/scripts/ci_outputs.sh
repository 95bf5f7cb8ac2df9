#!/bin/sh
# raydiff fuzz as a CI system meets it: exit codes, the baseline, JUnit, TAP, JSON lines, interruption.
#   sh tests/scripts/ci_outputs.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh
number=0
# Expected code, options: a new campaign.
fuzz() {
    code=$1
    shift
    number=$((number + 1))
    "$raydiff" fuzz --engine cpu --corpus none --no-shrink --rays 50 --jobs 1 --dir "$dir/$number" \
        --junit "$dir/a.xml" --tap "$dir/a.tap" --jsonl "$dir/a.jsonl" "$@" >"$dir/out" 2>"$dir/err"
    got=$?
    [ "$got" -eq "$code" ] || bad "fuzz $*: exit $got, not $code"
}
has() { grep -qF -- "$2" "$dir/$1" || bad "$1 has no line with $2"; }

# Clean: one passing test case per contestant.
fuzz 0 --layout f32,rf16 --trials 128
has a.xml 'tests="3" failures="0" errors="0" skipped="0"'
has a.xml 'name="cpu.rf16.played"'
has a.tap 'ok 3 - cpu.rf16.played'
has a.jsonl '"trials": 128'

# Found, known, expired.
fuzz 1 --layout rtrs_rf --trials 128
has a.tap 'not ok 3 - cpu.rtrs_rf.'
has a.xml '<failure message="new, found '
[ "$(grep -c '<failure ' "$dir/a.xml")" = "$(grep -c '"counts": true' "$dir/a.jsonl")" ] ||
    bad "as many failures as findings"
link=https://example.org
echo "cpu.rtrs_rf.*.* until - as published $link" >"$dir/known"
fuzz 0 --layout rtrs_rf --trials 128 --baseline "$dir/known"
has a.tap '# TODO known, found '
has a.xml "as published $link"
has a.xml 'failures="0"'
echo "cpu.rtrs_rf.*.* until 2020-01-01 as published $link" >"$dir/known"
fuzz 1 --layout rtrs_rf --trials 128 --baseline "$dir/known"
has out 'expired  cpu.rtrs_rf.'
has a.xml '<failure message="expired, found '
has a.jsonl 'known until 2020-01-01: as published'
echo "cpu.rtrs_rf.crash.* until - as published $link" >"$dir/known"
fuzz 0 --layout f32 --trials 128 --baseline "$dir/known"
fuzz 1 --layout rtrs_rf --trials 128 --baseline "$dir/known"
has out "unused     $dir/known:1: 'cpu.rtrs_rf.crash.*' excused nothing here"
has a.jsonl "excused nothing here"
echo "cpu.rtrs_rf.*.* until tomorrow as published $link" >"$dir/known"
fuzz 2 --layout rtrs_rf --trials 128 --baseline "$dir/known"
has err "known:1: after the pattern comes 'until YYYY-MM-DD'"

# Interrupted before all trials were played: not 0, so that a shard is not taken for played. Then the
# rest, as if nothing had happened.
long="--engine cpu --corpus none --no-shrink --rays 50 --jobs 1 --layout rf16 --trials 16000"
"$raydiff" fuzz $long --dir "$dir/cut" >"$dir/out" 2>"$dir/err" &
pid=$!
tries=0
until [ -s "$dir/cut/findings.jsonl" ] || [ "$tries" -gt 100 ]; do sleep 0.1 && tries=$((tries + 1)); done
sleep 0.3
kill -TERM $pid
wait $pid
got=$?
[ "$got" -eq 143 ] || bad "interrupted: exit $got, not 143"
has out 'unplayed   trials are left'
"$raydiff" fuzz $long --dir "$dir/cut" --jsonl "$dir/a.jsonl" >"$dir/out" 2>"$dir/err" || bad "gone on"
has a.jsonl '"trials": 16000'
grep -q '^unplayed' "$dir/out" && bad "all is played"
# Where nothing is left to play, the outputs are still those of the whole.
"$raydiff" fuzz $long --dir "$dir/cut" --jsonl "$dir/b.jsonl" --tap "$dir/a.tap" --junit "$dir/a.xml" >"$dir/out" 2>"$dir/err" ||
    bad "once more"
has b.jsonl '"trials": 16000'
grep -q '^not ok' "$dir/a.tap" && bad "no trial counts as played: $(grep '^not ok' "$dir/a.tap")"
has a.xml 'failures="0" errors="0"'

# The readers of others, where they are.
fuzz 1 --layout rtrs_rf --trials 128
command -v xmllint >/dev/null && { xmllint --noout "$dir/a.xml" || bad "xmllint takes the JUnit file"; }
if command -v prove >/dev/null; then
    prove --exec cat "$dir/a.tap" >"$dir/out" 2>&1
    has out "Tests: $(grep -c ok "$dir/a.tap") Failed: $(grep -c '^not ok' "$dir/a.tap")"
fi
echo "ci_outputs: $failed failed"
[ "$failed" -eq 0 ]
