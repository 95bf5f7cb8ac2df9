#!/bin/sh
# The table of every field that commands print, tests/values/fields.*.txt. Its form is:
#
#   command NAME: what it is           NAME is that of the check, NAME.awk
#   PATH UNIT FORMAT where it comes from
#
# PATH: of the JSON, '*' for the places of an array and for names that are members of a table; '?' at its end: not in
# every run. 'text:NAME' is a field that only the text has. UNIT: see tests/values/fields.awk; '|null' where there
# can be none; float: a value, and the bits of its word. FORMAT: how the text has it, as printf does; '-' where it has not.
#
#   sh tests/values/fields.sh                         the table alone is well, and what is not is seen
#   sh tests/values/fields.sh NAME FLAT [SEEN [RAN]]  every path of FLAT (flat.awk) has a line, its value the unit;
#                                                     the lines are noted in SEEN; where a line begins with an option,
#                                                     --NAME or part N of its value, --NAME:N, the value is that which
#                                                     the words of RAN give to it, or of a list one
#   sh tests/values/fields.sh --unseen NAME SEEN      lines of NAME that are not in SEEN
set -u
tables=tests/values/fields.*.txt
case ${1-} in
--unseen) awk -v command="$2" -v unseen=1 -f tests/values/fields.awk $tables "$3" ;;
'') ;;
*) awk -v command="$1" -v seen="${3:-/dev/null}" -v ran="${4-}" -f tests/values/fields.awk $tables "$2" ;;
esac
code=$?
[ $# -eq 0 ] || exit "$code"

dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
cat >"$dir/table" <<END
command play: for these tests
  rows.*.count     count      %d    how many
  rows.*.ways?     count      -     --cache:2, of each
  rows.*.depth?    count      -     --depths; 0 of none
  rows.*.share     share|null %.1f  of how many
  rows.*.*_us      us         -     of a member
  rows.*.tree?     text       %s    not always
  rows.*.t?        float|null %s    as value and bits
END
# exit code, what is tried, the flat JSON's lines, the words of a command
try() {
    want=$1 what=$2 lines=$3
    printf '%b' "$lines" >"$dir/flat"
    awk -v command=play -v seen=/dev/null -v ran="${4-}" -f tests/values/fields.awk "$dir/table" "$dir/flat" >"$dir/out"
    [ $? -eq "$want" ] && return
    echo "FAILED  fields: $what"
    failed=$((failed + 1))
}
good='rows.count=1\nrows.0.count=3\nrows.0.share=null\nrows.0.cpu_us=0.5\n'
try 0 'every key has its line' "$good"
try 1 'a key has none' "${good}rows.0.other=1\n"
try 1 'a count is none' "${good}rows.1.count=2.5\n"
try 1 'a count is below 0' "${good}rows.1.count=-1\n"
try 1 'a share is over 1' "${good}rows.1.share=50.0\n"
try 1 'null for what there always is' "${good}rows.1.count=null\n"
try 1 'a time below 0' "${good}rows.1.cpu_us=-0.5\n"
try 0 'a float' "${good}rows.1.t.value=-1.5\nrows.1.t.bits=0xbfc00000\n"
try 1 'bits of a float in decimal' "${good}rows.1.t.value=-1.5\nrows.1.t.bits=3217031168\n"
try 1 'no key at all' ''
try 0 'a part of an option' "${good}rows.0.ways=2048\n" 'play --cache 8:2k:4'
try 1 'another part of it' "${good}rows.0.ways=4\n" 'play --cache=8:2k:4'
try 0 'members of a list, and none' "${good}rows.0.depth=2\nrows.1.depth=0\nrows.2.depth=1\n" 'play --depths 1,2'
try 1 'no member of a list' "${good}rows.0.depth=2\nrows.1.depth=3\nrows.2.depth=1\n" 'play --depths 1,2'
try 1 'a member of a list is not told' "${good}rows.0.depth=2\n" 'play --depths 1,2 --wide'
printf 'play rows.*.count\n' >"$dir/seen"
awk -v command=play -v unseen=1 -f tests/values/fields.awk "$dir/table" "$dir/seen" >"$dir/out"
[ $? -eq 1 ] && [ "$(wc -l <"$dir/out")" -eq 2 ] || { echo "FAILED  fields: lines that nothing prints"; failed=1; }
# The real table, one part of it missing.
awk -v command= -f tests/values/fields.awk $tables /dev/null || failed=1
sed 's/  %d  //' "$dir/table" >"$dir/short"
awk -v command= -f tests/values/fields.awk "$dir/short" /dev/null >"$dir/out" && { echo "FAILED  fields: a line is too short"; failed=1; }
echo "fields: $failed failed"
[ "$failed" -eq 0 ]
