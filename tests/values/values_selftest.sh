#!/bin/sh
# The numbers of `raydiff fuzz --self-test` by value, of programs with bugs that are found, not found, skipped and failed:
# rows and sums of the text against the JSON, sums against the rows, the table, and what each program did.
#   sh tests/values/values_selftest.sh RAYDIFF
set -u
raydiff=$(realpath "$1")
. tests/values/compare.sh
programs=$dir/programs

# BUG, what the program does with its arguments
program() {
    mkdir -p "$programs/$1.$2"
    printf '#!/bin/sh\n%s\n' "$3" >"$programs/$1.$2/raydiff"
    chmod 755 "$programs/$1.$2/raydiff"
}
mkdir "$programs"
lossy="for word in \"\$@\"; do shift; [ \"\$word\" = f32 ] && set -- \"\$@\" rtrs_rf --faithful || set -- \"\$@\" \"\$word\"; done; exec '$raydiff' \"\$@\""
program QUICK one "$lossy"
program SLOW two "sleep 1; $lossy"
program KEPT three "exec '$raydiff' \"\$@\""
program ABSENT four 'echo no card is here; exit 77'
program ENDS five 'echo the first line; echo the last line; exit 9'
cat >"$programs/selftest.txt" <<'END'
QUICK   ref/some/one.c    cpu        f32   rounding
SLOW    ref/some/two.c    cpu        f32   padding
KEPT    ref/some/three.c  cpu        rf16  comparison
ABSENT  ref/some/four.c   cpu,brute  f32   order
ENDS    ref/some/five.c   cpu        half4 numbers
END
least=96
# Columns of the text as JSON has them, row by row.
selftest() { # exit code, sums of found and planted, clean, skipped; options
    wanted=$1 found=$2 planted=$3 skipped=$4
    shift 4
    ran="raydiff fuzz --self-test $*"
    "$raydiff" fuzz --self-test --programs "$programs" --time 2 --control $least --json "$dir/json" "$@" >"$dir/text" 2>"$dir/err"
    code=$?
    [ "$code" -eq "$wanted" ] || { bad "$ran: exit $code, not $wanted"; tail -n 2 "$dir/err"; }
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    awk -v found="$found" -v planted="$planted" -v skipped="$skipped" -v wanted="$wanted" -v least=$least -f tests/values/lib.awk \
        -f tests/values/findings/selftest.awk "$dir/flat" "$programs/selftest.txt" "$dir/text" || bad "$ran"
}
selftest 1 2 4 1
selftest 0 2 2 0 --only QUICK,SLOW --seed 9
selftest 1 0 1 0 --only comparison
selftest 0 0 0 1 --only ABSENT
# What is found is the finding of the lowest trial that the folder has.
"$raydiff" fuzz --self-test --programs "$programs" --time 2 --control 1 --only QUICK --json "$dir/json" >"$dir/text" 2>"$dir/err"
awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
awk '/^expect / { name = $2 } /^origin / { print $5 + 1, name }' "$programs"/QUICK.one/found/*/first.trial | sort -n >"$dir/found"
is="$(sed -n 's/^bugs.0.trials=//p' "$dir/flat") $(sed -n 's/^bugs.0.said=//p' "$dir/flat")"
grep -qx "$is" "$dir/found" && [ "${is%% *}" = "$(head -n 1 "$dir/found" | cut -d' ' -f1)" ] || bad "QUICK is found as $is, and the folder has $(head -n 1 "$dir/found")"

echo "values_selftest: $failed failed"
[ "$failed" -eq 0 ]
