#!/bin/sh
# What a baseline says of findings, with every form of its lines: `raydiff fuzz` and `raydiff report` take the same
# ones for known, as tables here tell, count the others, and end with 0 if there are none; JUnit and TAP agree. Of waivers
# `raydiff conform` does the same.   sh tests/values/known.sh RAYDIFF
set -u
raydiff=$1
. tests/values/compare.sh
. tests/values/tracers.sh
# Each finding of a report would start Vulkan, of which nothing is wanted here.
export VK_DRIVER_FILES=/dev/null VK_ICD_FILENAMES=/dev/null

"$raydiff" fuzz --rays 40 --jobs 1 --corpus none --engine cpu --layout rtrs_rf --faithful --trials 64 --no-shrink --dir "$dir/found" \
    >"$dir/text" 2>&1
ls "$dir/found" | grep -F . | grep -v json | sort >"$dir/names"
count=$(wc -l <"$dir/names")
[ "$count" -ge 6 ] || bad "only $count findings"
version=$(sed -n 's/^with raydiff //p' "$(ls "$dir"/found/*/first.trial | head -n 1)")
past='until 2020-01-01' later='until 2999-12-31' ever='until -' today="until $(date -u +%F)" yesterday="until $(date -u -d yesterday +%F)"

# state, the word of the line that is told of or -, then lines without their pattern, with | between: what follows the
# pattern and, before a colon, edits of sed to make the pattern of the name. A last word makes each line another.
table() {
    cat <<END
known     one   $ever one
known     one   $later one
known     one   $today one
expired   one   $past one
expired   one   $yesterday one
known     two   $past one|$ever two
known     one   $ever one|$past two
known     two   $yesterday one|$today two|$ever three
expired   one   $past one|$yesterday two
known     one   @raydiff_$version $ever one
expired   one   @raydiff_$version $past one
new       -     @raydiff_$version.99 $ever one
new       -     @raydiff_90..99 $ever one
new       -     @raydiff_90..99 $past one
known     one   @raydiff_0..99 $later one
known     one   @raydiff_0..$version $ever one
known     two   @raydiff_90..99 $ever one|$ever two
expired   two   @raydiff_90..99 $ever one|$past two
known     two   @raydiff_$version $past one|@raydiff_0..99 $ever two
new       -     s/^cpu/fast/:$ever one
new       -     s/rtrs_rf/rtrs_rf_paper/:$ever one
known     one   s/^cpu/c[o-q]?/:$ever one
expired   one   s/rtrs_rf/rtrs*/:$past one
known     one   s/[a-z][a-z]*$/[!A-Z]*/:$ever one
new       -
END
}
# finding, what follows the state in the table
lines_of() {
    echo "$2" | tr '|' '\n' | while read -r line; do
        case $line in
        s/*:*) echo "$(echo "$1" | sed "${line%%:*}") ${line#*:} docs/ci.md" ;;
        ?*) echo "$1 $line docs/ci.md" ;;
        esac
    done
}
# Of a run: exit code and counts by the table's states.
concluded() { # what ran, exit code
    known=$(grep -c '^known ' "$dir/states") new=$(grep -c '^new ' "$dir/states") expired=$(grep -c '^expired ' "$dir/states")
    counted=$((new + expired))
    [ "$2" -eq $((counted > 0)) ] || bad "$1: exit $2, and $counted findings count: $(grep -v '^known' "$dir/states" | head -n 1) $(tail -n 1 "$dir/err")"
}
value() { sed -n "s/^$1=//p" "$dir/flat" | head -n 1; }
at_of() { sed -n "s/^\($1\.[0-9]*\)\.$2=$3\$/\1/p" "$dir/flat"; } # list, key, value: the entry
fuzzed() {
    "$raydiff" fuzz --dir "$dir/found" --trials 64 --corpus none --no-shrink --baseline "$dir/known" --jsonl "$dir/jsonl" --json "$dir/json" --junit "$dir/junit" \
        --tap "$dir/tap" >"$dir/text" 2>"$dir/err"
    concluded fuzz $?
    grep -q "^findings *$count distinct, $counted outside the baseline" "$dir/text" || bad "fuzz: not $counted of $count outside the baseline"
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    while read -r state name word; do
        at=$(at_of findings signature "$name")
        [ "$(value "$at.state")" = "$state" ] || bad "fuzz: $name is $(value "$at.state"), not $state: $(grep -F "$word" "$dir/known")"
        case $state in new) ;; *) value "$at.reason" | grep -q "\(^\|: \)$word docs" || bad "fuzz: $name: not for '$word': $(value "$at.reason")" ;; esac
        case $state in
        known) grep -F "$name" "$dir/tap" | grep -q '^not ok .*# TODO known' || bad "tap: $name is not known" ;;
        *) grep -F "$name" "$dir/tap" | grep '^not ok ' | grep -qv TODO || bad "tap: $name does not count" ;;
        esac
    done <"$dir/states"
    [ "$(grep -c '<failure ' "$dir/junit")" -eq "$counted" ] || bad "junit: not $counted failures"
}
reported() {
    "$raydiff" report --findings "$dir/found" --baseline "$dir/known" --parts check --out "$dir/page.html" --json "$dir/json" \
        >"$dir/text" 2>"$dir/err"
    concluded report $?
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    [ "$(value known)" -eq "$known" ] && [ "$(value failing)" -eq "$counted" ] ||
        bad "report: $(value known) known, $(value failing) fail, not $known and $counted"
    while read -r state name word; do
        told=$(value "$(at_of parts name "$name").known")
        case $state in
        known) echo "$told" | grep -q "\(^\|: \)$word docs" || bad "report: $name is known for '$told', not '$word'" ;;
        *) [ -z "$told" ] || bad "report: $name is $state and yet known: $told" ;;
        esac
    done <"$dir/states"
}
# A line of the table for each finding, from that after the first $1 on; or those of one state, again and again.
baseline() { # how many are left out, state or .
    table | grep "^$2" >"$dir/rows"
    { tail -n +$(($1 + 1)) "$dir/rows"; for name in $(cat "$dir/names"); do cat "$dir/rows"; done; } | head -n "$count" >"$dir/chosen"
    printf '# A comment\n\n' >"$dir/known"
    paste "$dir/names" "$dir/chosen" | while read -r name state word line; do
        lines_of "$name" "$line" >>"$dir/known"
        echo "$state $name $word"
    done >"$dir/states"
}

day=$(date -u +%F)
rows=$(table | wc -l)
first=0
while [ "$first" -lt "$rows" ]; do
    baseline "$first" . && fuzzed && reported
    first=$((first + count))
done
for state in known expired; do baseline 0 "$state" && fuzzed && reported; done

# Waivers have no day. Where all that ran is waived, nothing failed, and nothing was skipped.
tracer blind
trial='closest.pipe:*/blind.-.-.-.*.soup.random.1'
waived() { # exit code, whether the trials are waived, lines without their pattern, with | between
    { printf '# A comment\n\n' && lines_of "$trial" "$3"; } >"$dir/waivers"
    "$raydiff" conform 'closest.*.soup.random.1' --engine "pipe:$dir/blind" --count 100 --waivers "$dir/waivers" >"$dir/text" 2>"$dir/err"
    code=$?
    [ "$code" -eq "$1" ] && case $2 in all) grep -q '^\([0-9]*\) trials* in .*, \1 waived' "$dir/text" ;; *) grep -q ', 0 waived' "$dir/text" ;; esac ||
        bad "conform: exit $code, not $1 with $2 waived: $3"
}
waived 0 all 'a word'
waived 0 all 's/blind.*soup/*s[n-p]u?/:a word'
waived 0 all 'a word|s/blind/b*d/:another'
waived 0 all '@raydiff_90..99 a word|another'
waived 1 none '@raydiff_90..99 a word'
waived 1 none 's/blind/fast/:a word'
waived 1 none ''

[ "$(date -u +%F)" = "$day" ] || { echo 'SKIP the day has changed'; exit 77; }
echo "known: $failed failed"
[ "$failed" -eq 0 ]
