#!/bin/sh
# Folders of findings that somebody else made, or damaged: nothing outside them is written, nothing is
# waited for, and what contradicts itself is refused in one line.
#   sh tests/scripts/folders.sh PROGRAM
set -u
[ -w /dev/shm ] && export TMPDIR=/dev/shm # nothing here is to outlive a crash of the machine
. tests/scripts/expect.sh
program=$(realpath "$1") raydiff=$dir/raydiff
echo "exec timeout 20 '$program' \"\$@\"" >"$raydiff" && chmod +x "$raydiff" # nothing is waited for
export OMP_NUM_THREADS=1

small="--rays 8 --triangles 1-4 --jobs 1 --corpus none --no-shrink --feedback"
expect 1 . fuzz $small --engine cpu --layout rtrs_rf --faithful --trials 20 --seed 9 --dir "$dir/good"
signature=cpu.rtrs_rf.missed.index_shifted
[ -s "$dir/good/$signature/smallest.trial" ] || bad "the campaign finds $signature"
[ -d "$dir/good/corpus" ] || bad "the campaign keeps a corpus"
cp "$dir/good/$signature/smallest.trial" "$dir/victim"

# A fresh copy of the folder, beside a folder and a file of its user, which must stay as they are.
fresh() {
    rm -rf "$dir/theirs" "$dir/outside"
    cp -r "$dir/good" "$dir/theirs"
    mkdir "$dir/outside"
    cp "$dir/victim" "$dir/outside/file"
}
untouched() {
    [ "$(ls "$dir/outside")" = file ] && cmp -s "$dir/victim" "$dir/outside/file" || bad "$1: something outside was written"
}

# Codes of fuzz, min, merge and report (- is not played), a pattern. Each on a copy of what is in theirs.
meet() {
    left=$1 pattern=$2
    rm -rf "$dir/hostile"
    mv "$dir/theirs" "$dir/hostile"
    for command in fuzz min merge report; do
        code=${left%%,*} left=${left#*,}
        rm -rf "$dir/theirs" "$dir/new" "$dir/other"
        cp -a "$dir/hostile" "$dir/theirs"
        [ "$pattern" = "$two_names" ] && ln "$dir/theirs/findings.jsonl" "$dir/other"
        [ "$code" = 2 ] && expected=$pattern || expected=.
        case $command,$code in
        *,-) ;;
        fuzz,*) expect "$code" "$expected" fuzz --dir "$dir/theirs" --trials 30 --jobs 1 --corpus none --feedback --no-shrink ;;
        min,*) expect "$code" "$expected" min "$dir/theirs" --asks 1 ;;
        merge,*) expect "$code" "$expected" merge --to "$dir/new" "$dir/theirs" ;;
        report,*) expect "$code" "$expected" report --findings "$dir/theirs" --out "$dir/report.html" ;;
        esac
        untouched "$command"
        [ "$command $code" = "merge 2" ] && [ -e "$dir/new" ] && bad "merge refuses and writes"
    done
}
two_names='findings.jsonl: has 2 names'

# What must be a file of it, and is a link to one, to nothing, a named pipe or a folder. Only fuzz reads
# stats.json and corpus.
for place in stats.json:2,0,0,- findings.jsonl:2,2,2,2 $signature/first.trial:2,2,2,2 $signature/smallest.trial:2,2,2,2 \
    $signature/count:2,2,2,-; do
    codes=${place#*:} place=${place%:*}
    fresh
    ln -sf "$dir/outside/file" "$dir/theirs/$place"
    meet "$codes" "$place: is a symbolic link, not a file: left unchanged"
    codes=${codes%,*},-
    fresh
    ln -sf "$dir/outside/new" "$dir/theirs/$place"
    meet "$codes" "$place: is a symbolic link"
    fresh
    rm "$dir/theirs/$place" && mkfifo "$dir/theirs/$place"
    meet "$codes" "$place: is a named pipe, not a file"
    fresh
    rm "$dir/theirs/$place" && mkdir "$dir/theirs/$place"
    meet "$codes" "$place: is a folder, not a file"
done

# What must be a folder of it.
for place in $signature:2,2,2,2 corpus:2,0,0,-; do
    codes=${place#*:} place=${place%:*}
    fresh
    rm -r "${dir:?}/theirs/$place" && ln -s "$dir/outside" "$dir/theirs/$place"
    meet "$codes" "$place: is a symbolic link, not a folder"
    fresh
    rm -r "${dir:?}/theirs/$place" && echo text >"$dir/theirs/$place"
    meet "$codes" "$place: is a file, not a folder"
done

# A second name of the log: appending to it would write there, too.
fresh
meet 2,2,0,- "$two_names"

# A log that contradicts itself, or the files beside it. `awk` changes its lines; the first finding is line 2.
changed() {
    fresh
    awk "$1" "$dir/good/findings.jsonl" >"$dir/theirs/findings.jsonl"
    cmp -s "$dir/good/findings.jsonl" "$dir/theirs/findings.jsonl" && bad "/$1/ changes the log"
    meet 2,2,2,- "$2"
}
lines=$(wc -l <"$dir/good/findings.jsonl")
changed '1; NR == 5' 'findings.jsonl:6: the finding of an earlier line once more'
changed "1; NR == 5 { kept = \$0 } END { print kept }" "findings.jsonl:$((lines + 1)): the finding of an earlier line"
changed 'NR != 5' 'findings.jsonl:[0-9]+: the lines before it have not as many findings'
changed 'NR < 5' 'count: [0-9]+, but findings.jsonl has [0-9]+: lines of it are lost'
changed 'NR == 1' 'count: [0-9]+, but findings.jsonl has 0: lines of it are lost'
changed 'NR < 0' 'count: [0-9]+, but findings.jsonl has 0: lines of it are lost'
awk '/"checkpoint"/ && /"more":[{][}]/ { sub(/"more":[{][}]/, "\"more\":{\"'$signature'\":3}") } 1' "$dir/good/findings.jsonl" >"$dir/more"
fresh && mv "$dir/more" "$dir/theirs/findings.jsonl"
meet 2,2,2,- 'findings.jsonl:1: the lines before it have not as many findings'

# A log that is gone. Nothing new is left there.
fresh && rm "$dir/theirs/findings.jsonl"
meet 2,2,2,- '(count: [0-9]+, but findings.jsonl has 0|findings.jsonl: No such file|is no folder of findings)'
[ -e "$dir/theirs/findings.jsonl" ] && bad "a refused folder gets no log"
fresh && rm -r "$dir/theirs/findings.jsonl" "$dir/theirs/cpu."*
meet 2,2,2,- '(stats.json: exists, but findings.jsonl has no checkpoint|findings.jsonl: No such file|is no folder)'

# Files that are gone.
for place in $signature/first.trial $signature/smallest.trial $signature; do
    fresh && rm -r "$dir/theirs/$place"
    meet 2,2,2,2 "findings.jsonl:[0-9]+: a finding whose $signature/[a-z]*.trial is gone"
done

# What a kill can leave is no contradiction: files of a finding that has no line yet, and counts of before.
fresh
mkdir "$dir/theirs/cpu.rtrs_rf.phantom.stack"
sed "s/^expect .*/expect cpu.rtrs_rf.phantom.stack/" "$dir/victim" >"$dir/theirs/cpu.rtrs_rf.phantom.stack/first.trial"
echo 1 >"$dir/theirs/$signature/count"
: >"$dir/theirs/cpu.rtrs_rf.tree.sentinel/count"
meet 1,1,0,- .

# A folder and its copy are one campaign, not two.
fresh
cp -r "$dir/good" "$dir/copy"
expect 0 . merge --to "$dir/new" "$dir/good"
before=$(tail -n +2 "$dir/out" | sed 's/^to.*: //')
rm -rf "$dir/new"
expect 0 . merge --to "$dir/new" "$dir/good" "$dir/copy"
[ "$before" = "$(tail -n +3 "$dir/out" | sed 's/^to.*: //')" ] || bad "merging a copy counts its findings again"

# A trial named on the command line may be anywhere; what min writes beside it is no link.
fresh
ln -s "$dir/outside/file" "$dir/theirs/$signature/smallest.min.trial"
expect 2 'smallest.min.trial is a symbolic link' min "$dir/theirs/$signature/smallest.trial" --force --asks 1
untouched min

# A folder of a generator's name hides no generator.
mkdir "$dir/plain" "$dir/hidden" "$dir/hidden/sphere" "$dir/hidden/sphere:n=3" "$dir/hidden/crowd:n=4"
program=$(realpath "$raydiff") seen=0
for name in sphere sphere:n=3 crowd:n=4; do
    for command in 'scene info NAME' 'explain NAME --engine cpu --index 2' \
        'leaks NAME --engine cpu --layout f32 --count 100' 'gen NAME --count 5' 'explain NAME --query all --engine cpu --index 2' \
        'precompute --scene NAME --out tree.json' 'build NAME --same 1 --layout f32 --builder median' 'diff NAME --engine cpu,brute -w 8 -h 6'; do
        for place in plain hidden; do
            (cd "$dir/$place" && "$program" $(echo "$command" | sed "s/NAME/$name/") 2>&1; echo "exit $?") |
                sed -E 's/[0-9.]+ (ms|s|us|ns|Mray)/#/g; s/ +[0-9]+\.[0-9]+/ #/g' >"$dir/$place.out"
        done
        cmp -s "$dir/plain.out" "$dir/hidden.out" || { cp "$dir/hidden.out" "$dir/out"; bad "$command: beside a folder $name"; }
        grep -q '^exit 0$' "$dir/plain.out" && seen=$((seen + 1))
    done
done
[ "$seen" -ge 14 ] || bad "only $seen commands take a generator"

echo "folders: $failed failed"
[ "$failed" -eq 0 ]
