#!/bin/sh
# Runs one suite for tests/run.sh and prints its line at its end, with the log's end if it failed:
#   sh tests/run_suite.sh LOGS 'NAME COMMAND...'    the words of a line of the shell
# LOGS/NAME.log: what it printed; LOGS/NAME.word: passed (exit code 0), skipped (77) or FAILED;
# LOGS/NAME.time: the processor time of it and of what it waited for, of user and system, as `times` prints it.
set -u
logs=$1
eval "set -- $2"
name=$1
shift
start=$(date +%s)
"$@" >"$logs/$name.log" 2>&1 </dev/null
code=$?
took=$(($(date +%s) - start))
times >"$logs/$name.time"
# CMocka's own count of skipped tests, with the line each printed before it.
inner=$(grep -c '^\[  SKIPPED \] [a-z_0-9]*$' "$logs/$name.log")
case $code in
0) word=passed ;;
77) word=skipped ;;
*) word=FAILED ;;
esac
said=$(
    printf '%-8s %-22s %3d s' "$word" "$name" "$took"
    [ "$inner" -eq 0 ] || printf '  (%d inside skipped)' "$inner"
    echo
    case $word in
    FAILED)
        echo "--- exit code $code; last lines of $logs/$name.log"
        tail -n 40 "$logs/$name.log"
        echo "---"
        ;;
    skipped) tail -n 1 "$logs/$name.log" ;;
    *) grep -h '^SKIP' "$logs/$name.log" | sort | uniq -c | sed 's/^ */    /' | head -n 8 ;;
    esac
)
echo "$said"
echo "$word" >"$logs/$name.word"
