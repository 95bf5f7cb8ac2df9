#!/bin/sh
# Plays shard I of N of a campaign, from where it was if it was interrupted:
#   shard.sh I N DIR RAYDIFF OPTION...
# DIR/shard-I is its folder of findings, DIR/shard-I.log what it said; DIR/shard-I.code has the exit
# code of `raydiff fuzz` and appears when the shard was played to its end. Exit 0 then, whatever was
# found, so that a scheduler tells a lost shard from one with findings; else the code.
set -u
i=$1 n=$2 dir=$3 raydiff=$4
shift 4
shard=$dir/shard-$i
[ -e "$shard.code" ] && exit 0
"$raydiff" fuzz --shard "$i/$n" --dir "$shard" "$@" >>"$shard.log" 2>&1
code=$?
if [ "$code" -gt 1 ]; then
    echo "shard $i of $n: exit $code: $(tail -n 1 "$shard.log")" >&2
    exit "$code"
fi
echo "$code" >"$shard.code.tmp" && mv "$shard.code.tmp" "$shard.code"
