#!/bin/sh
# No script that plays the program passes, or is skipped, with one that does nothing but end, whatever its exit
# code, or is killed:
#   sh tests/house/stubs.sh BUILD [all]
# The scripts are those of make check, played with exit codes 0 and 77; with "all" with every code, and with them those
# that wait long for a program that does nothing, or compile much.
set -u
build=$1 all=${2-}
work=$(mktemp -d) || exit 4
trap 'rm -rf "$work"' EXIT
slow='render ci_outputs plugin guest reported told'

# A build whose program is a stub, and so is all else that scripts run of it.
for end in 0 1 2 3 4 77 killed; do
    mkdir -p "$work/$end"
    case $end in
    killed) echo 'kill -SEGV $$' ;;
    *) echo "exit $end" ;;
    esac | sed '1i #!/bin/sh' >"$work/$end/raydiff"
    chmod +x "$work/$end/raydiff"
done

sh tests/mutation/suites.sh STUB | grep -v '^test_' | while read -r name command; do
    [ -n "$all" ] || ! echo " $slow " | grep -q " $name " || continue
    for end in $([ -n "$all" ] && echo 1 2 3 4 killed) 0 77; do
        printf "'%s' '%s' '%s'\n" "$name" "$end" "$(echo "$command" | sed "s|STUB|$work/$end|g")"
    done
done >"$work/plays"

cat >"$work/play.sh" <<'PLAY'
eval "set -- $1"
work=$WORK logs=$WORK/$1.$2
mkdir -p "$logs"
(eval "timeout 120 $3") >"$logs/log" 2>&1 </dev/null
code=$?
case $code in
0 | 77) echo "MISSED  $1: exit $code with a program that ends with $2" ;;
*) echo "red     $1: $2" ;;
esac
PLAY
WORK=$work xargs -d '\n' -P "$(nproc)" -n 1 sh "$work/play.sh" <"$work/plays" >"$work/said"
grep '^MISSED' "$work/said"
count=$(wc -l <"$work/plays")
echo "stubs: $(grep -c '^red' "$work/said") of $count plays are red"
[ "$count" -ge 45 ] && [ "$(grep -c '^red' "$work/said")" -eq "$count" ]
