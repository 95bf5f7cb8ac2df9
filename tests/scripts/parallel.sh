#!/bin/sh
# fuzz/recipes/parallel.sh: eight shards, one of which dies once, equal one run of the same trials.
#   sh tests/scripts/parallel.sh BUILD
# Exit 77 without GNU parallel.
set -u
build=$(cd "$1" && pwd)
command -v parallel >/dev/null || { echo "SKIPPED parallel-check: no GNU parallel"; exit 77; }
dir=$(mktemp -d "${TMPDIR:-/tmp}/raydiff-parallel-XXXXXX") || exit 4
trap 'rm -rf "$dir"' EXIT
. tests/scripts/shards.sh

sh fuzz/recipes/parallel.sh -n 8 -d "$dir/shards" -x "$dir/raydiff" $options >"$dir/log" 2>&1
code=$?
[ "$code" -eq 1 ] || { bad "the recipe has findings (exit $code)"; cat "$dir/log"; }
awk '$1 == 3 && $7 == 0' "$dir/shards/parallel.log" | grep -q . || bad "the shard was played on"
compare

# Again: nothing is left to do, and the answer is the same.
sh fuzz/recipes/parallel.sh -n 8 -d "$dir/shards" -x "$dir/raydiff" $options >"$dir/log" 2>&1
[ $? -eq 1 ] || bad "the recipe a second time"

# A shard that is lost for good is told.
printf '#!/bin/sh\ncase $3 in 2/3) kill -9 $$ ;; esac\nexec %s "$@"\n' "$build/raydiff" >"$dir/dying"
chmod +x "$dir/dying"
sh fuzz/recipes/parallel.sh -n 3 -r 1 -d "$dir/lost" -x "$dir/dying" --trials 200 --engine cpu \
    --no-shrink >"$dir/log" 2>&1
code=$?
[ "$code" -eq 3 ] || bad "a lost shard: exit $code"
grep -q 'not played to their end: shards 2 of 3' "$dir/log" || bad "a lost shard is named"
[ -e "$dir/lost/merged" ] && bad "nothing is joined without it"
sh fuzz/recipes/parallel.sh --engine cpu >"$dir/log" 2>&1
[ $? -eq 2 ] || bad "--trials is needed"
[ "$failed" -eq 0 ] && echo "parallel-check: 8 shards, one killed once, are one run"
exit "$failed"
