#!/bin/sh
# The screens of raydiff fuzz in a terminal of 80, 120 and 200 columns (tmux): playing, paused with a finding shown, and
# after the end, compared with docs/screens/fuzz-*.txt. Numbers, names of findings and the trend differ from run to run;
# they are masked, and lines that are then alike are one.
#   sh tests/docs/fuzz_picture.sh RAYDIFF [--write]      --write: makes docs/screens/fuzz-*.txt anew
set -u
raydiff=$(realpath "$1")
write=${2:-}
command -v tmux >/dev/null || { echo "SKIP fuzz_picture: tmux is not installed"; exit 77; }
dir=$(mktemp -d) || exit 4
terminal() { TMUX='' tmux -S "$dir/socket" -f /dev/null "$@"; }
trap 'terminal kill-server 2>/dev/null; rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $*"
    failed=$((failed + 1))
}
# What stands on the screen, without the empty lines below.
shown() { terminal capture-pane -p | sed "s|$dir/||g" | sed -e :a -e '/^\n*$/{$d;N;ba' -e '}'; }
# pattern: waits until a line of the screen matches
until_shown() {
    i=0
    while [ $i -lt 200 ]; do
        shown >"$dir/now"
        grep -qE "$1" "$dir/now" && return
        sleep 0.2
        i=$((i + 1))
    done
    bad "no '$1' on the screen"
    cat "$dir/now"
}
# Waits until the screen, which is paused, stays as it is: a terminal shows what is written to it piece by piece.
still() {
    shown >"$dir/now"
    for i in 1 2 3 4 5 6 7 8 9 10; do
        mv "$dir/now" "$dir/before"
        sleep 0.2
        shown >"$dir/now"
        cmp -s "$dir/before" "$dir/now" && return
    done
}
masked() {
    sed -E 's/\|[^|]*\|/|trend|/; s/^(verdicts  right .*, wrong [^,]*),.*/\1, others/; s/cpu\.rtrs_rf_paper\.[a-z_]+\.[a-z_.]+/NAME/; s/(NAME).*/\1/; s/^  triangle .*|^  a .*|^  the .*|^  an .*/  cause/; s/[0-9][0-9.e+]*/#/g; s/[0-9]# triangles?/# triangles/; s/# triangles?, # rays?/size/; s/ +/ /g; s/ $//' "$1" |
        grep -vE '^ (again|\.\.\. and) ' | uniq
}
# name, columns: compares what stands there with its page
picture() {
    page=docs/screens/$1-$2.txt
    still
    awk -v most="$2" 'length($0) > most { exit 1 }' "$dir/now" || bad "$1 is wider than $2 columns"
    [ "$write" = --write ] && cp "$dir/now" "$page"
    masked "$page" >"$dir/wanted"
    masked "$dir/now" >"$dir/got"
    cmp -s "$dir/wanted" "$dir/got" || { bad "$page is not what is shown"; diff "$dir/wanted" "$dir/got" | head -8; }
    sed 's/findings/Findings/; s/verdicts/Verdicts/; s/q end/Q end/' "$dir/got" >"$dir/other"
    cmp -s "$dir/wanted" "$dir/other" && bad "$page: a changed line is not noticed"
}
for columns in 80 120 200; do
    rm -rf "$dir/found"
    terminal new-session -d -x "$columns" -y 30 \
        "cd '$dir'; '$raydiff' fuzz --engine cpu --layout rtrs_rf_paper,f32 --corpus none --no-shrink --dir found --time 300; sleep 60"
    until_shown '^findings  [4-9]'
    terminal send-keys p
    until_shown PAUSED
    picture fuzz "$columns"
    terminal send-keys f
    until_shown '^finding   1 of'
    picture fuzz-finding "$columns"
    terminal send-keys q
    until_shown '^findings   [0-9]+ distinct'
    terminal kill-server
done
echo "fuzz_picture: $failed failed"
[ "$failed" -eq 0 ]
