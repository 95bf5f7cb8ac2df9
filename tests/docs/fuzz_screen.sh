#!/bin/sh
# The screen of raydiff fuzz on a terminal: what it shows, its keys, and that the terminal is given back.
#   sh tests/docs/fuzz_screen.sh RAYDIFF
set -u
raydiff=$(realpath "$1")
script -qec true /dev/null >/dev/null 2>&1 </dev/null || { echo "SKIP script(1) gets no pseudo-terminal here"; exit 77; }
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $*"
    failed=$((failed + 1))
}
TERM=xterm
export TERM
# Keys, and what must be on the screen before the next one, "f @finding q". Then the screens, one after the other.
play() { # rows, columns, keys, options
    rows=$1 columns=$2 keys=$3
    shift 3
    rm -rf "$dir/found" "$dir/out"
    (
        for key in @findings..[2-9] $keys; do
            i=0
            case $key in
            @*) while [ $i -lt 150 ] && ! grep -q "${key#@}" "$dir/out" 2>/dev/null; do sleep 0.2; i=$((i + 1)); done ;;
            *) printf %s "$key" ;;
            esac
        done
        sleep 2
    ) | script -qefc "stty rows $rows cols $columns; stty -g >'$dir/before'; '$raydiff' fuzz --engine cpu --layout rtrs_rf_paper,f32 \
        --corpus none --no-shrink --dir '$dir/found' $*; echo ended with \$?; stty -g >'$dir/after'" "$dir/out" >/dev/null 2>&1
    sed 's/\x1b\[[0-9;]*[mKJ]//g; s/\r//g' "$dir/out" >"$dir/text"
}
has() { grep -qE "$1" "$dir/text" || bad "$2: no '$1'"; }

start=$(date +%s)
play 30 100 'f @finding...1 p @PAUSED p @pause...f.the q' --time 60
[ $(($(date +%s) - start)) -lt 55 ] || bad 'q does not end it'
has '^ended with 1$' 'q'                                   # its findings are new
has '^findings   [2-9] distinct' 'results after q'
cmp -s "$dir/before" "$dir/after" || bad 'the terminal is not given back'
has 'raydiff fuzz: playing, seed 1, [0-9]+ s, [0-9]+ s left$' 'the head'
has '^trials    [0-9]+ \([0-9]+/s\) \|[ .:=+*#-]*\|$' 'the trend'
has '^findings  [2-9]: [2-9] new, the last [0-9]+ s ago$' 'the findings'
has '^  NEW +[0-9]+ s +[0-9]+ x  cpu\.rtrs_rf_paper\.[a-z_]+\.[a-z_]+' 'the list'
has '^p pause   f show a finding   q end$' 'the keys'
has '^finding   1 of [0-9]+$' 'f'
has "^  raydiff replay $dir/found/cpu.rtrs_rf_paper.*trial$" 'the command of f'
has 'raydiff fuzz: PAUSED, ' 'p'
has '^p go on ' 'the keys while it is paused'
# While it is paused nothing is drawn: the next screen is of after it.
awk '/raydiff fuzz: PAUSED/ { paused = 1; at = ""; next } /^trials / && paused { if (at == "") at = $2; else { later = $2; exit } }
    END { exit !(later != "" && later + 0 >= at + 0) }' "$dir/text" || bad 'it does not go on after the second p'
# Colours, and none.
grep -q "$(printf '\033')\[1;31m" "$dir/out" || bad 'no colour of a new finding'
NO_COLOR=1 && export NO_COLOR
play 14 60 '@...and.[0-9] q' --time 60
unset NO_COLOR
grep -q "$(printf '\033')\[1;31m" "$dir/out" && bad 'NO_COLOR is not obeyed'
has '^  \.\.\. and [0-9]+ more$' 'a low terminal'
awk '/^raydiff fuzz: playing/ { n = 0; on = 1 } /^p (pause|go on)/ { on = 0 } { n++ } on && (length($0) > 59 || n > 13) { print "too large: " $0; bad = 1 } END { exit bad }' "$dir/text" ||
    bad 'a screen of more rows or columns than the terminal'
# Without a terminal to read from it needs no key.
script -qec "'$raydiff' fuzz --trials 64 --engine cpu --layout f32 --corpus none --dir '$dir/other' </dev/null" /dev/null >"$dir/out" 2>&1 ||
    bad 'without keys'
echo "fuzz_screen: $failed failed"
[ "$failed" -eq 0 ]
