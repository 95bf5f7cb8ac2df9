#!/bin/sh
# The numbers of `raydiff conform` by value: its sums against each other, JUnit and TAP against the text, pairs of
# members counted from the names of trials, and the exit code of each situation. sh tests/values/values_conform.sh RAYDIFF
set -u
raydiff=$1
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $*"
    failed=$((failed + 1))
}
# exit code, arguments
ends() {
    wanted=$1
    shift
    "$raydiff" conform "$@" >"$dir/out" 2>&1
    code=$?
    [ "$code" -eq "$wanted" ] || { bad "conform $*: exit $code, not $wanted"; tail -n 3 "$dir/out"; }
}
number() { sed -nE "s/$1/\\1/p" "$dir/text" | tail -n 1; }

# So few rays that some trials hit nothing, which fails them.
rays=20
"$raydiff" conform --engine cpu,fast --count $rays --threads 1 --junit "$dir/xml" >"$dir/text" 2>"$dir/err"
[ $? -eq 1 ] || bad "failed trials: not exit 1"
cat "$dir/err" >>"$dir/text"
trials=$(number '^([0-9]+) trials in .*') waived=$(number '^.* s, ([0-9]+) waived.*')
passed=$(number '^([0-9]+) passed, .*') wrong=$(number '^[0-9]+ passed, ([0-9]+) failed, .*')
skipped=$(number '^.* failed, ([0-9]+) skipped$') judged=$(number '^([0-9]+) rays judged: .*')
verdicts=$(number '^[0-9]+ rays judged: (.*)' | awk '{ for (i = 2; i <= NF; i += 2) sum += $i; print sum }')
named=$(grep -c '^engine [a-z]* answered [0-9]* of [0-9]*' "$dir/text")
[ "$wrong" -gt 0 ] && [ "$skipped" -gt 0 ] && [ "$named" -eq 2 ] || bad "no trial failed, none was skipped, or no engine is named"
[ "$trials" -eq $((passed + wrong + skipped + waived)) ] || bad "$trials trials are not the sum of their ends"
[ "$judged" -eq "$verdicts" ] || bad "$judged rays judged, $verdicts verdicts"
[ "$judged" -eq $((rays * (passed + wrong))) ] || bad "$judged rays judged in $((passed + wrong)) trials of $rays"
[ "$(grep -c '^FAILED  ' "$dir/text")" -eq "$wrong" ] || bad "not a line for each of $wrong failed"
few=$(grep -c '^FAILED  .*: vacuous: ' "$dir/text")
[ "$few" -gt 0 ] && grep -qE "^$few trials? failed for want of hits alone: --count is too small\$" "$dir/text" ||
    bad "it is not told that $few trials had too few rays"
for engine in cpu fast; do
    line=$(grep "^engine $engine answered " "$dir/text" | sed 's/[,:].*//')
    of=$(grep -o 'name="[^"]*"' "$dir/xml" | grep -v answered | grep -c "^name=\"[a-z]*\.$engine\.")
    no=$(grep -c "name=\"[a-z]*\.$engine\.[^>]*><skipped" "$dir/xml")
    [ "$line" = "engine $engine answered $((of - no)) of $of" ] || bad "'$line', of $of trials $no were skipped"
done
# The named engines are cases, too.
cases="tests=\"$((trials + named))\" failures=\"$wrong\" errors=\"0\" skipped=\"$((skipped + waived))\""
grep -q "^<testsuite .*$cases" "$dir/xml" || bad "JUnit has not $cases"
[ "$(grep -c '<testcase ' "$dir/xml")" -eq $((trials + named)) ] && [ "$(grep -c '<failure' "$dir/xml")" -eq "$wrong" ] &&
    [ "$(grep -c '<skipped' "$dir/xml")" -eq $((skipped + waived)) ] || bad "JUnit has other cases than sums"

# No case takes longer than all of them.
awk '/^<testsuite / { sub(/.* time="/, ""); all = $0 + 0 }
    /^<testcase / { sub(/.* time="/, ""); sum += $0 }
    END { exit !(all > 0 && sum > 0 && sum <= 1.01 * all + 0.0005 * NR) }' "$dir/xml" || bad 'JUnit: times of cases against that of all'

# What is told of a trial is what raydiff check tells of the same rays.
for told in 'cornell edges' 'sphere mixed' 'terrain corners'; do
    scene=${told% *} set=${told#* }
    "$raydiff" conform "closest.cpu.f32.median.robust.mt.$scene.$set.1" --count 100 --verbose >"$dir/one" 2>&1
    "$raydiff" check "$scene" --builder median --layout f32 --engine cpu --rays "$set" --count 100 --seed 1 --repeat 1 --json "$dir/json" >"$dir/check" 2>&1
    awk -f tests/values/flat.awk "$dir/json" | awk -F= '
        { v[$1] = $2 }
        END {
            p = "rows.0."
            text = v[p "rays"] " rays, " v[p "hits"] " hits;"
            n = split("right tie near_tie boundary border in_plane slab noise out_of_contract wrong", kind, " ")
            for (i = 1; i <= n; i++) text = text " " kind[i] " " v[p "counts." kind[i]]
            print text sprintf("; err/E %.2f; bits %d", v[p "err_over_bound"], v[p "bit_differences"])
        }' >"$dir/line"
    grep -qF ": $(cat "$dir/line")" "$dir/one" || { bad "conform $told: not as check tells: $(cat "$dir/line")"; head -n 2 "$dir/one"; }
done

# What members as published get wrong is counted beside what is judged.
told='closest.cpu.rtrs_rf.median.rtrs.mt_rtrs.*.1'
"$raydiff" conform "$told" --count 100 --verbose >"$dir/out" 2>&1
[ $? -eq 0 ] || bad "conform $told: members as published fail"
counted=$(sed -nE 's/.* wrong ([0-9]+) \(as published, counted\).*/\1/p' "$dir/out" | awk '{ sum += $1 } END { print sum + 0 }')
[ "$counted" -gt 0 ] && grep -q "^[0-9]* rays judged: .* wrong 0; as published, counted: $counted\$" "$dir/out" ||
    bad "conform: $counted answers of members as published are not told apart"

# The hard cases: why trials are waived is the waivers' text, and of how many; failed ones with their answers.
echo none=0 >"$dir/none"
summary() { # exit code, how many waivers are told, arguments
    wanted=$1 waivers=$2
    shift 2
    "$raydiff" conform "$@" --summary --verbose --junit "$dir/hard" >"$dir/hard.text" 2>&1
    code=$?
    [ "$code" -eq "$wanted" ] || bad "conform $*: exit $code, not $wanted"
    awk -v least=8 -v "waivers=$waivers" -f tests/values/lib.awk -f tests/values/summary.awk "$dir/none" "$dir/hard" "$dir/hard.text" ||
        bad "conform $*: the summary is not of its trials"
}
summary 0 4 'hard.[03][0-9]-*' --engine cpu,cpu_stackless --layout rtrs_rf,f32,tiny8 --builder median,rtrs --box robust --tri mt,mt_rtrs
# Answers that are WRONG, and an engine that ends in some cases, are two exit codes.
for tracer in wrong ends; do
    case $tracer in
    wrong) change='s/size > 0\.0f/size > 1e-4f/' ;;
    ends) change='s/        struct ray \*ray = take/        if (q.triangles > 100) return 0;\n&/' ;;
    esac
    sed "$change" fuzz/samples/sample_tracer.c >"$dir/$tracer.c"
    cc -O1 -o "$dir/$tracer" "$dir/$tracer.c" || bad "a tracer that $tracer is not compiled"
done
summary 1 0 'hard.[0-3]?-*' --engine "pipe:$dir/wrong"
summary 3 0 'hard.[0-3]?-*' --engine "pipe:$dir/ends"

# Pairs of members.
pairs=$(awk -v fields=8 -v what='pairs of members' -f tests/conform/pairs.awk "$dir/xml")
grep -q "^$pairs" "$dir/text" || bad "not '$pairs', but '$(grep ' pairs of members met' "$dir/text")'"
awk -v fields=8 -v unmet=1 -f tests/conform/pairs.awk "$dir/xml" >"$dir/unmet"
sed -n 's/^.* pairs of members met, .* refused or skipped: //p' "$dir/text" | grep -qxFf "$dir/unmet" ||
    bad "the pair that is shown is none of $(grep -c . "$dir/unmet") that did not meet"

"$raydiff" conform --engine cpu,fast --count $rays --threads 1 --tap >"$dir/tap" 2>/dev/null
[ $? -eq 1 ] || bad "failed trials, TAP: not exit 1"
[ "$(grep -c '^ok ' "$dir/tap")" -eq $((passed + skipped + waived + named)) ] && [ "$(grep -c '^not ok ' "$dir/tap")" -eq "$wrong" ] &&
    [ "$(grep -ci '^ok .*# SKIP' "$dir/tap")" -eq $((skipped + waived)) ] && grep -qx "1\.\.$((trials + named))" "$dir/tap" ||
    bad "TAP has other cases than sums"
[ "$(sed -nE 's/^(not )?ok ([0-9]+) - .*/\2/p' "$dir/tap")" = "$(seq $((trials + named)))" ] || bad "TAP does not count its cases"

# What is waived fails and counts as none, what is refused or skipped was not played: each as the text has it.
some='hard.0[1237]-* --engine cpu,cpu_stackless --layout rtrs_rf,rf16,tiny8 --builder median --box robust --tri mt'
set -f
"$raydiff" conform $some --verbose >"$dir/text" 2>/dev/null
"$raydiff" conform $some --tap >"$dir/tap" 2>/dev/null
set +f
sed -nE 's/^(PASSED|KNOWN)  *([^ ]*): .*/ok \2/p; s/^WAIVED  *([^ ]*): .*/not ok \1 # TODO/p; s/^FAILED  *([^ ]*): .*/not ok \1/p
    s/^(SKIPPED|REFUSED) *([^ ]*): .*/ok \2 # SKIP/p' "$dir/text" >"$dir/of_text"
sed -nE 's/^((not )?ok) [0-9]+ - ([^ ]*)( # (TODO|SKIP))?.*/\1 \3\4/p' "$dir/tap" | grep ' hard\.' | cmp -s - "$dir/of_text" ||
    bad "TAP has other states than the text"
for state in TODO SKIP mt; do
    grep -q "$state\$" "$dir/of_text" || bad "no trial of state $state"
done

one='closest.cpu.f32.median.robust.mt.sphere.primary.1'
ends 0 "$one"
ends 1 'closest.cpu_stackless.bvh4_f16_node.median.robust.mt.sphere.primary.1' # refused, and nothing else ran
# What is refused could run here: nothing is tested, and that is no reason to skip.
ends 1 'world.closest.cpu.rf16.median.robust.mt.far.all.none.opaque.all.none.1.1'
ends 1 'hard.07-far-away.closest.cpu.rf16.median.robust.mt'
ends 1 'hard.07-far-away.*.rf16.median.robust.mt'
ends 77 'hard.07-*' --engine pipe:/no/such/program
ends 77 '*.sphere.primary.1' --engine pipe:/no/such/program
ends 3 '*.sphere.primary.1' --engine pipe:true --count 50
ends 2 'nothing.*'
ends 2 "$one" --count 0
printf '%s no reason https://example.org/1\n' "$one" >"$dir/waivers"
for tap in '' --tap; do
    ends 1 "$one" --waivers "$dir/waivers" $tap # it excuses nothing
done
echo "values_conform: $failed failed"
[ "$failed" -eq 0 ]
