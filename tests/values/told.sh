#!/bin/sh
# What commands print, word for word: tests/values/told.txt has command lines, each with what it prints and its exit
# code. Of pages and of files that a command writes, the text without pictures, a line for each row of a table. Times
# and speeds are masked; only engines of this program run, whose answers are the same everywhere.
#   sh tests/values/told.sh RAYDIFF [write]      write: make the texts anew
set -u
raydiff=$(realpath "$1")
. tests/values/compare.sh
. tests/values/tracers.sh
here=$(pwd)
# Lines are broken by their length, so that no name tells of the temporary folder.
cd "$dir" && ln -s "$here/fuzz" fuzz && PATH=$dir:$PATH || exit 4
: >"$dir/told"
most=60 # lines of what a command prints

# Times, versions, and what a machine has.
masked() {
    sed -E "s/ in [0-9.]+ (s|ms)\b/ in # \1/g; s/[0-9.]+ (s|ms|us|ns)\b/# \1/g; s/raydiff [0-9]+\.[0-9]+\.[0-9]+.*/raydiff #/; s/[0-9]+ threads?/# threads/" |
        sed '/^```$/,/^```$/d; /^<pre>/,/<\/pre>/d'
}
# What check and fuzz tell of speeds: a column, sentences, the end of the conclusion.
no_speeds() {
    case $1 in
    check)
        awk '/^    / { sub(/^ */, " "); line = line $0; next } NR > 1 { print line } { line = $0 } END { print line }' |
            sed -E '/^(agrees|WRONG|FAILS|counted) /s/ +[0-9]+\.[0-9]{3}( +[0-9.-]+)?$/ #/; s/ +Mray\/s( +least-most)?$/ Mray\/s/; /node bytes/d; /^conclusion: /s/;.*//'
        ;;
    bench) sed -E 's/ +[0-9]+\.[0-9]{3}( +[0-9.-]+)?$/ #/; s/^(verdict .*[^ ]) +[^ ]+$/\1/' ;;
    fuzz) sed -E 's|[0-9]+/s|#/s|; s/harness [0-9]+ %/harness #/' ;;
    *) cat ;;
    esac
}
# arguments
told() {
    echo "$ raydiff $*" >>"$dir/told"
    timeout 30 "$raydiff" "$@" >"$dir/out" 2>"$dir/err" </dev/null
    code=$?
    no_speeds "$1" <"$dir/out" | masked | head -n "$most" >>"$dir/told"
    masked <"$dir/err" | sed 's/^/! /' >>"$dir/told"
    [ "$code" -eq 0 ] || echo "exit $code" >>"$dir/told"
}
# set: the rays at the end of what gen writes
rays() {
    echo "$ rays $1" >>"$dir/told"
    "$raydiff" gen "$2" --rays "$1" --count 12 2>"$dir/err" | tail -n 13 >>"$dir/told"
}
# file: a page that was written
page() {
    echo "$ page" >>"$dir/told"
    perl -0pe 's/<svg.*?<\/svg>/<svg>/gs; s/<script.*?<\/script>/<script>/gs; s/<style.*?<\/style>/<style>/gs; s/>\n<(t[dh]|li|\/tr|\/figure|figcaption|svg|script)\b/><$1/g' \
        "$dir/$1" | masked >>"$dir/told"
}
# file: a text that was written
file() {
    echo "$ file" >>"$dir/told"
    masked <"$dir/$1" >>"$dir/told"
}

explained() {
    for trial in fuzz/corpus/*.trial; do
        case $trial in
        */inactive-instance.* | */overflow.*) told explain "$trial" ;; # of worlds there are no pages
        *) told explain "$trial" --html page.html ;;
        esac
        case $trial in
        */cut-box.* | */wrong-item.* | */slot-not-read.* | */strict-comparison.*) page page.html ;;
        esac
    done
    told explain sphere:n=8 --engine cpu --rays vertices --count 10 --index 4 --html right.html
    page right.html
    told explain sphere:n=8 --layout rtrs_rf_paper --tri woop --rays edges --count 20000 --cause rounded_inward --html page.html
    page page.html
    told explain mixed --engine cpu --layout f32
    told explain crowd:n=20 --engine cpu --layout rtrs_rf --query any --wide
}
pictures() {
    size='--width 16 --height 12'
    told render cornell --engine cpu --out a.png $size
    told render cornell --engine cpu --out b.png $size --bounces 0
    told render sphere:n=8 --engine cpu --layout rtrs_rf_paper --tri woop --out c.png $size
    told diff a.png b.png
    told diff a.png a.png
    told diff cornell --engine cpu,fast $size
    told diff sphere:n=8 --layout rtrs_rf_paper --tri woop --engine cpu,brute $size
    told diff sphere:n=8 --layout rtrs_rf_paper --tri woop --engine cpu,brute $size --pixel 3,4
    told diff cornell --engine cpu,brute $size --pixel 8,6
    for pixel in 12,1 13,0 4,2; do told diff cornell --engine cpu,fast $size --pixel $pixel; done
    told diff cornell --engine cpu,brute $size --pixel 4,2 --profile rtrs --bounces 2 --ambience 0.25
    told render cornell --engine cpu --out p.png $size --profile rtrs --paths p.csv
    tail -n 12 p.csv >p.tail
    file p.tail
    told diff cornell --engine cpu,brute $size --pixel 8,6 --builder sah_binned --leaf 2 --bins 8
    told diff cornell --engine cpu,brute $size --pixel 8,6 --builder ploc --radius 8 --optimize reinsert=2
    told diff cornell --engine cpu,brute $size --pixel 8,6 --builder sbvh --split-budget 0.5 --split-alpha 0.25
    told diff cornell --engine cpu,brute $size --pixel 8,6 --builder lbvh --presplit 0.5
    for what in t prim boxes triangles depth class; do
        told render cornell --engine cpu --show $what --out s.png --csv s.csv --width 6 --height 4
        file s.csv
    done
}
scenes() {
    told scene info soup:n=10
    told scene info cornell room --json
    told scene info cornell
    for world in crowd:n=20 wall nest twins mixed room; do told scene info $world; done
    told scene convert cornell cornell.obj
    told scene info cornell.obj
    told scene convert platonic platonic.stl
    told scene info platonic.stl
    told precompute --scene soup:n=3 --builder median --out tree.json
    file tree.json
    told precompute --scene soup:n=3 --verify tree.json
    told precompute --scene soup:n=3,seed=2 --verify tree.json
    "$raydiff" list 'ray sets' | sed -n 's/^ *\([a-z_]*\)  .*/\1/p' >"$dir/sets"
    while read -r set; do rays "$set" sphere:n=4; done <"$dir/sets"
    rays edges mixed
    told gen cornell --count 3
    told gen mixed --count 2 --decimal
    told construct -- --out made.json --camera-pos 0.0 0.0 10.0 0.0 0.0 0.0 --camera-orbit --light 20.0 20.0 20.0 1.5 \
        --material 0.4 0.4 0.3 0.6 0.3 0.1 50.0 --model cornell.obj 0
    told scene info made.json
    for table in builders layouts storages 'ray sets' 'box tests'; do told list "$table"; done
}
judged() {
    told conform 'hard.01*.closest.cpu.f32.median.robust.mt' --markdown hard.md --html hard.html
    file hard.md
    page hard.html
    told conform --hard 'hard.*.closest.cpu.rtrs_rf.median.robust.mt' --markdown hard.md
    file hard.md
    told conform 'closest.cpu.f32.*.robust.mt.soup.random.1' --count 50
    told check mixed --engine cpu,brute --layout f32,rf16 --query closest,all --count 200 --repeat 1
    told check sphere:n=6 --engine cpu --layout f32,rtrs_rf_paper --tri woop --count 400 --repeat 1
    told check soup:n=30 platonic --engine cpu,fast --layout f32,half4 --tri woop --count 60 --repeat 1
    told leaks sphere:n=6 --engine cpu --layout f32,rtrs_rf_paper --tri mt,woop --box watertight --count 1000
    told leaks crowd --engine cpu --layout f32 --count 1000
    told replay fuzz/corpus/wrong-item.trial fuzz/corpus/cut-box.trial --engine cpu
    told min fuzz/corpus/wrong-item.trial --out small.trial
    file small.trial
    told fuzz --trials 64 --engine cpu --layout rtrs_rf --faithful --until 1 --no-shrink --rays 40 --jobs 1 --corpus none --dir found
    told merge --to merged found
    told min merged
    told export fuzz/corpus/bad-rays.trial --engine vulkan --to exported
}
# Tracers that find nothing, refuse everything, and end at the first rays; findings that are gone or cannot be played.
failing() {
    for tracer in blind refuser ender; do
        tracer "$tracer"
        of="--engine pipe:$tracer"
        told check soup:n=50 $of --count 60 --repeat 1
        told leaks sphere:n=4 $of --count 1000
        told conform 'closest.*.soup.random.1' $of --count 60
        told conform --hard 'hard.0[12]*.closest.*' $of --markdown hard.md
        file hard.md
        told diff sphere:n=4 --engine cpu,pipe:$tracer --width 8 --height 8
        told replay fuzz/corpus/rounded-inward.trial $of
        told explain cornell --rays primary --index 0 $of
        told bench error --scene sphere:n=4 $of --count 50 --rounds 1
    done
    told diff sphere:n=4 --engine cpu,pipe:blind --width 8 --height 8 --pixel 4,4
    sed 's/^expect cpu\.[^.]*/expect cpu.f32/' fuzz/corpus/wrong-item.trial >cured.trial
    told min cured.trial --out none.trial
    told replay cured.trial --engine cpu
    told replay cured.trial --engine cpu --as-expected
    told min found --asks 3
}

for part in explained pictures scenes judged failing; do "$part"; done
[ "${2:-}" != write ] || cp "$dir/told" "$here/tests/values/told.txt"
diff "$here/tests/values/told.txt" "$dir/told" >"$dir/changed" || { bad "other words than in tests/values/told.txt"; head -n 20 "$dir/changed"; }
echo "told: $(grep -c '^\$ raydiff' "$dir/told") commands, $failed failed"
[ "$failed" -eq 0 ]
