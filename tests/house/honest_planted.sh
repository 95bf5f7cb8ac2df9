#!/bin/sh
# tests/scripts/honest.sh must see an answer that was refused, too few evaluations, none, and a suite that fails.
set -u
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0

# said WANTED CODE LINE...: a suite that prints the lines and ends with the code.
said() {
    wanted=$1 code=$2
    shift 2
    { echo '#!/bin/sh'; printf 'echo "%s"\n' "$@"; echo "exit $code"; } >"$dir/suite"
    chmod +x "$dir/suite"
    sh tests/scripts/honest.sh "$dir/suite" >"$dir/log"
    got=$?
    [ "$got" -eq "$wanted" ] || { echo "MISSED  $*: $got, not $wanted"; cat "$dir/log"; failed=1; }
}

said 0 0 'honest: mt: 600000 0 1.25' 'honest: mt: 400000 0 2.5' 'honest: mt fast: 1000000 0 1'
grep -q '^mt  *1000000  *0  *3.8$' "$dir/log" || { cat "$dir/log"; failed=1; }
said 1 0 'honest: mt: 1000000 1 1'
said 1 0 'honest: mt: 1000000 0 1' 'honest: woop: 1000000 0 1' 'honest: mt: 5 5 1'
said 1 0 'honest: mt: 999999 0 1' 'honest: woop: 1000000 0 1'
said 1 1 'honest: mt: 1000000 0 1'
said 1 0 'nothing'
[ "$failed" -eq 0 ] && echo "honest: every planted error caught"
exit "$failed"
