#!/bin/sh
# What a command tells of a scene, a file or a folder does not depend on what it was given before or behind that: rows of
# several are the rows of each alone, in their order, but for times.
# Nor do rows of a list's members depend on their order, and its exit code is the worst of each alone.
#   sh tests/values/several.sh RAYDIFF [PART...]     PART: info, judged, members, bench, files, lists
set -u
raydiff=$1
shift
. tests/values/compare.sh
compared=0

# FILE: values of a JSON that are no times, nor what is made of them; ARRAY: of one array, numbered from FROM.
of() { # array, first number, file
    awk -f tests/values/flat.awk "$3" | awk -F= -v array="$1" -v from="$2" '
        index($1, array ".") != 1 { next }
        {
            path = substr($1, length(array) + 2)
            key = path
            sub(/^.*\./, "", key)
            if (key ~ /(^|_)(ns|us|ms|s|mrays|ratio|speed|seconds|median|least|most|noise|warm|memory|bytes_peak|resident|rss)(_|$)/ ||
                path ~ /(mrays|ratio|speed|warm|times|spread)|\.(front|worth)$/) next
            n = path
            sub(/\..*/, "", n)
            if (path ~ /^[0-9]+\./) print n + from path_behind(path) "=" substr($0, length($1) + 2)
        }
        function path_behind(p) { sub(/^[0-9]+/, "", p); return p }'
}
count_of() { awk -f tests/values/flat.awk "$2" | sed -n "s/^$1\.count=//p"; }

# array of the JSON, least number of values, words with ONE for what is named, then what is named
alone() {
    array=$1 least=$2 words=$3
    shift 3
    : >"$dir/each"
    from=0
    for one in "$@"; do
        told "$(echo "$words" | sed "s|ONE|$one|")" || return
        of "$array" "$from" "$dir/json" >>"$dir/each"
        from=$((from + $(count_of "$array" "$dir/json")))
    done
    told "$(echo "$words" | sed "s|ONE|$(echo "$*" | tr ' ' "$between")|")" || return
    of "$array" 0 "$dir/json" >"$dir/all"
    values=$(wc -l <"$dir/each")
    [ "$values" -ge "$least" ] || bad "$ran: only $values values"
    cmp -s "$dir/each" "$dir/all" || { bad "$ran: other values than of each alone"; diff "$dir/each" "$dir/all" | head -n 6; }
    compared=$((compared + values))
}
told() {
    # shellcheck disable=SC2086 # words of a command
    run $1 --json "$dir/json"
}

# The same rows, whatever their places, each with its values in a line; those of no member are there once.
rows_of() { # array
    of "$1" 0 "$dir/json" | awk '{ n = $0; sub(/[.=].*/, "", n); line[n] = line[n] substr($0, length(n) + 1) " " }
        END { for (n in line) print line[n] }'
}
# array of the JSON, least number of rows, words with ONE for a member of a list, then the members
listed() {
    array=$1 least=$2 words=$3 worst=0
    shift 3
    forth= back=
    : >"$dir/each"
    for one in "$@"; do
        told "$(echo "$words" | sed "s|ONE|$one|")" || return
        rows_of "$array" >>"$dir/each"
        [ "$code" -le "$worst" ] || worst=$code
        forth=$forth,$one back=$one,$back
    done
    sort -u "$dir/each" -o "$dir/each"
    rows=$(wc -l <"$dir/each")
    [ "$rows" -ge "$least" ] || bad "$ran: only $rows rows"
    for list in "${forth#,}" "${back%,}"; do
        told "$(echo "$words" | sed "s|ONE|$list|")" || return
        [ "$code" -eq "$worst" ] || bad "$ran: exit $code, of each alone at worst $worst"
        rows_of "$array" | sort -u >"$dir/all"
        cmp -s "$dir/each" "$dir/all" || { bad "$ran: other rows than of each alone"; diff "$dir/each" "$dir/all" | cut -c 1-300 | head -n 4; }
        compared=$((compared + $(wc -w <"$dir/all")))
    done
}

info() {
    for one in rtrs mixed:count=9 sphere:n=3 crowd:n=7 soup:n=4; do
        run scene info $one && cat "$dir/text" >>"$dir/each.info"
    done
    run scene info rtrs mixed:count=9 sphere:n=3 crowd:n=7 soup:n=4
    cmp -s "$dir/each.info" "$dir/text" || { bad "$ran: not the lines of each alone"; diff "$dir/each.info" "$dir/text" | head -n 4; }
    compared=$((compared + $(wc -l <"$dir/text")))
}
judged() {
    between=' '
    few='--count 200 --repeat 1 --threads 1'
    alone rows 200 "check ONE --engine cpu,brute --layout f32,rtrs_rf --tri mt,woop --box robust $few" rtrs sphere:n=4 soup:n=300,size=0.5
    alone scenes 20 "check ONE --engine cpu,brute --layout f32 $few" rtrs crowd:n=5 sphere:n=4
    alone rows 100 "leaks ONE --engine cpu,brute --layout f32,rf16 --count 1000 --threads 1" sphere:n=4 wall:n=2 sphere:n=6
    alone scenes 30 "leaks ONE --engine cpu --layout f32 --count 1000 --threads 1" sphere:n=4 room wall:n=2
}
# Of several members each row is that of its members alone, whichever engines, layouts and tests were played before.
members() {
    between=','
    boxes='--box robust,watertight' few='--count 1000'
    for engine in cpu_stackless vulkan; do
        "$raydiff" leaks sphere:n=4 --engine $engine --layout f32 $few >"$dir/text" 2>"$dir/err"
        [ $? -ne 77 ] || { echo "SKIP members of engine $engine: $(tail -n 1 "$dir/err")"; continue; }
        of="--engine $engine $boxes $few"
        alone rows 200 "leaks sphere:n=4 $of --layout f32,rf16 --tri ONE" mt woop baldwin_webber pluecker
        alone rows 200 "leaks sphere:n=4 $of --tri mt --layout ONE" f32 rf16
        alone rows 200 "leaks sphere:n=4 $of --tri mt,woop --layout f32,rf16 --builder ONE" median lbvh sah_binned
        of="--engine $engine --count 200 --repeat 1"
        alone rows 100 "check soup:n=60,size=0.8 $of $boxes --layout f32,rf16 --builder ONE" lbvh median
        alone rows 60 "check soup:n=60,size=0.8 $of --box robust --layout f32 --tri ONE" woop mt pluecker
        alone rows 60 "check soup:n=60,size=0.8 $of --box robust --tri mt --layout ONE" rf16 f32
        alone rows 60 "check soup:n=60,size=0.8 $of --box robust --tri mt --layout f32 --store ONE" edges indexed compact
        alone rows 60 "check soup:n=60,size=0.8 $of --box robust --tri mt --layout f32 --query ONE" any closest all
    done
}
bench() {
    between=';'
    few='--count 300 --rounds 1'
    scenes='sphere:n=4 cornell soup:n=300'
    alone rows 100 "bench error --scene ONE --engine cpu,brute --layout f32,rtrs_rf --tri mt,woop --box robust $few" $scenes
    alone rows 200 "bench spawn --scene ONE --engine cpu --layout f32 --tri mt $few" $scenes
    alone rows 100 "bench layouts --scene ONE --threads 1 $few" sphere:n=4 soup:n=300
    alone rows 100 "bench matrix --scene ONE --engine cpu,fast --layout f32,rf16 $few" $scenes
    alone rows 60 "bench builders --scene ONE --threads 1 --rounds 1" $scenes
    alone rows 15 "bench oracle --scene ONE $few" $scenes
    alone rows 100 "bench tightness --scene ONE --count 300" $scenes
    alone rows 100 "bench traffic --scene ONE --count 300 --depths 1,3" $scenes
    alone rows 60 "bench fast --scene ONE $few" $scenes
    alone rows 60 "bench worlds --scene ONE --instances 9 $few" $scenes
}
files() {
    between=' '
    alone files 80 "replay ONE --engine cpu,brute" fuzz/corpus/wrong-item.trial fuzz/corpus/bad-rays.trial fuzz/corpus/slot-not-read.trial
}
lists() {
    few='--count 200'
    listed rows 14 "bench traffic --scene soup:n=300,size=0.5 $few --depths ONE" 1 5 2
    listed rows 7 "bench traffic --scene soup:n=300,size=0.5 $few --scheduler depth_first,sorted,raycore --layout ONE" f32 tiny8 cwbvh80
    listed rows 4 "bench traffic --scene soup:n=300,size=0.5 $few --scheduler depth_first,sorted --store ONE" indexed gathered
    listed files.0.played 3 'replay fuzz/corpus/cut-box.trial --engine ONE' cpu brute fast
    listed files.0.played 3 'replay fuzz/corpus/rounded-inward.trial --engine cpu --layout ONE' rtrs_rf_paper rf16 f32
    listed same.0.trees 4 'build soup:n=50,offset=1e5 --same 1 --builder median --layout ONE' rf16 f32 tiny8
    listed same.0.trees 3 'build soup:n=50,offset=1e5 --same 1 --layout f32 --builder ONE' median lbvh ploc
}

for part in ${*:-info judged members bench files lists}; do "$part"; done
echo "several: $compared values, $failed failed"
[ "$failed" -eq 0 ]
