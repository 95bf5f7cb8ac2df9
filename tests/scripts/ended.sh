#!/bin/sh
# One signal ends commands that draw and measure, also while an engine does not answer.
#   sh tests/scripts/ended.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh
cc -O1 -o "$dir/tracer" fuzz/samples/sample_tracer.c || exit 4
case $dir in /*) ;; *) dir=$(pwd)/$dir ;; esac
mkdir "$dir/tmp" "$dir/files"
export TMPDIR="$dir/tmp"
trap 'kill -9 "${pid:-}" 2>/dev/null; rm -rf "$dir"' EXIT
cat >"$dir/mute" <<END # answers some requests; when one comes that it does not, the file is there
#!/bin/sh
dd bs=1 count=\$1 status=none | $dir/tracer
: >$dir/hangs
exec sleep 1000
END
chmod +x "$dir/mute"
worst=0

# Signal, arguments: ended by it. A background process of a script ignores SIGINT unless it is set.
ended() {
    signal=$1 waits=0
    shift
    rm -f "$dir/hangs"
    env --default-signal=INT,TERM,HUP "$raydiff" "$@" >"$dir/out" 2>"$dir/err" </dev/null &
    pid=$!
    while [ ! -e "$dir/hangs" ] && [ "$waits" -lt 600 ]; do
        sleep 0.05
        waits=$((waits + 1))
    done
    [ -e "$dir/hangs" ] || bad "$signal $1: the engine does not come to hang"
    start=$(date +%s%N)
    kill "-$signal" "$pid"
    (sleep 10; kill -9 "$pid") 2>/dev/null &
    killer=$!
    wait "$pid"
    code=$?
    ms=$((($(date +%s%N) - start) / 1000000))
    kill "$killer" 2>/dev/null
    case $signal in INT) want=130 ;; TERM) want=143 ;; HUP) want=129 ;; esac
    [ "$code" -eq "$want" ] || bad "$signal $1: exit $code after $ms ms, not $want"
    [ -z "$(find "$dir/tmp" "$dir/files" -mindepth 1)" ] ||
        bad "$signal $1: a file is left: $(find "$dir/tmp" "$dir/files" -mindepth 1)"
    rm -rf "$dir/files" "$dir"/tmp/*
    mkdir "$dir/files"
    [ "$ms" -le "$worst" ] || worst=$ms
    [ "$failed" -eq 0 ] || exit 1
    echo "passed  $signal $1: $ms ms"
}

# A campaign lets its workers end what they play for half a second after the first signal, and not after a second one.
twice() { # how many signals
    rm -rf "$dir/hangs" "$dir/twice"
    env --default-signal=INT "$raydiff" fuzz --engine "$mute" --rays 20 --jobs 1 --corpus none --trial-time 600 --dir "$dir/twice" \
        >"$dir/out" 2>"$dir/err" </dev/null &
    pid=$!
    waits=0
    while [ ! -e "$dir/hangs" ] && [ "$waits" -lt 600 ]; do
        sleep 0.05
        waits=$((waits + 1))
    done
    [ -e "$dir/hangs" ] || bad "fuzz: the engine does not come to hang"
    start=$(date +%s%N)
    kill -INT "$pid"
    [ "$1" -eq 1 ] || { sleep 0.05; kill -INT "$pid"; }
    wait "$pid"
    took=$((($(date +%s%N) - start) / 1000000))
}

mute="pipe:$dir/mute 30000"
twice 1
[ "$took" -ge 500 ] || bad "fuzz ends $took ms after the first signal"
least=$took
for try in 1 2 3 4 5; do
    [ "$least" -lt 450 ] || twice 2
    [ "$took" -ge "$least" ] || least=$took
done
[ "$least" -lt 450 ] || bad "fuzz ends no sooner than $least ms after two signals"
echo "passed  INT twice: $least ms"

for signal in INT TERM HUP; do
    ended $signal render --engine "$mute" -w 64 -h 48 --peer-time 600 --out "$dir/files/x.png" --json "$dir/files/x.json"
done
ended TERM check platonic --engine "$mute" --peer-time 600 --json "$dir/files/x.json"
ended TERM diff --engine "cpu,$mute" -w 64 -h 48 --peer-time 600
ended TERM bench error --scene sphere:n=8 --engine "$mute" --peer-time 600 --count 5000 --rounds 1
ended TERM render --window --engine "$mute" -w 64 -h 48 --peer-time 600 --out "$dir/files/x.png" --log "$dir/files/x.log"
ended TERM report platonic --engine "$mute" --peer-time 600 --out "$dir/files/x.html"

echo "ended: $failed failed; the longest took $worst ms"
[ "$failed" -eq 0 ]
