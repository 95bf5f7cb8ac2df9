#!/bin/sh
# The conformance suite, or its hard cases, and that what it prints and writes is as much as it should be:
#   sh tests/conform/conform.sh RAYDIFF JUNIT LEAST [ARGUMENTS OF CONFORM...]
# LEAST: so many trials must pass. --fewest: with the fewest rays a trial that are enough, as the help says.
set -u
raydiff=$1 junit=$2 least=$3
shift 3
if [ "${1-}" = --fewest ]; then
    shift
    fewest=$("$raydiff" conform --help | tr -s ' \n' ' ' | sed -n 's/.*rays per trial; below \([0-9]*\) some.*/\1/p')
    [ "${fewest:-0}" -gt 0 ] || { echo "conform: the help names no fewest rays"; exit 1; }
    set -- "$@" --count "$fewest"
fi
rm -f "$junit"
log=$(mktemp) || exit 4
trap 'rm -f "$log"' EXIT
"$raydiff" conform --junit "$junit" "$@" >"$log" 2>&1
code=$?
cat "$log"
[ "$code" -eq 0 ] || { [ "$code" -eq 77 ] && code=1; exit "$code"; }
sum=$(tail -n 1 "$log" | sed -nE 's/^([0-9]+) passed, 0 failed, ([0-9]+) skipped$/\1 \2/p')
passed=${sum% *} skipped=${sum#* }
[ -n "$sum" ] && [ "$passed" -ge "$least" ] || { echo "conform: not $least passed, and 0 failed"; exit 1; }
ran=$(sed -nE 's/^([0-9]+) trials in [0-9.]+ s(, ([0-9]+) waived)?.*$/\1 \3/p' "$log")
trials=${ran% *} waived=${ran#* }
[ "$trials" = $((passed + skipped + ${waived:-0})) ] ||
    { echo "conform: $passed passed, $skipped skipped and ${waived:-0} waived are not $trials trials"; exit 1; }
# What is waived was not judged: it counts as skipped in JUnit. Of members that are named each is a case, too.
named=0
for table in engine box; do
    case " $* " in *" --$table "*) named=$((named + $(grep -c "^$table .* answered " "$log"))) ;; esac
done
cases=$((trials + named))
skipped=$((skipped + ${waived:-0}))
grep -q "^<testsuite .*tests=\"$cases\" failures=\"0\" errors=\"0\" skipped=\"$skipped\"" "$junit" ||
    { echo "conform: $junit has other counts"; exit 1; }
[ "$(grep -c '<testcase ' "$junit")" -eq "$cases" ] && [ "$(grep -c '<skipped' "$junit")" -eq "$skipped" ] ||
    { echo "conform: $junit has other cases"; exit 1; }
