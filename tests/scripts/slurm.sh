#!/bin/sh
# fuzz/recipes/slurm.sh on a Slurm of our own: controller and node on this machine, in a temporary
# folder, beside any other. Eight shards, one of which dies once, equal one run of the same trials.
#   sh tests/scripts/slurm.sh BUILD
# Exit 77 without Slurm or where it cannot be started.
set -u
PATH=$PATH:/usr/sbin:/sbin
build=$(cd "$1" && pwd)
skip() {
    echo "SKIPPED slurm-check: $1"
    exit 77
}
for program in munged slurmctld slurmd sbatch squeue; do
    command -v $program >/dev/null || skip "no $program (Debian packages slurm-wlm and munge)"
done
dir=$(mktemp -d "${TMPDIR:-/tmp}/raydiff-slurm-XXXXXX") || exit 4
chmod 755 "$dir" # munged wants its socket to be reachable
started=
stop() {
    # Ours alone: without our configuration it would be another Slurm's jobs.
    [ "${SLURM_CONF:-}" = "$dir/slurm.conf" ] && scancel --quiet --user="$(id -un)" 2>/dev/null
    for pid in $started; do
        kill "$pid" 2>/dev/null
    done
    wait
    rm -rf "$dir"
}
trap stop EXIT
trap 'exit 130' INT TERM
. tests/scripts/shards.sh

# A port that is free: /proc/net/tcp has those in use, in hexadecimal.
free_port() {
    port=$((20000 + ($$ + $1 * 97) % 10000))
    while grep -qi ":$(printf '%04X' "$port") " /proc/net/tcp /proc/net/tcp6 2>/dev/null; do
        port=$((port + 1))
    done
    echo "$port"
}

start_munge() {
    mkdir -p "$dir/munge"
    head -c 128 /dev/urandom >"$dir/munge/key" && chmod 400 "$dir/munge/key"
    munged --foreground --num-threads=2 --key-file="$dir/munge/key" --socket="$dir/munge/socket" \
        --pid-file="$dir/munge/pid" --log-file="$dir/munge/log" --seed-file="$dir/munge/seed" \
        >"$dir/munge/out" 2>&1 &
    started="$started $!"
    wait_for "munged" test -S "$dir/munge/socket"
}

# what, command...: until it succeeds, for half a minute.
wait_for() {
    what=$1 tries=0
    shift
    until "$@" >/dev/null 2>&1; do
        tries=$((tries + 1))
        if [ "$tries" -gt 150 ]; then
            tail -n 5 "$dir"/*.log "$dir"/munge/* 2>/dev/null >&2
            skip "$what does not start (above)"
        fi
        sleep 0.2
    done
}

is_idle() { sinfo --noheader --format=%T | grep -q '^idle'; }

start_slurm() {
    host=$(hostname -s) user=$(id -un)
    mkdir -p "$dir/state" "$dir/spool"
    export SLURM_CONF="$dir/slurm.conf"
    cat >"$SLURM_CONF" <<END
ClusterName=raydiff
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port 1)
SlurmdPort=$(free_port 2)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$dir/munge/socket
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
    slurmctld -D >"$dir/slurmctld.out" 2>&1 &
    started="$! $started"
    slurmd -D >"$dir/slurmd.out" 2>&1 &
    started="$! $started"
    wait_for "Slurm" is_idle
}

start_munge
start_slurm
sh fuzz/recipes/slurm.sh -n 8 -d "$dir/shards" -x "$dir/raydiff" $options >"$dir/log" 2>&1
code=$?
[ "$code" -eq 1 ] || { bad "the recipe has findings (exit $code)"; cat "$dir/log"; }
grep -q '^slurm.sh: shards 3 again' "$dir/log" || bad "the lost shard was submitted again"
compare
[ "$failed" -eq 0 ] && echo "slurm-check: 8 tasks of an array, one killed once, are one run"
exit "$failed"
