#!/bin/sh
# Signals at many moments of a campaign of fuzzing that is then run again.
#   sh tests/scripts/signals.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh

small="--rays 40 --jobs 2 --corpus none --engine cpu --seed 9"
# Its end is that of one that nothing interrupted. A merged folder has what was found, without the
# checkpoints.
campaign() { # folder, command before
    folder=$1
    shift
    "$@" "$raydiff" fuzz $small --layout rtrs_rf --faithful --trials 256 --dir "$folder" >"$dir/out" 2>"$dir/err"
}
normal() {
    rm -rf "$dir/$2"
    "$raydiff" merge --to "$dir/$2" "$1" >"$dir/out" 2>"$dir/err" || bad "merge $1"
}
start=$(date +%s%N)
campaign "$dir/whole" env
[ $? -eq 1 ] || bad "the campaign finds something"
ms=$((($(date +%s%N) - start) / 1000000))
normal "$dir/whole" whole.normal
[ "$(ls "$dir/whole.normal" | wc -l)" -gt 4 ] || bad "too little was found"
for signal in INT TERM HUP KILL; do
    interrupted=0 moments=0
    for part in 3 5 6 7 8; do
        rm -rf "$dir/cut"
        after=$(awk "BEGIN { print $ms * $part / 10000 }")
        campaign "$dir/cut" timeout --foreground -s $signal "$after" env --default-signal=INT,TERM,HUP
        code=$?
        moments=$((moments + 1))
        [ "$code" -lt 124 ] || interrupted=$((interrupted + 1))
        campaign "$dir/cut" env
        [ $? -eq 1 ] || bad "$signal after $after s, run again: exit $?"
        normal "$dir/cut" cut.normal
        diff -r "$dir/whole.normal" "$dir/cut.normal" >"$dir/out" 2>&1 ||
            bad "$signal after $after s: the end is another one"
        [ -z "$(find "$dir/cut" -name '*tmp*')" ] || bad "$signal after $after s: $(find "$dir/cut" -name '*tmp*') is left"
    done
    [ "$interrupted" -gt 0 ] || bad "$signal: never came in time"
    echo "passed  $signal: $interrupted of $moments runs were interrupted"
done

# What begins with hangups ignored, as under nohup, goes on through them.
for part in 2 5 8; do
    rm -rf "$dir/cut"
    after=$(awk "BEGIN { print $ms * $part / 10000 }")
    campaign "$dir/cut" timeout --preserve-status --foreground -s HUP "$after" env --ignore-signal=HUP
    code=$?
    [ "$code" -eq 1 ] || bad "a hangup that is ignored, after $after s: exit $code"
    normal "$dir/cut" cut.normal
    diff -r "$dir/whole.normal" "$dir/cut.normal" >"$dir/out" 2>&1 || bad "a hangup that is ignored: the end is another one"
done

echo "signals: $failed failed"
[ "$failed" -eq 0 ]
