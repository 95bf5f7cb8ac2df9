#!/bin/sh
# Bugs that people reported, rebuilt as tracers (reported.txt): each is found by a check and explained, and the tracer
# that none of them spoils agrees: sh tests/reported/reported.sh PATH/raydiff [NAME]
set -u
. tests/guest/outsiders.sh
only=${2-}
strict='-std=c11 -O2 -Wall -Wextra -Werror -ffp-contract=off -shared -fPIC'
played=0 name=

# command line, exit code, what its output has in one line
play() {
    played=$((played + 1))
    case $1 in check*) more='--repeat 1' ;; *) more= ;; esac
    "$raydiff" $1 --engine "./$name.so" $more >out 2>err
    code=$?
    # Lines that were broken to fit are joined.
    awk '/^ / { sub(/^ +/, " "); line = line $0; next } NR > 1 { print line } { line = $0 } END { print line }' out >whole
    cat err >>whole
    [ "$code" -eq "$2" ] && grep -qE -- "$3" whole || { bad "$name: $1: exit $code, without '$3'"; tail -n 5 whole; }
    # The command that a check prints shows a WRONG answer, too.
    case $1,$code in *--steps*) return ;; check*,1) ;; *) return ;; esac
    shown=$(sed -n 's/^ *explain: raydiff //p' out | head -n 1)
    eval "\"\$raydiff\" ${shown:-explain}" >again 2>&1
    again=$?
    [ "$again" -eq 1 ] && grep -q '^conclusion: WRONG' again || bad "$name: $shown: exit $again"
}

while IFS= read -r line; do
    case $line in
    '#'* | '') ;;
    '  check '* | '  explain '*) command=${line#  } ;;
    '  '*)
        line=${line#  }
        [ -n "$only" ] && [ "$name" != "$only" ] || play "$command" "${line%% *}" "${line#* }"
        ;;
    *)
        name=$line
        [ -n "$only" ] && [ "$name" != "$only" ] || cc $strict "-I$root" -o "$name.so" "$root/tests/reported/$name.c" -lm || bad "$name is not compiled"
        listed="${listed-} $name.c"
        ;;
    esac
done <"$root/tests/reported/reported.txt"
for file in "$root"/tests/reported/*.c; do
    case " $listed " in *" ${file##*/} "*) ;; *) bad "${file##*/} is not in reported.txt" ;; esac
    case $(head -n 1 "$file") in '/* '*'#'[0-9]*:* | '/* '*'!'[0-9]*:* | '/* No report:'*) ;; *) bad "${file##*/} names no thread" ;; esac
done
echo "reported: $played runs, $failed failed"
[ "$failed" -eq 0 ]
