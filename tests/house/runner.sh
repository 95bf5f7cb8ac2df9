#!/bin/sh
# tests/run.sh on made-up suites: one that fails, or that is not played to its end, fails the run, and each
# is counted once.
#   sh tests/house/runner.sh
set -u
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
mkdir "$dir/tests"
failed=0
bad() {
    echo "FAILED  $1"
    cat "$dir/out"
    failed=1
}
made_up() { # NAME SCRIPT
    printf '#!/bin/sh\n%s\n' "$2" >"$dir/tests/test_$1"
    chmod +x "$dir/tests/test_$1"
}
# expect CODE 'SUM'
# What an earlier run left behind does not write into the output of the next.
expect() {
    rm -f "$dir/out"
    sh tests/run.sh "$dir" made_up >"$dir/out" 2>&1
    got=$?
    [ "$got" -eq "$1" ] || bad "exit code $got, not $1"
    [ "$(tail -n 1 "$dir/out")" = "$2" ] || bad "the sum is not '$2'"
}

made_up good 'echo fine'
made_up pipe 'exit 0'
made_up absent 'echo "SKIP nothing to do"; exit 77'
expect 0 '2 passed, 0 failed, 1 skipped'
grep -q '^passed   test_pipe' "$dir/out" || bad 'a suite that runs alone is not played'
made_up good '[ "$MALLOC_CHECK_" = 3 ]' # tests/heap.sh
made_up vulkan '[ -z "${MALLOC_CHECK_:-}" ]'
expect 0 '3 passed, 0 failed, 1 skipped'
rm "$dir/tests/test_vulkan"
# What a suite computes counts in its processor time, what it sleeps does not.
made_up good 'i=0; while [ $i -lt 300000 ]; do i=$((i + 1)); done'
made_up pipe 'sleep 1'
expect 0 '2 passed, 0 failed, 1 skipped'
centiseconds() { tail -n 1 "$dir/check/$1.time" | awk -F'[ms ]+' '{ printf "%d", 100 * (60 * ($1 + $3) + $2 + $4) }'; }
[ "$(centiseconds test_good)" -ge 3 ] && [ "$(centiseconds test_pipe)" -lt 50 ] || bad 'processor times'
made_up pipe 'exit 0'
made_up fuzz_campaign_deaths 'sleep 2; [ "${OMP_WAIT_POLICY-}" = passive ]' # beside the others, which end before
made_up good 'exit 0'
expect 0 '3 passed, 0 failed, 1 skipped'
[ "$(grep -n 'test_fuzz_campaign_deaths' "$dir/out" | cut -d: -f1)" -gt "$(grep -n test_good "$dir/out" | cut -d: -f1)" ] ||
    bad 'a suite that waits holds up others'
made_up fuzz_campaign_deaths 'exit 5'
expect 1 '2 passed, 1 failed, 1 skipped'
rm "$dir/tests/test_fuzz_campaign_deaths"
made_up good '[ "$MALLOC_CHECK_" = 3 ]'
made_up wrong 'echo "here it is wrong"; exit 1'
expect 1 '2 passed, 1 failed, 1 skipped'
grep -q 'here it is wrong' "$dir/out" || bad 'the log of what failed is not shown'
# The others have ended before it kills the shell that plays it.
made_up wrong 'sleep 1; kill -9 $PPID; sleep 0.2'
expect 1 '2 passed, 1 failed, 1 skipped'
grep -q '^FAILED   1 suites were not played to their end' "$dir/out" || bad 'a killed suite is not missed'
rm "$dir/tests/test_wrong"
made_up pipe 'exit 3'
expect 1 '1 passed, 1 failed, 1 skipped'
# Ten failures of a program end a suite, red: what is left is not played.
for with in tests/scripts/expect.sh tests/values/compare.sh; do
    for count in 1 9 10 12; do
        (. "$with"; : >"$dir/out" >"$dir/err"; for i in $(seq "$count"); do bad "it is"; done; exit "$((failed + 10))") >"$dir/ten"
        ended=$?
        [ "$count" -lt 10 ] && wanted=$((count + 10)) || wanted=1
        [ "$ended" -eq "$wanted" ] && [ "$(grep -c '^FAILED  it is$' "$dir/ten")" -eq "$((count < 10 ? count : 10))" ] ||
            bad "$with: $count failures end with $ended"
    done
done

[ "$failed" -eq 0 ] && echo 'runner: each suite counts'
exit "$failed"
