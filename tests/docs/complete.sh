#!/bin/sh
# Pages that must have all of something have all of it:
#   sh tests/docs/complete.sh RAYDIFF
set -u
raydiff=$1
failed=0
# page, what a line of it must match with NAME in its place, names on the standard input
each() {
    count=0
    while read -r name; do
        count=$((count + 1))
        grep -qE "$(echo "$2" | sed "s|NAME|$name|g")" "$1" || { echo "FAILED  $1 lacks $name"; failed=1; }
    done
    [ "$count" -ge "$3" ] || { echo "FAILED  $1: only $count names"; failed=1; }
    echo "$1: $count names"
}
members() { "$raydiff" list "$1" | sed -n 's/^  \([a-z][a-z0-9_]*\).*/\1/p'; }
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
sed -n 's/^    \[CAUSE_[A-Z_]*\] = {"\([a-z_]*\)".*/\1/p' ref/explain/repair.c | grep -v '^none$' >"$dir/causes"
members builders >"$dir/builders"
members storages >"$dir/storages"
members 'box tests' >"$dir/boxes"
members 'triangle tests' >"$dir/tris"
"$raydiff" help | sed -n 's/^   *\([a-z]*\)   .*/\1/p' | sort -u >"$dir/commands"
each docs/causes.md '^\| `NAME` \|' 38 <"$dir/causes"
each docs/builders.md '`NAME`' 7 <"$dir/builders"
each docs/layouts.md '`NAME`' 6 <"$dir/storages"
each docs/traversal.md '`NAME`' 3 <"$dir/boxes"
each docs/traversal.md '`NAME`' 5 <"$dir/tris"
each docs/commands.md '`raydiff NAME|`NAME`' 20 <"$dir/commands"
seq 39 | sed 's/^/F/' >"$dir/faults"
each docs/rtrs-faults.md '^\| NAME \|' 39 <"$dir/faults"
# Each cause stands in the table once, and no other does.
sort "$dir/causes" >"$dir/sorted"
sed -n '/^## All causes/,$s/^| `\([a-z_]*\)` |.*/\1/p' docs/causes.md | sort | diff "$dir/sorted" - || { echo 'FAILED  docs/causes.md has other causes'; failed=1; }
exit "$failed"
