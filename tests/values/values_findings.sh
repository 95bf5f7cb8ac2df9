#!/bin/sh
# The numbers of `raydiff fuzz`, `min`, `replay` and `explain` by value: every line of text against the JSON, sums, rates and
# steps computed anew; commands that are printed do what they did. sh tests/values/values_findings.sh RAYDIFF
set -u
raydiff=$1
. tests/values/compare.sh

# name, least number of values, variables of awk
laws() {
    name=$1 least=$2
    shift 2
    awk "$@" -v least="$least" -f tests/values/lib.awk -f tests/values/floats.awk -f "tests/values/findings/$name.awk" "$dir/flat" \
        "$dir/text" || bad "$name: $ran"
}
# exit code, arguments of raydiff
try() {
    wanted=$1
    shift
    ran="raydiff $*"
    "$raydiff" "$@" --json "$dir/json" >"$dir/text" 2>"$dir/err"
    code=$?
    [ "$code" -eq "$wanted" ] || bad "$ran: exit $code, not $wanted"
    awk -f tests/values/flat.awk "$dir/json" >"$dir/flat"
    [ "$(sed -n 's/^exit=//p' "$dir/flat")" = "$code" ] || bad "$ran: the JSON tells another exit code"
}
# The last run in 80 columns: the same words, those of the tables of a node in another order. Lines of a file and of a
# command, and paths, are not broken.
fits() {
    "$raydiff" "$@" >"$dir/narrow" 2>/dev/null
    grep -vE '^again |^ *[^ ]{40,}$' "$dir/narrow" | grep -E '.{81}' && bad "raydiff $*: a line is longer than 80 columns"
    for page in narrow text; do
        sed -E 's/^  (side|bound) +of its/  of its/' "$dir/$page" | tr -s ' \n' '\n' | LC_ALL=C sort >"$dir/$page.words"
    done
    [ "$(grep '^again ' "$dir/narrow")" = "$(grep '^again ' "$dir/text")" ] || bad "raydiff $*: the command is not one line"
    cmp -s "$dir/narrow.words" "$dir/text.words" || { bad "raydiff $*: other words in 80 columns"; diff "$dir/text.words" "$dir/narrow.words" | head -5; }
}
# Runs the last command of the page, which prints the same page but for itself.
again() {
    cp "$dir/text" "$dir/before"
    printed=$(sed -n 's/^again     raydiff //p' "$dir/text")
    [ -n "$printed" ] || { bad "$ran: nothing shows how to get it again"; return; }
    eval "\"\$raydiff\" $printed --wide" >"$dir/text" 2>"$dir/err"
    for page in before text; do sed '/^scene  /,$!d; /^again  /d; /^engine .* answered [0-9]/d' "$dir/$page" >"$dir/$page.page"; done
    [ -s "$dir/text.page" ] && cmp -s "$dir/before.page" "$dir/text.page" || bad "$ran: $printed prints another page"
}
# file, hints, arguments
explained() {
    file=$1 lost=$2
    shift 2
    try 1 explain "$file" --wide "$@"
    fits explain "$file" "$@"
    laws explain 120 -v "triangles=$(sed -n 's/^triangles //p' "$file")" -v "lost=$lost"
    again
}
# file, exit code, how one player ended or "", arguments
replayed() {
    file=$1 wanted=$2 status=$3
    shift 3
    try "$wanted" replay "$file" --wide "$@"
    laws replay 20 -v "trial=$file" -v "status=$status"
}

fuzz="--rays 40 --jobs 2 --corpus none --faithful --seed 9"
try 1 fuzz $fuzz --engine cpu --layout rtrs_rf,f32 --trials 128 --no-shrink --dir "$dir/a"
laws fuzz 140 -v rays=40
try 1 fuzz --dir "$dir/a" --trials 129 --no-shrink
laws fuzz 60 -v rays=40
try 0 fuzz --rays 30 --jobs 1 --corpus none --engine cpu,brute --layout f32 --trials 64 --dir "$dir/sound"
laws fuzz 60 -v rays=30
# What an engine refuses is not told as refused by its layout, too.
. tests/values/tracers.sh
tracer refuser
try 1 fuzz --rays 20 --jobs 1 --corpus none --engine "cpu,pipe:$dir/refuser" --layout f32 --trials 64 --dir "$dir/refused"
laws fuzz 60 -v rays=20
printf '%s until - a word docs/fuzzing.md\n' 'cpu.rtrs_rf.missed.*' 'cpu.*.*.determinant_threshold' >"$dir/known.txt"
try 1 fuzz --dir "$dir/a" --baseline "$dir/known.txt" --trials 129 --no-shrink
laws fuzz 60 -v rays=40
try 0 min "$dir/a"
laws min 80
try 0 min "$dir/a" # nothing is smaller now
laws min 80
for file in cut-box sentinel; do
    try 0 min "fuzz/corpus/$file.trial" --out "$dir/small.trial"
    laws min 14
    for side in before.bytes=$(($(wc -c <"fuzz/corpus/$file.trial"))) after.bytes=$(($(wc -c <"$dir/small.trial"))); do
        grep -qx "findings.0.$side" "$dir/flat" || bad "$ran: not $side"
    done
    rm "$dir/small.trial"
done

# Ended by few asks, and what is the smallest already.
try 0 min fuzz/corpus/slot-not-read.trial --asks 40 --out "$dir/small.trial"
laws min 20
try 0 min "$dir/small.trial" --asks 1 --out "$dir/same.trial"
laws min 20
rm "$dir/small.trial" "$dir/same.trial"
# Asks count more than trials where rays or triangles are many.
try 1 fuzz --rays 400 --jobs 1 --corpus none --faithful --seed 9 --engine cpu --layout rtrs_rf --trials 64 --no-shrink --dir "$dir/many"
try 0 min "$(ls -d "$dir"/many/*.missed.* | head -n 1)/first.trial" --out "$dir/small.trial"
laws min 14
grep -qx "findings.0.asks=$(sed -n 's/^findings.0.tried=//p' "$dir/flat")" "$dir/flat" && bad "$ran: asks are trials"
# What may not show again is left as it is.
once=$(ls -d "$dir"/many/*.missed.* | head -n 1)
signature=$(basename "$once" | sed 's/[^.]*$/not_repeatable/')
mkdir -p "$dir/once/$signature"
cp "$once/count" "$dir/once/$signature/count"
sed "s/^expect .*/expect $signature/" "$once/first.trial" | tee "$dir/once/$signature/first.trial" >"$dir/once/$signature/smallest.trial"
grep -F "\"$(basename "$once")\"" "$dir/many/findings.jsonl" | sed "s/$(basename "$once")/$signature/" >"$dir/once/findings.jsonl"
try 0 min "$dir/once"
for line in result=skipped 'reason=not repeatable' asks=0 written=; do
    grep -qx "findings.0.$line" "$dir/flat" || bad "$ran: not $line"
done
cmp -s "$dir/once/$signature/first.trial" "$dir/once/$signature/smallest.trial" || bad "$ran: it was shrunk"

# Merges: what each folder has, and what of it lies in the new one.
folder() { # what, folder
    set -- "$1" "$2" "$(find "$2" -mindepth 1 -maxdepth 1 -type d | wc -l)" "$(cat "$2"/*/count | awk '{ sum += $1 } END { print sum }')"
    grep -qx "$1  *$2: $3 distinct, $4 in all" "$dir/text" || bad "merge: not '$1 $2: $3 distinct, $4 in all'"
}
"$raydiff" merge --to "$dir/merged" "$dir/a" "$dir/many" >"$dir/text" 2>"$dir/err" || bad 'merge fails'
folder from "$dir/a" && folder from "$dir/many" && folder to "$dir/merged"
[ "$(cat "$dir/merged"/*/count | awk '{ sum += $1 } END { print sum }')" -eq \
    "$(cat "$dir/a"/*/count "$dir/many"/*/count | awk '{ sum += $1 } END { print sum }')" ] || bad 'merge loses findings'
for folder in "$dir"/merged/*/; do
    size=$(awk '/^triangles / { t = $2 } /^rays / { r = $2 } END { print t " triangle" (t == 1 ? "" : "s") ", " r " ray" (r == 1 ? "" : "s") }' \
        "$folder/smallest.trial")
    grep -qx " *$(cat "$folder/count")  $(basename "$folder")  smallest: $size" "$dir/text" || bad "merge: $folder: not '$size'"
done

missed=0
for file in "$dir"/a/*/smallest.trial fuzz/corpus/wrong-item.trial fuzz/corpus/slot-not-read.trial; do
    replayed "$file" 1 skipped --engine cpu,brute,vulkan --driver no-such-driver
    case $(sed -n 's/^expect //p' "$file") in
    *.missed.*)
        missed=$((missed + 1))
        again
        explained "$file" 0
        ;;
    esac
done
[ "$missed" -ge 6 ] || bad "only $missed rays that are lost"
# What is expected is behind rays that are lost for other causes.
cat >"$dir/two.trial" <<'END'
raydiff trial 1
expect cpu.rtrs_rf_paper.missed.rounded_inward
builder median leaf 4 eps 0.02
box watertight
tri mt
query closest
vertices 6
-100 -10 0
-101 -10 0
-100 -11 0
0 0 0
-0x1.4e2p+11 0x1.26p+10 0
-0x1.4p+11 0 0
triangles 2
0 1 2
3 4 5
rays 3
-100.25 -10.25 9 0 0 -1 0 inf
-100.25 -10.25 9 0 0 -1 0 99
-0x1.4e1p+11 0x1.25p+10 0x1p+11 0 0 -1 0 inf
end
END
sed '/ 99$/d; s/^rays 3/rays 2/' "$dir/two.trial" >"$dir/next.trial"
for file in "$dir/two.trial" "$dir/next.trial" "$dir"/many/*.missed.*/first.trial; do
    replayed "$file" 1 played --engine cpu
    again
done
replayed fuzz/corpus/bad-rays.trial 77 skipped --engine cpu,vulkan --driver no-such-driver
replayed fuzz/corpus/bad-rays.trial 0 played --engine cpu,brute

# A tracer, a blind one, and one that ends. A hit on an edge where the triangle's box ends may be lost by slabs; no word
# of that if it is answered, nor inside, nor where nothing is hit, nor where there is no answer.
cat >"$dir/edge.trial" <<'END'
raydiff trial 1
expect clean
builder median leaf 4 eps 0.02
box robust
tri mt
query closest
vertices 3
0 0 0
-1 0 0
0 -1 0
triangles 1
0 1 2
rays 3
-0.25 0 1 0 0 -1 0 9
-0.25 -0.25 1 0 0 -1 0 9
0.25 0.25 1 0 0 -1 0 9
end
END
for tracer in sees blind ends; do
    case $tracer in
    sees) change= ;;
    blind) change='s/size > 0\.0f/size > 1e30f/' ;;
    ends) change='s/        struct ray \*ray = take/        if (q.rays > 0) return 0;\n&/' ;;
    esac
    sed "$change" fuzz/samples/sample_tracer.c >"$dir/$tracer.c"
    cc -O1 -o "$dir/$tracer" "$dir/$tracer.c" || bad "$tracer is not compiled"
    for index in 0 1 2; do
        case $tracer$index in
        blind0) hints=2 code=0 ;;
        blind1) hints=0 code=1 ;;
        ends*) hints=0 code=3 ;;
        *) hints=0 code=0 ;;
        esac
        try $code explain "$dir/edge.trial" --wide --index $index --engine "pipe:$dir/$tracer"
        laws explain 30 -v triangles=1 -v "lost=$hints"
        again
    done
done

# Names with blanks, of files and of tracers.
mkdir "$dir/two words"
sed 's/^expect .*/expect pipe:blind.-.missed.scale/' "$dir/edge.trial" >"$dir/two words/edge.trial"
replayed "$dir/two words/edge.trial" 1 played --engine "pipe:$dir/blind  "
again
cp fuzz/corpus/wrong-item.trial "$dir/two words"
replayed "$dir/two words/wrong-item.trial" 1 played --engine cpu
again
explained "$dir/two words/wrong-item.trial" 0

# The driver that is asked belongs to what gets the page again.
for command in replay explain; do
    ran="raydiff $command --driver stock"
    "$raydiff" $command fuzz/corpus/wrong-item.trial --wide --engine vulkan --driver stock >"$dir/text" 2>"$dir/err"
    code=$?
    if [ "$code" -eq 77 ]; then
        echo "SKIP $ran: $(tail -n 1 "$dir/err")"
    else
        [ "$code" -eq 1 ] || bad "$ran: exit $code"
        grep -q '^again .* --driver stock$' "$dir/text" || bad "$ran: another driver may be asked again"
        again
    fi
done

echo "values_findings: $failed failed"
[ "$failed" -eq 0 ]
