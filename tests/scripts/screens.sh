#!/bin/sh
# What a person sees on terminals of 80, 120 and 200 columns: no line is longer, the verdict comes first, and the
# screen is the one that docs/screens shows, times masked. Colours are on terminals alone.
#   sh tests/scripts/screens.sh RAYDIFF [--write]      --write: makes docs/screens anew
set -u
raydiff=$(realpath "$1")
write=${2:-}
command -v script >/dev/null || { echo "SKIP screens: script (util-linux) is not installed"; exit 77; }
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $*"
    failed=$((failed + 1))
    [ "$failed" -lt 10 ] || { echo "$failed failed, the rest is left out" >&2; exit 1; }
}
# columns, arguments: what a terminal shows; what stands before a carriage return, as progress does, is overwritten
on_terminal() {
    columns=$1
    shift
    TERM=xterm script -qec "stty cols $columns; '$raydiff' $*" /dev/null </dev/null | perl -pe 's/\r*\n/\n/; s/^.*\r//s' | sed "s|$dir/||g" >"$dir/screen"
}
plain() { sed 's/\x1b\[[0-9;]*[mK]//g' "$1"; }
# A line with those that continue it.
whole() { awk '/^    / { sub(/^ */, " "); line = line $0; next } NR > 1 { print line } { line = $0 } END { print line }'; }
# Times differ from run to run, and with them the width of their columns; of a benchmark all fractions are masked.
# Versions of Embree and of drivers have other hits, and more rows.
bench_masked() {
    case $name in
    bench-fuzz) sed -E 's/[0-9][-0-9.]*/#/g' ;; # as many workers as there are cores
    bench*) sed -E '/ left out: |left out, not fetched|rayquery|avx512|^  (plain|sse2|avx2|neon) |^[^ ]+ +teapot/d; /^[^ ]+ +.*embree/s/[0-9]+/#/g; s/[0-9]+\.[0-9]+(e[-+][0-9]+)?(-[0-9.e]+)?/#/g; s/% (less|more)/% #/; s/[03] to warm up/# to warm up/; s/(front of size, speed and lost hits: ).*/\1#/; s/^(bench [a-z]+: )[0-9]+ row/\1# row/' ;;
    leaks) sed -E '/^[a-z]+ +- +embree/s/[0-9]+/#/g' ;; # some processors estimate reciprocals otherwise
    *) cat ;;
    esac
}
masked() {
    plain "$1" | whole | bench_masked |
        sed -E 's/ in [0-9.]+ s,/ in # s,/; s/[0-9]+\.[0-9]{3}(-[0-9]+\.[0-9]{3})?/#/g; s/[0-9]+\.[0-9]+ times (its|the) speed(, within noise)?/# times/; s/; [^;]* on [a-z_]+ has [0-9.]+ times f32.s speed|; speeds cannot be told apart/; fastest/; s/ +/ /g; s/ $//'
}

# name, arguments
screen() {
    name=$1
    shift
    for columns in $widths; do
        on_terminal "$columns" "$*"
        plain "$dir/screen" >"$dir/plain"
        awk -v most="$columns" 'length($0) > most && !/^again / { print FILENAME ": " length($0) " columns: " $0; bad = 1 } END { exit bad }' "$dir/plain" ||
            bad "$name at $columns columns"
        page=docs/screens/$(echo "$name" | sed 's|^bench-|bench/|')-$columns.txt
        [ "$write" = --write ] && { mkdir -p "$(dirname "$page")"; cp "$dir/plain" "$page"; }
        masked "$page" >"$dir/wanted"
        masked "$dir/screen" >"$dir/got"
        cmp -s "$dir/wanted" "$dir/got" || { bad "$page is not what is printed"; diff "$dir/wanted" "$dir/got" | head -5; }
        sed 's/agrees/Agrees/; s/kept/Kept/; s/passed/Passed/; s/FAILS/Fails/; s/WRONG/Wrong/; s/none/None/; s/median/Median/; s/clock/Clock/; s/judged/Judged/; s/nearest/Nearest/' "$dir/got" >"$dir/other"
        cmp -s "$dir/wanted" "$dir/other" && bad "$page: a changed line is not noticed"
    done
}
few='--count 2000 --repeat 2 --threads 1'
widths='80 120 200'
screen check check sphere --layout f32,rf16,cwbvh80,rtrs_rf --engine cpu,vulkan,fast "$few"
screen leaks leaks sphere:n=8 --layout f32 --engine cpu,vulkan,embree,embree_robust --tri mt,woop --box watertight --count 2000 --threads 1
screen conform conform "'*.f32.median.robust.mt.platonic.primary.1'" --engine cpu,fast --count 50 --threads 1
screen replay replay fuzz/corpus/rounded-inward.trial --engine cpu,embree --threads 1 --brief
screen explain explain fuzz/corpus/rounded-inward.trial
screen bench-error bench error --scene sphere:n=6 --count 200 --rounds 3 --engine cpu --layout f32,rf16,rtrs_rf --tri mt,woop --rays edges --threads 1
screen bench-spawn bench spawn --scene sphere:n=4 --count 60 --engine cpu --tri mt --threads 1
screen bench-builders bench builders --scene sphere:n=6 --rounds 3 --threads 1
screen bench-matrix bench matrix --scene sphere:n=5 --count 160 --rounds 1 --threads 1 --engine cpu,fast --layout f32,rf16
screen bench-tightness bench tightness --scene soup:n=50 --count 50
screen bench-traffic bench traffic --scene sphere:n=6 --count 300 --depths 1,4 --layout f32,cwbvh80
screen bench-frames bench frames --scene sphere:n=6 --engine cpu --layout f32,rf16,cwbvh80 --frames 3 --size 16x12 --out "$dir/frames"
screen bench-oracle bench oracle --scene sphere:n=6 --count 200 --rounds 1
screen bench-fast bench fast --scene sphere:n=6 --count 200 --rounds 1 --threads 1
screen bench-worlds bench worlds --scene sphere:n=6 --count 200 --rounds 1 --instances 50 --threads 1
screen bench-fuzz bench fuzz --count 20 --rounds 1 --engine cpu --layout f32
# What takes longest is shown on the narrowest and the widest, or on the narrowest alone.
widths='80 200'
screen bench-layouts bench layouts --scene sphere:n=6 --count 60 --rounds 1 --threads 1
screen bench-special bench special --size 16x12 --frames 4 --out "$dir/special"
widths=80
screen bench-paper bench paper --size 16x12 --frames 2 --scene rtrs --out "$dir/paper"

# Other commands fit 80 columns, too: what is wrong, the end of a campaign, lists. Commands to copy stay whole.
fits() {
    on_terminal 80 "$*"
    sed "s/\x1b\[[0-9;]*[a-zA-Z]//g" "$dir/screen" | awk '/^ *(raydiff|explain:|look:|replay|again|to shrink) / { next }
        length($0) > 80 { print length($0) " columns: " $0; bad = 1 } END { exit bad || NR < 3 }' || bad "$* at 80 columns"
}
sed 's/size > 0\.0f/size > 1e30f/' fuzz/samples/sample_tracer.c >"$dir/blind.c"
cc -O1 -o "$dir/blind" "$dir/blind.c" || bad 'a tracer is not compiled'
fits check sphere:n=4 --engine "'cpu,pipe:$dir/blind'" --layout f32 "$few"
plain "$dir/screen" | grep -c '^  explain: ' | grep -qx 1 || bad 'check: on a terminal not one command of a row'
fits check mixed --engine cpu,brute --layout f32,rf16 --query closest,all --count 200
grep -q '^    *[a-z ]*flags mixed, seed 1' "$dir/screen" || bad 'check: the head of a world stands in one line, or lacks its rays'
fits fuzz --trials 16 --engine cpu,vulkan --layout f32,rtrs_rf --faithful --no-shrink --corpus none --jobs 1 --dir "$dir/found"
fits min fuzz/corpus/rounded-inward.trial --out "$dir/small.trial"
fits doctor
# What continues a line begins beneath a word of it, or of one just before where a long name stands in the way.
beneath() {
    awk '{ match($0, /^ */) }
        RLENGTH > 6 {
            more++
            for (i = 0; i < 3 && !(substr(head[i], RLENGTH, 1) == " " && substr(head[i], RLENGTH + 1, 1) ~ /[^ ]/); i++) continue
            if (i == 3) { print "not beneath a word: " $0; bad = 1 }
            next
        }
        { head[heads++ % 3] = $0 }
        END { exit bad || more < 5 }' "$dir/screen" || bad "$1 at 80 columns: what continues a line"
}
for listed in list 'scene list'; do fits "$listed" && beneath "$listed"; done
fits diff rtrs --engine cpu,vulkan,embree --width 16 --height 12
fits bench error --scene sphere:n=4 --count 60 --rounds 1

# Progress fits the terminal, and says about how long the rest takes: as long as what is done took.
TERM=xterm script -qec "stty cols 80; timeout 4 '$raydiff' conform --count 400 --threads 1" /dev/null </dev/null | tr '\r' '\n' | grep left | plain /dev/stdin >"$dir/progress"
awk -F '[ ,:]+' '
    length($0) > 79 { print "longer than the terminal: " $0; bad = 1 }
    { rest = $3 * ($11 - $9 + 1) / ($9 - 1); lines++ }
    $5 "" != "about" || $6 < rest * 0.7 - 2 || $6 > rest * 1.4 + 2 { print "not about " rest " s: " $0; bad = 1 }
    END { exit bad || lines < 2 }' "$dir/progress" || bad 'progress'

# Colours: on terminals, as --color and NO_COLOR tell; never in a pipe by itself.
escape=$(printf '\033')
one="check sphere:n=8 --layout f32 --engine cpu $few"
colours() { grep -q "$escape\\[" "$1"; }
on_terminal 80 "$one"
colours "$dir/screen" || bad 'no colour on a terminal'
on_terminal 80 "$one --color never"
colours "$dir/screen" && bad '--color never colours'
NO_COLOR=1 && export NO_COLOR
on_terminal 80 "$one"
colours "$dir/screen" && bad 'NO_COLOR is not obeyed'
on_terminal 80 "$one --color always"
colours "$dir/screen" || bad '--color always does not outweigh NO_COLOR'
unset NO_COLOR
TERM=xterm $raydiff $one >"$dir/out" # also where this machine says TERM=dumb
colours "$dir/out" && bad 'colour in a pipe'
$raydiff $one --color always >"$dir/out"
colours "$dir/out" || bad '--color always has no colour in a pipe'
# Without a terminal, and on a narrow one: 80 columns.
on_terminal 40 "$one"
masked "$dir/screen" >"$dir/narrow"
plain "$dir/out" >"$dir/piped"
masked "$dir/piped" | cmp -s - "$dir/narrow" || bad 'a terminal of 40 columns is not treated as one of 80'
echo "screens: $failed failed"
[ "$failed" -eq 0 ]
