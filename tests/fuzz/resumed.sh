#!/bin/sh
# Law of campaigns: one that is run in parts, with whatever options each part may have, ends with the folder and
# the numbers of one that is run at once; and a contestant's findings do not depend on who else takes part.
#   sh tests/fuzz/resumed.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh
campaign="--rays 40 --engine cpu --faithful --seed 9"
two="$campaign --layout rf16,f32 --corpus fuzz/corpus"

# Folder, which part of it, then its options: plays it. What the part counted is left in FOLDER.PART, flat.
part() {
    name=$1 number=$2
    shift 2
    expect 1 . fuzz --dir "$dir/$name" --json "$dir/json" "$@" >>"$dir/log" || bad "$name: part $number"
    awk -f tests/values/flat.awk "$dir/json" >"$dir/$name.$number" || bad "$name: JSON"
}
# Two folders in the form in which folders are compared.
same_folders() {
    for name in "$1" "$2"; do
        [ -e "$dir/$name.merged" ] || "$raydiff" merge --to "$dir/$name.merged" "$dir/$name" >"$dir/out" 2>"$dir/err" ||
            bad "merge $name"
    done
    diff -r "$dir/$1.merged" "$dir/$2.merged" >"$dir/out" 2>"$dir/err" || bad "$2 is another campaign than $1"
}
# What the last part has of the whole campaign, and the sums over all parts of what each has of itself.
numbers() {
    last=$(ls "$dir/$1".[0-9]* | tail -n 1)
    sed -nE "s#$dir/$1/#DIR/#
        /^(findings|contestants|coverage|seed|exit)[.=]/{/(refused|unasked)_in_this_run/d; /never/d; p;}" "$last"
    sed -nE 's/^(trials|corpus|mutants|rays|judged|at_fault|verdicts\.[a-z_]*|.*(refused|unasked)_in_this_run)=/\1 /p' "$dir/$1".[0-9]* |
        awk '{ sum[$1] += $2 } END { for (name in sum) print "sum " name " " sum[name] }' | sort
}
same_as_whole() {
    same_folders whole "$1"
    awk -F= '{ v[$1] = $2 } END { exit v["trials_before"] + v["trials"] - v["corpus"] != 96 }' \
        "$(ls "$dir/$1".[0-9]* | tail -n 1)" >"$dir/out" 2>"$dir/err" || bad "$1 says other trials than 96, earlier ones with them"
    numbers whole >"$dir/numbers"
    numbers "$1" >"$dir/other"
    [ "$(grep -cE '^(sum (rays|judged|verdicts|corpus)|findings.*count=|contestants.*answered=)' "$dir/numbers")" -ge 14 ] ||
        bad "there are numbers to compare"
    diff "$dir/numbers" "$dir/other" >"$dir/out" 2>"$dir/err" || bad "$1 counts otherwise than the whole"
}

part whole 1 $two --trials 96 --jobs 2
small=$(cat "$dir/whole"/*/smallest.trial | grep -c '^vertices')
[ "$small" -ge 3 ] || bad "there are findings to compare"

# Ended early within a block, without shrinking, by one worker; then a part that plays nothing but shrinks.
part left 1 $two --trials 41 --jobs 1 --no-shrink
part left 2 --trials 96 --jobs 3 --no-shrink
cp -r "$dir/left" "$dir/min"
part left 3 --trials 96 --jobs 2 --trial-time 9 --memory 5000
same_as_whole left

# Ended by the number of findings, gone on with options that change neither trials nor findings.
part until 1 $two --trials 96 --jobs 2 --until 1 --no-shrink
awk -F= '$1 == "trials" && $2 + 0 < 96 { few = 1 } END { exit !few }' "$dir/until.1" || bad "--until 1 ends it early"
part until 2 --trials 96 --jobs 1 --time 600 --seed 9 --rays 40 --layout rf16,f32
same_as_whole until

# Ended by the number of findings it shrinks those that it has.
part early 1 $campaign --layout rf16,f32 --corpus none --trials 96 --jobs 2 --until 1
awk -F= '$1 ~ /^findings\.[0-9]+\.triangles$/ { found++; large += $2 > 4 } END { exit !found || large > 0 }' "$dir/early.1" ||
    bad "--until 1 leaves findings as they are"

# What raydiff min makes of it is what the campaign's own shrinking makes.
expect 0 . min "$dir/min" >>"$dir/log"
same_folders whole min

# Killed while a shrunk finding is written: it is shrunk if its file was there, and is shrunk anew if it was not. The
# log up to that is taken from a campaign that shrank all of them.
log=findings.jsonl
shrunk() { tail -n 1 "$1/$log" | sed 's/.*|shrunk=\([01]*\).*/\1/'; }
sed -nE 's/^\{"signature":"([^"]*)".*/\1/p' "$dir/whole/$log" | awk '!seen[$0]++' >"$dir/signatures"
all=$(shrunk "$dir/whole")
case $all in *0* | '') bad "whole: not all are shrunk: $all" ;; esac
for k in $(grep -o 'offered=[0-9]*' "$dir/whole/$log" | sed 's/.*=//' | sort -nu); do
    for file in there lost; do
        killed="$dir/killed$k$file"
        cp -r "$dir/whole" "$killed"
        line=$(grep -n "offered=$k:" "$killed/$log" | tail -n 1 | cut -d : -f 1)
        was=$(sed -n "${line}s/.*|shrunk=\([01]*\).*/\1/p" "$killed/$log")
        head -n "$line" "$dir/whole/$log" >"$killed/$log"
        of="$killed/$(sed -n "$((k + 1))p" "$dir/signatures" | tr : =)"
        if [ $file = lost ]; then
            cmp -s "$of/first.trial" "$of/smallest.trial" && continue
            cp "$of/first.trial" "$of/smallest.trial"
        fi
        wanted=$(echo "$was" | awk -v k="$k" -v there="$([ $file = there ] && echo 1 || echo 0)" \
            '{ print substr($0, 1, k) there substr($0, k + 2) }')
        expect 1 . fuzz --dir "$killed" --trials 96 --jobs 1 --no-shrink >>"$dir/log"
        [ "$(shrunk "$killed")" = "$wanted" ] || bad "killed at finding $k, its file $file: shrunk are $(shrunk "$killed"), not $wanted"
        kills=$((${kills:-0} + 1))
    done
    expect 1 . fuzz --dir "$dir/killed${k}there" --trials 96 --jobs 1 >>"$dir/log"
    same_folders whole "killed${k}there"
done
[ "${kills:-0}" -ge 6 ] || bad "only ${kills:-0} findings are written when it is killed"

# An option that would change it is refused, and the folder stays.
cp -r "$dir/min" "$dir/kept"
for other in '--layout f32' '--layout rf16,f32,half4' '--rays 41' '--triangles 16-65' '--engine brute' \
    '--builder median' '--shard 1/2' '--pairs 3' '--seed 8'; do
    expect 2 '.*the campaign in .* has |--pairs: draws members' fuzz $other --trials 128 --dir "$dir/min" >>"$dir/log"
    diff -r "$dir/kept" "$dir/min" >"$dir/out" 2>"$dir/err" || bad "fuzz $other: refused, and the folder is changed"
done

# The folder has what decides its trials, the smallest values as well, and goes on by it.
for given in 'seed 0' 'shard 1/1' 'shard 2/2' 'rays 1' 'triangles 1-1' 'engine brute' 'layout rf16' 'builder lbvh' 'pairs 1' faithful worlds steps; do
    key=${given% *}
    [ "$key" != "$given" ] && value=${given#* } || value=yes
    case $key in engine) of= ;; layout) of='--engine cpu' ;; *) of='--engine cpu --layout f32' ;; esac
    rm -rf "$dir/key"
    "$raydiff" fuzz $of --$given --trials 1 --jobs 1 --corpus none --no-shrink --dir "$dir/key" >"$dir/out" 2>"$dir/err"
    head -n 1 "$dir/key/$log" | sed 's/"checkpoint":"/&|/' | grep -qF "|$key=$value|" || bad "--$given is not in the folder"
done

# Each layout by itself, in any order.
one="$campaign --corpus none --no-shrink --trials 96"
part both 1 $one --layout rf16,f32 --jobs 2
part a 1 $one --layout f32 --jobs 1
part b 1 $one --layout rf16 --jobs 1
"$raydiff" merge --to "$dir/ab.merged" "$dir/b" "$dir/a" >"$dir/out" 2>"$dir/err" || bad "merge a b"
same_folders both ab

# With members drawn: which pairs met, on any number of workers.
pairs="--rays 40 --engine cpu,fast,brute --seed 9 --layout every --pairs 1 --corpus none --trials 1280"
expect 1 . fuzz --dir "$dir/pairs" --jobs 2 $pairs >>"$dir/log"
expect 1 . fuzz --dir "$dir/drawn" --jobs 3 $pairs >>"$dir/log"
cmp "$dir/pairs/pairs.txt" "$dir/drawn/pairs.txt" >"$dir/out" 2>"$dir/err" || bad "other workers, other pairs"
grep '^FAILED' "$dir/log"
echo "resumed: $failed failed"
[ "$failed" -eq 0 ]
