#!/bin/sh
# No honest answer is refused: runs suites slowly and adds up what they print as `honest: FORMULA: N
# REFUSED SECONDS` to a line a formula. Exit code 1: an answer was refused, a suite failed, or a formula
# had fewer than 10^6 evaluations.
#   sh tests/scripts/honest.sh SUITE...
set -u
least=1000000
[ $# -gt 0 ] || { echo "sh tests/scripts/honest.sh SUITE..." >&2; exit 2; }
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
printf '%-24s %12s %8s %8s\n' formula evaluations refused seconds
for suite in "$@"; do
    RAYDIFF_SLOW=1 "$suite" >"$dir/log" 2>&1
    code=$?
    echo "# $(basename "$suite")"
    awk -v least="$least" '
        /^honest: / {
            split($0, part, ": ")
            if (!(part[2] in count)) order[++all] = part[2]
            split(part[3], number, " ")
            count[part[2]] += number[1]; refused[part[2]] += number[2]; took[part[2]] += number[3]
        }
        END {
            for (i = 1; i <= all; i++) {
                name = order[i]
                printf "%-24s %12d %8d %8.1f\n", name, count[name], refused[name], took[name]
                if (refused[name] || count[name] < least) bad = 1
                if (count[name] < least) printf "%s: fewer than %d evaluations\n", name, least
            }
            if (!all) print "nothing was evaluated"
            exit bad || !all
        }' "$dir/log" || failed=1
    if [ "$code" -ne 0 ]; then
        echo "$(basename "$suite") failed, exit code $code"
        grep -e 'WRONG' -e 'possible$' -e 'FAILED' -e 'error: ' "$dir/log" | head -n 20
        failed=1
    fi
done
exit "$failed"
