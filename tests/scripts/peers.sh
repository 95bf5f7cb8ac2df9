#!/bin/sh
# A peer that hangs ends with raydiff, whatever command it is and whatever signal ends that, and so do
# the 200 processes that the peer has started; no temporary file is left.
#   sh tests/scripts/peers.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh
cc -O1 -o "$dir/forks" tests/peers/peer_forks.c && cc -O1 -o "$dir/tracer" fuzz/samples/sample_tracer.c || exit 4
case $dir in /*) ;; *) dir=$(pwd)/$dir ;; esac
mkdir "$dir/tmp"
export TMPDIR="$dir/tmp"
trap 'kill -9 "${pid:-}" 2>/dev/null; rm -rf "$dir"' EXIT
worst=0

# Signal, the most seconds that it may take, arguments: ended by that signal, and nothing is left. A
# background process of a script ignores SIGINT unless it is set.
ended() {
    signal=$1
    shift
    : >"$dir/out"
    env --default-signal=INT,TERM,HUP "$raydiff" "$@" >"$dir/run" 2>"$dir/err" </dev/null &
    pid=$!
    # 200 processes, 50 of them with a child, beside raydiff, its guardian, and the shell.
    "$dir/forks" there 253 60 >"$dir/out" || bad "$signal $1: the peer does not start"
    kill "-$signal" "$pid"
    if ms=$("$dir/forks" gone 20); then
        [ "$ms" -le "$worst" ] || worst=$ms
        echo "passed  $signal $1: nothing is left after $ms ms"
    else
        echo "$ms" >"$dir/out"
        bad "$signal $1: processes are left after 20 s"
        kill -9 "$pid"
    fi
    wait "$pid"
    code=$?
    case $signal in INT) want=130 ;; TERM) want=143 ;; HUP) want=129 ;; KILL) want=137 ;; esac
    [ "$code" -eq "$want" ] || [ "$1" = fuzz ] || bad "$signal $1: exit $code, not $want"
    [ "$signal" = KILL ] || [ "$1" = fuzz ] || [ -z "$(find "$dir/tmp" "$dir/files" -mindepth 1)" ] ||
        bad "$signal $1: a file is left: $(find "$dir/tmp" "$dir/files" -mindepth 1)"
    rm -rf "$dir/files" "$dir"/tmp/*
    mkdir "$dir/files"
}
mkdir "$dir/files"

deaf="pipe:$dir/forks stay"
mute="pipe:dd bs=1 count=30000 status=none | $dir/tracer; $dir/forks stay" # answers some requests, and then none
for signal in INT TERM HUP KILL; do
    ended $signal check platonic --engine "$deaf" --peer-time 600
    ended $signal fuzz --engine "$mute" --corpus none --jobs 1 --dir "$dir/files/f"
done
for signal in TERM KILL; do
    ended $signal conform --engine "$deaf" --peer-time 600
    ended $signal leaks sphere:n=8 --engine "$deaf" --peer-time 600
    ended $signal report platonic --engine "$deaf" --peer-time 600 --out "$dir/files/x.html"
    ended $signal fuzz --engine "$deaf" --corpus none --jobs 1 --dir "$dir/files/f"
done

echo "peers: $failed failed; the longest took $worst ms"
[ "$failed" -eq 0 ]
