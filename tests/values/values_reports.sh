#!/bin/sh
# The numbers of `raydiff doctor` and `report` by value: cards against their JSON, what a report counts against the results
# that it was made of. sh tests/values/values_reports.sh RAYDIFF
set -u
raydiff=$1
. tests/values/compare.sh

run doctor --json "$dir/json" && values doctor 80 processors="$(getconf _NPROCESSORS_ONLN)" "$dir/text"

# Floats of the environment, which what is loaded first has set otherwise: exit code 4, and what is not so.
cat >"$dir/floats.c" <<'END'
#include <fenv.h>
#include <stdlib.h>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif
__attribute__((constructor)) static void set(void)
{
    const char *what = getenv("FLOATS");
    if (what && what[0] == 'd')
        fesetround(FE_UPWARD);
#ifdef __SSE2__
    if (what && what[0] == 'f')
        _mm_setcsr(_mm_getcsr() | 0x8000u);
#endif
}
END
cc -O0 -shared -fPIC -o "$dir/floats.so" "$dir/floats.c" -lm || bad 'floats.c is not compiled'
floats() { # exit code or 0 for any other than 4, what is set, the line
    FLOATS=$2 LD_PRELOAD=$dir/floats.so "$raydiff" doctor --driver no-such-driver >"$dir/text" 2>"$dir/err"
    code=$?
    [ $((code == 4)) -eq $(($1 == 4)) ] || bad "doctor, floats $2: exit $code"
    grep -qx "float  *$3" "$dir/text" || bad "doctor, floats $2: not '$3'"
}
case $(nm -D "$raydiff" 2>/dev/null | grep -c __asan_init) in
0)
    floats 0 none 'IEEE: FLT_EVAL_METHOD 0, subnormals kept, rounding to nearest'
    floats 4 directed 'NOT IEEE: FLT_EVAL_METHOD 0, subnormals kept, rounding directed'
    case $(uname -m) in x86_64) floats 4 flushed 'NOT IEEE: FLT_EVAL_METHOD 0, subnormals flushed, rounding to nearest' ;; esac
    ;;
*) echo 'SKIP floats of the environment: a sanitized program is to be loaded first' ;;
esac

# What a report says of the machine, and of two cards whose numbers are all different.
perl tests/values/findings/machine.pl --two "$dir/json" >"$dir/two.json"
case $? in
0)
    run report --doctor "$dir/two.json" --parts machine --out "$dir/page.html" &&
        perl tests/values/findings/machine.pl "$dir/two.json" "$dir/page.html" "$("$raydiff" --version | awk '{ print $2 }')" ||
        bad 'report: another machine, or other cards'
    ;;
77) echo 'SKIP a report on cards: doctor has not both, one that runs and one that does not' ;;
*) bad 'report: no file of two cards' ;;
esac

# findings, of these failing, least number of values, arguments
reported() {
    findings=$1 failing=$2 least=$3
    shift 3
    run report "$@" --out "$dir/page.html" --json "$dir/json" &&
        values report "$least" bytes="$(wc -c <"$dir/page.html")" figures="$(grep -c '<figure>' "$dir/page.html")" \
            findings="$findings" failing="$failing" "$dir/other.flat" "$dir/text"
}
# A tracer that finds nothing is WRONG in many rows; members as published do not count.
sed 's/size > 0\.0f/size > 1e30f/' fuzz/samples/sample_tracer.c >"$dir/blind.c"
cc -O1 -o "$dir/blind" "$dir/blind.c" || bad "blind is not compiled"
run check sphere:n=4 soup:n=100 --engine "cpu,brute,pipe:$dir/blind" --layout f32,rtrs_rf --count 300 --repeat 1 --json "$dir/check.json"
awk -f tests/values/flat.awk "$dir/check.json" >"$dir/other.flat"
reported 0 0 15 --check "$dir/check.json" --parts check
[ "$(sed -n 's/^wrong=//p' "$dir/flat")" -ge 50 ] || bad "report: nothing is WRONG"

# Results of every outcome, in several orders: 3 before 1, 77 and 0; the page says the same in its first sentence.
for engines in cpu "cpu,pipe:$dir/blind" "cpu,pipe:$dir/missing" 'cpu,pipe:false'; do
    ran="raydiff check sphere:n=4 --engine $engines"
    "$raydiff" check sphere:n=4 --engine "$engines" --layout f32 --count 200 --repeat 1 --json "$dir/outcome" >"$dir/text" 2>"$dir/err"
    code=$?
    mv "$dir/outcome" "$dir/outcome$code.json" || bad "$ran: no JSON"
done
for codes in '0' '0 77' '77 1 0' '1 77' '3 77 1' '1 3' '77 3 0'; do
    given= want=0
    : >"$dir/other.all"
    for code in $codes; do
        awk -f tests/values/flat.awk "$dir/outcome$code.json" >>"$dir/other.all"
        given="$given --check $dir/outcome$code.json"
        case $want.$code in 0.* | 77.[13] | 1.3) want=$code ;; esac
    done
    ran="report of $codes"
    "$raydiff" report $given --parts check --out "$dir/page.html" --json "$dir/json" >"$dir/text" 2>"$dir/err"
    code=$?
    [ "$code" -eq "$want" ] || bad "$ran: exit $code, not $want"
    # Rows of all of them, numbered on.
    awk -F= '/^rows.0.engine=/ { from += rows; rows = 0 }
        /^rows\.[0-9]/ { split($1, part, "."); if (part[2] + 1 > rows) rows = part[2] + 1; sub(/^rows\.[0-9]+/, "rows." from + part[2]); print }
        END { print "rows.count=" from + rows }' "$dir/other.all" >"$dir/other.flat"
    values report 10 bytes="$(wc -c <"$dir/page.html")" figures=0 findings=0 failing=0 "$dir/other.flat" "$dir/text"
    case $want in
    0) sentence='Everything agrees' ;;
    77) sentence='Everything that ran agrees; some parts could not run' ;;
    *)
        sentence='A part has no good result: see below'
        case " $codes " in *' 1 '*) sentence="WRONG answers: $(sed -n 's/^wrong=//p' "$dir/flat"); with other bits: 0" ;; esac
        ;;
    esac
    grep -qF ">$sentence (exit code $want)<" "$dir/page.html" || bad "$ran: the page does not say '$sentence (exit code $want)'"
done

# The tables of a page, cell by cell: rows that are WRONG, as published, refused and skipped; any benchmark.
run check sphere:n=4 soup:n=100 --engine "cpu,cpu_stackless,rayquery,pipe:$dir/blind" --layout f32,rtrs_rf,tiny8 --query closest,any \
    --driver no-such-driver --tri mt,woop --box robust,watertight --builder median,lbvh --count 300 --repeat 2 --threads 1 --brute 0 --json "$dir/rows.json"
# The first row has other bits than cpu's.
perl -0 -i -pe 's/"bit_differences": 0/"bit_differences": 3/; s/"differences": 0/"differences": 3/' "$dir/rows.json"
# Every kind of what is WRONG is there no time, once and several times, in some row.
perl -0 -i -pe 's/("wrong": \{)([^}]*)/my ($head, $kinds, $place) = ($1, $2, $row++); $kinds =~ s,: \K\d+,$place++ % 4,ge; $head . $kinds/ge' "$dir/rows.json"
[ "$(grep -o '"phantom": [0-3],*$' "$dir/rows.json" | sort -u | wc -l)" -eq 4 ] || bad 'rows: not every count of a kind'
run bench layouts --scene sphere:n=4 --count 200 --rounds 2 --threads 1 --json "$dir/layouts.json"
run bench error --scene sphere:n=4 --count 60 --rounds 1 --engine cpu,brute --layout f32 --tri mt,woop --json "$dir/error.json"
run report --check "$dir/rows.json" --bench "$dir/layouts.json" --bench "$dir/error.json" --parts check,bench --out "$dir/page.html" &&
    perl tests/values/findings/page.pl "$dir/page.html" "$dir/rows.json" "$dir/layouts.json" "$dir/error.json" || bad 'report: tables'

# Findings: as many as the folder has, all of them still there, or none of them. Each would start Vulkan, of which nothing
# is wanted here.
export VK_DRIVER_FILES=/dev/null VK_ICD_FILENAMES=/dev/null
: >"$dir/other.flat"
run fuzz --rays 40 --jobs 2 --corpus none --engine cpu --layout rtrs_rf --faithful --trials 64 --no-shrink --until 3 --dir "$dir/found"
count=$(ls -d "$dir"/found/*/first.trial | wc -l)
[ "$count" -ge 2 ] || bad "report: only $count findings"
reported "$count" "$count" 10 --findings "$dir/found" --parts machine
printf '%s until - a word docs/fuzzing.md\n' 'cpu.*.*.*' >"$dir/known"
reported "$count" 0 10 --findings "$dir/found" --baseline "$dir/known" --parts machine

# Of each finding a report has what its own command does, whatever the findings before it were: its exit code, and a
# result only where that command has one. Findings of a tracer that is not named stand between others.
"$raydiff" fuzz --rays 40 --jobs 1 --corpus none --engine "pipe:$dir/blind" --trials 64 --no-shrink --until 1 --dir "$dir/blind.found" >"$dir/text" 2>&1
for order in 'found blind.found' 'blind.found found'; do
    rm -rf "$dir/merged" && "$raydiff" merge --to "$dir/merged" "$dir/${order% *}" "$dir/${order#* }" >"$dir/text" 2>&1 || bad 'no merge'
    "$raydiff" report --findings "$dir/merged" --parts machine --out "$dir/page.html" --json "$dir/page.json" >"$dir/text" 2>"$dir/err"
    awk -f tests/values/flat.awk "$dir/page.json" >"$dir/flat"
    : >"$dir/states"
    for part in $(sed -n 's/^\(parts\.[0-9]*\)\.name=.*[.].*[.].*/\1/p' "$dir/flat"); do
        rm -f "$dir/json"
        eval "\"\$raydiff\" $(sed -n "s/^$part\.command=raydiff //p" "$dir/flat") --json \"\$dir/json\"" >"$dir/text" 2>&1
        code=$? state=failed
        [ ! -s "$dir/json" ] || state=ran
        echo "$state" >>"$dir/states"
        grep -qx "$part.exit=$code" "$dir/flat" && grep -qx "$part.state=$state" "$dir/flat" ||
            bad "report: $(grep "^$part\.[nse]" "$dir/flat" | tr '\n' ' '): its command $state with $code"
    done
    [ "$(sort "$dir/states" | uniq | wc -l)" -eq 2 ] || bad "report: not findings with and without a result"
done

# What a report is given goes to every command that takes it: none of them is refused, and each refuses what it was not
# given. All layouts on all engines are the subject of bench layouts, whatever is named; values are shown of one engine.
given='--seed=3 --rays=random --query=any --tri=woop --box=watertight --layout=f32 --engine=cpu --threads=1'
whole=$(realpath "$raydiff")
for scene in soup:n=60 cornell; do
    # shellcheck disable=SC2086 # words of a command
    "$raydiff" report $scene --quick --count 100 --rounds 1 $given --out "$dir/page.html" --json "$dir/json" >"$dir/text" 2>"$dir/err"
    perl -MJSON::PP -e 'local $/; print map { ("$_->{exit}\n", map { "$_\n" } split /\n/, $_->{command}) } @{ decode_json(<STDIN>)->{parts} }' \
        <"$dir/json" >"$dir/commands"
    grep -qx 2 "$dir/commands" && bad "report $scene: a part is bad input"
    grep '^raydiff ' "$dir/commands" >"$dir/lines"
    [ "$(wc -l <"$dir/lines")" -ge 8 ] || bad "report $scene: $(wc -l <"$dir/lines") commands"
    [ "$(grep -c '^raydiff bench .* --rounds 1 ' "$dir/lines")" -eq 2 ] && ! grep '^raydiff [cb][a-z]* ' "$dir/lines" | grep -qv ' --count 100 ' ||
        bad "report $scene: not the count or the rounds that it was given"
    refused=0
    while read -r line; do
        for option in $given; do
            case "$line $option" in
            *" ${option%%=*} "* | *' bench layouts '*' --layout='* | *' bench layouts '*' --engine='* | *' --show '*' --engine='*) continue ;;
            esac
            (cd "$dir" && eval "'$whole' ${line#raydiff } $option") >"$dir/text" 2>"$dir/err" </dev/null
            code=$?
            [ "$code" -eq 2 ] && grep -qe "${option%%=*}" "$dir/err" || bad "report $scene, $line: takes $option, which it was not given"
            refused=$((refused + 1))
        done
    done <"$dir/lines"
    [ "$refused" -ge 10 ] || bad "report $scene: only $refused options are left out"
done

# A picture of two layouts is of what the second has less what the first has.
for layouts in f32,rf16 rf16,f32; do
    run report soup:n=9 --quick --parts pictures --engine cpu --layout $layouts --out "$dir/page.html"
    [ "$(grep -o '<b>[^<]*, [a-z0-9]* less [a-z0-9]*</b>' "$dir/page.html" | sed 's/.*, //; s/<.*//' | sort -u)" = "${layouts#*,} less ${layouts%,*}" ] ||
        bad "report of $layouts: titles of their differences"
done

# A layout that does not hold the scene counts where it was named, in pictures, too.
printf 'v 0 0 0\nv 1e6 0 0\nv 1e6 1e6 0\nv 0 1e6 0\nf 1 2 3\nf 1 3 4\n' >"$dir/far.obj"
while read -r want named; do
    # shellcheck disable=SC2086 # words of a command
    "$raydiff" report "$dir/far.obj" --quick --parts pictures --engine cpu $named --out "$dir/page.html" >"$dir/text" 2>"$dir/err"
    code=$?
    [ "$code" -eq "$want" ] || bad "report of a scene that rf16 does not hold, $named: exit $code, not $want"
    case $named in '--layout f32') continue ;; esac
    grep -q 'rf16.*65504\|65504.*rf16' "$dir/page.html" || bad "report of a scene that rf16 does not hold, $named: not told"
done <<'END'
0
0 --layout f32
2 --layout f32,rf16
2 --layout rf16,f32
2 --layout rf16
END

all_seen doctor report
echo "values_reports: $failed failed"
[ "$failed" -eq 0 ]
