#!/bin/sh
# Standard files that are closed when raydiff is started.
#   sh tests/scripts/standard_files.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh

# A closed standard output takes no file's place, and is an output that cannot be written.
small="--rays 40 --jobs 2 --corpus none --engine cpu --seed 9"
"$raydiff" fuzz $small --layout f32 --trials 64 --dir "$dir/closed" >&- 2>"$dir/err"
[ $? -eq 2 ] || bad "fuzz >&-: exit $?, not 2"
grep -q 'cannot write to the standard output' "$dir/err" || bad "fuzz >&-: does not say so"
grep -v '^{.*}$' "$dir/closed/findings.jsonl" >"$dir/out" && bad "fuzz >&-: the log holds what was printed"
# With the standard input closed as well, the log would be the second file opened.
"$raydiff" fuzz $small --layout f32 --trials 64 --dir "$dir/both" <&- >&- 2>"$dir/err"
[ $? -eq 2 ] || bad "fuzz <&- >&-: exit $?, not 2"
grep -v '^{.*}$' "$dir/both/findings.jsonl" >"$dir/out" && bad "fuzz <&- >&-: the log holds what was printed"
expect 0 . fuzz $small --layout f32 --trials 128 --dir "$dir/closed"
expect 0 . merge --to "$dir/closed.merged" "$dir/closed"
for command in "list" "--help" "check platonic --engine cpu --layout f32 --count 10 --repeat 1" \
    "scene list" "render -w 8 -h 8 --out $dir/x.png"; do
    # shellcheck disable=SC2086
    "$raydiff" $command >&- 2>"$dir/err"
    code=$?
    [ "$code" -eq 2 ] || bad "$command >&-: exit $code, not 2"
    "$raydiff" $command >"$dir/out" 2>&- <&-
    code=$?
    [ "$code" -eq 0 ] || bad "$command 2>&- <&-: exit $code, not 0"
done
"$raydiff" verify <&- >"$dir/out" 2>"$dir/err"
[ $? -eq 2 ] || bad "verify <&-: exit $?, not 2"

echo "standard_files: $failed failed"
[ "$failed" -eq 0 ]
