#!/bin/sh
# A campaign in shards as a Slurm job array, in a folder that all nodes see:
#   slurm.sh [-n SHARDS] [-j CPUS] [-r RETRIES] [-d DIR] [-x RAYDIFF] --trials N OPTION...
#     -n  shards: tasks of the array                              [8]
#     -j  processors, and so worker processes, of a task          [1]
#     -r  times that lost shards are submitted again              [3]
#     -d  the folder; DIR/merged is the result                    [findings-shards]
#     -x  the program, at the same path on all nodes              [raydiff]
# Other options are those of `raydiff fuzz`; partition, account and time come from the environment
# (SBATCH_PARTITION, SBATCH_ACCOUNT, SBATCH_TIMELIMIT). Run it again to go on after an interruption.
# Exit code as of `raydiff fuzz`; 3: shards were lost for good.
set -u
name=slurm.sh
here=$(cd "$(dirname "$0")" && pwd)
. "$here/shards.sh"
take_options "$@"
command -v sbatch >/dev/null || { echo "$name: needs Slurm (sbatch)" >&2; exit 77; }
[ "$jobs" -gt 0 ] || { echo "$name: -j is at least 1" >&2; exit 2; }
{
    echo '#!/bin/sh'
    echo "exec sh $(quoted "$here/shard.sh") \"\$SLURM_ARRAY_TASK_ID\" $n $(quoted "$dir") \\"
    echo "    $(quoted "$raydiff") --jobs $jobs$rest"
} >"$dir/task.sh"
round=0
while lost=$(lost_shards) && [ -n "$lost" ] && [ "$round" -le "$retries" ]; do
    [ "$round" -eq 0 ] || echo "$name: shards $lost again"
    # Its exit code is the worst task's; which are lost is seen by what they left.
    sbatch --wait --quiet --job-name=raydiff --array="$(echo "$lost" | tr ' ' ,)" --ntasks=1 \
        --cpus-per-task="$jobs" --output="$dir/slurm-%a.log" --open-mode=append "$dir/task.sh"
    round=$((round + 1))
done
join_shards
