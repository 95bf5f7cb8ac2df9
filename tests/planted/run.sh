#!/bin/sh
# Planted bugs (tests/planted/plant.sh): each line `caught` compiles one into a C unit or a shader, under
# BUILD/mutants/suite, and something of the suite must turn red. The same command is run without the
# bug, too, and must be green, so that a broken catcher cannot pass for a catch.
#   make mutants [ONLY='PATTERN...']    the patterns as words of the shell
#   CC_CMD=... LIBS=... TOOL_SRC=... sh tests/planted/run.sh BUILD [PATTERN...]
# PATTERN: an extended regular expression; lines that match one are played. Exit 2: one matches none.
# PART=N: one line in N is played; which ones depends on the sources, so that another tree plays others.
set -u
build=$1
shift
export CC_CMD LIBS TOOL_SRC
out=$build/mutants/suite
rm -rf "$out"
mkdir -p "$out/healthy"
list=$out/list
sh tests/planted/plant.sh --check >/dev/null && sh tests/planted/plant.sh --list >"$list" || exit 2

# Numbers of the lines to play.
entries() { grep -nE '^[a-z]' "$list"; }
if [ $# -eq 0 ]; then
    entries
else
    for pattern in "$@"; do
        entries | grep -E -- "^[0-9]+:.*($pattern)" || { echo "no planted bug matches '$pattern'" >&2; exit 2; }
    done | sort -nu
fi >"$out/chosen" || exit 2
sed -i 's/:.*//' "$out/chosen"
case ${PART:-1} in
1) ;;
*[!0-9]* | 0*) echo "planted bugs: PART=$PART is not a number from 1 on" >&2 && exit 2 ;;
*)
    turn=$(cat ref/*/*.c ref/*/*/*.c gpu/*/*.c fuzz/*/*.c cmd/*/*.c tests/*/*.c | cksum)
    awk -v turn="${turn%% *}" -v part="$PART" '(NR + turn) % part == 0' "$out/chosen" >"$out/part"
    mv "$out/part" "$out/chosen"
    echo "one planted bug in $PART (make mutants: all)"
    ;;
esac
[ -s "$out/chosen" ] || exit 2

sh tests/planted/scenes.sh "$out" || exit 4
$CC_CMD -shared -fPIC -o "$out/cmocka_only.so" tests/planted/cmocka_only.c || exit 4

# As many at a time as there are processors (of which nproc counts OMP_NUM_THREADS at most), each with
# one thread; told in the order of the list.
jobs=$(env -u OMP_NUM_THREADS nproc)
export OMP_NUM_THREADS="${OMP_NUM_THREADS:-1}"
xargs -P "$jobs" -n 1 sh tests/planted/play.sh "$build" "$list" <"$out/chosen" &
player=$!
trap 'kill "$player"; exit 130' INT TERM
for number in $(cat "$out/chosen"); do
    while [ ! -e "$out/told.$number" ]; do
        if ! kill -0 "$player" 2>/dev/null && [ ! -e "$out/told.$number" ]; then
            echo "BROKEN  line $number: it was not played to its end" >"$out/told.$number"
        else
            sleep 0.05
        fi
    done
    cat "$out/told.$number"
done | tee "$out/log"

count() { grep -c "^$1 " "$out/log"; }
echo "$(count caught) planted bugs caught, $(count MISSED) missed, $(count BROKEN) broken, $(count SKIP) skipped"
[ "$(count caught)" -gt 0 ] && [ "$(($(count caught) + $(count SKIP)))" -eq "$(wc -l <"$out/chosen")" ]
