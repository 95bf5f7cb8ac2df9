#!/bin/sh
# A campaign in shards with GNU parallel, on this machine or on several that share a folder:
#   parallel.sh [-n SHARDS] [-j JOBS] [-r RETRIES] [-d DIR] [-x RAYDIFF] [-S MACHINES] --trials N OPTION...
#     -n  shards, more than there are cores                       [8]
#     -j  shards at a time on each machine, 0: as many as cores   [0]
#     -r  times that a lost shard is played on                    [3]
#     -d  folder that all machines see; DIR/merged is the result  [findings-shards]
#     -x  the program, at the same path everywhere                [raydiff]
#     -S  as parallel's: host,user@host,... and : for this one    [:]
# Other options are those of `raydiff fuzz`. Run it again to go on after an interruption. Exit code as
# of `raydiff fuzz`; 3: shards were lost for good.
set -u
name=parallel.sh
here=$(cd "$(dirname "$0")" && pwd)
. "$here/shards.sh"
jobs=0 machines=:
take_options "$@"
command -v parallel >/dev/null || { echo "$name: needs GNU parallel" >&2; exit 77; }
[ "$jobs" -gt 0 ] || jobs=100%
# -q: words stay words. A worker process a shard, since shards run beside each other.
set -- "$n" "$dir" "$raydiff" --jobs 1
eval "set -- \"\$@\" $rest"
seq "$n" | parallel -q --jobs "$jobs" --retries $((retries + 1)) --sshlogin "$machines" \
    --joblog "$dir/parallel.log" sh "$here/shard.sh" {} "$@"
join_shards
