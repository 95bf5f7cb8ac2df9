#!/bin/sh
# The help of every command, its man page and the shells' completions: they tell of the same options,
# and the command takes each. What commands take beyond them is refused: tests/scripts/options.sh.
#   sh tests/scripts/help.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh
"$raydiff" help --bash >"$dir/raydiff.bash"
"$raydiff" help --zsh >"$dir/_raydiff"
bash -n "$dir/raydiff.bash" || bad "help --bash is no bash"
if command -v zsh >/dev/null; then
    zsh -n "$dir/_raydiff" || bad "help --zsh is no zsh"
else
    echo "left out: zsh, which is not installed, reads its completion"
fi
# Its quotes are those of a description, which has words like RTRS's.
grep -q "^        \"construct:.*RTRS's" "$dir/_raydiff" || bad "zsh: descriptions are not quoted"

# What bash offers behind these words.
offers() {
    bash -c 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _raydiff; printf "%s\n" "${COMPREPLY[@]}"' \
        "$dir/raydiff.bash" raydiff "$@"
}

# What pages tell of an unknown formula is what the help has.
units=$("$raydiff" check --help | tr -s '\n ' ' ' | sed 's/.*--displacement U[^[]*\[\([0-9]*\)\].*/\1/')
grep -q "at most $units u of their distance" docs/my-engine.md && grep -q "Up to $units units are allowed" docs/black-box.md ||
    bad "pages: an unknown formula may not need $units units"

rows=0
"$raydiff" help --commands >"$dir/commands"
offers '' | grep -vx help | cmp -s - "$dir/commands" || bad "bash offers other commands"
[ "$(grep -c . "$dir/commands")" -ge 20 ] || bad "help --commands: too few"
"$raydiff" help >"$dir/help"
# As people ask for it.
for ask in -h 'help --help' 'help -h'; do
    "$raydiff" $ask 2>/dev/null | cmp -s - "$dir/help" || bad "raydiff $ask is not raydiff help"
done
"$raydiff" version | grep -q '^raydiff [0-9.]*$' || bad 'raydiff version'
"$raydiff" help check --man 2>/dev/null | grep -q '^\.TH RAYDIFF-check 1' || bad 'help check --man is not help --man check'
"$raydiff" help --man | grep -q '; also raydiff fuzz min$' || bad 'the man page does not tell the other name of min'
for command in 'scene info' precompute construct judge; do
    "$raydiff" $command --help | tr -s ' \n' ' ' | grep -q -- '--seed S of generators' || bad "$command --help: a seed of rays"
done
"$raydiff" check soup --lay f32 2>&1 | grep -q 'did you mean --layout? ' || bad 'what --lay begins is not suggested'
[ "$(awk '{ if (length($0) > most) most = length($0) } END { print most }' "$dir/help")" -le 80 ] || bad "help: wider than 80 columns"
# An indented command is the same behind its group's name, for the command and for the shell.
awk '/^  [a-z]/ { group = $1 } /^    [a-z]/ { print group, $1 }' "$dir/help" >"$dir/members"
[ "$(grep -c . "$dir/members")" -ge 9 ] || bad "help: too few members of groups"
while read -r group member; do
    "$raydiff" $group $member --help >"$dir/out" 2>&1 </dev/null
    "$raydiff" $member --help 2>&1 | cmp -s - "$dir/out" || bad "raydiff $group $member is not raydiff $member"
    "$raydiff" help $group $member >"$dir/out"
    "$raydiff" help $member | cmp -s - "$dir/out" || bad "raydiff help $group $member is not help $member"
    offers $group '' | grep -qx $member || bad "bash offers no $member behind $group"
    offers $group $member -- >"$dir/out"
    offers $member -- | cmp -s - "$dir/out" || bad "bash: $group $member has other options than $member"
    ! "$raydiff" $group $group $member >/dev/null 2>&1 </dev/null || bad "raydiff $group $group $member runs"
done <"$dir/members"
while read -r command; do
    "$raydiff" help "$command" >"$dir/help"
    "$raydiff" $command --help >"$dir/alone"
    [ "$(head -n "$(grep -c . "$dir/alone")" "$dir/help" | grep -c .)" -gt 3 ] || bad "help $command prints nothing"
    awk 'length($0) > 80' "$dir/help" >"$dir/out"
    [ ! -s "$dir/out" ] || bad "raydiff $command --help: wider than 80 columns"
    for word in usage: 'exit codes:' example:; do
        grep -q "^$word" "$dir/alone" || bad "raydiff $command --help has no $word"
    done
    "$raydiff" help --man "$command" >"$dir/man"
    for part in NAME SYNOPSIS DESCRIPTION OPTIONS 'EXIT STATUS' EXAMPLES; do
        grep -qx ".SH $part" "$dir/man" || bad "man page of $command: no part $part"
    done
    sed -nE 's/^  (-[a-z], )?--([a-z-]+).*/\2/p' "$dir/help" | sort -u >"$dir/rows"
    grep -o '^\.BI "[^"]*' "$dir/man" | sed 's/^\.BI "//; s/\\//g; s/^-., //; s/^--//; s/ *$//' | sort -u >"$dir/of_man"
    cmp -s "$dir/rows" "$dir/of_man" || bad "$command: its man page has other options than --help"
    offers "$command" -- | sed -n 's/^--//p' | grep -vx help | sort -u >"$dir/of_bash"
    cmp -s "$dir/rows" "$dir/of_bash" || bad "$command: bash offers other options than --help has"
    sed -n "/^    ($command) specs/,/ ;|\$/p" "$dir/_raydiff" | sed -nE "s/^ *'\*?--([a-z-]+).*/\1/p" | grep -vx help |
        sort -u >"$dir/of_zsh"
    cmp -s "$dir/rows" "$dir/of_zsh" || bad "$command: zsh offers other options than --help has"
    bare=" $(sed -nE 's/^  (-[a-z], )?--([a-z-]+)( *$|  .*)/\2/p' "$dir/help" | tr '\n' ' ')"
    # Each is taken: then the option behind it is the one that is wrong, or its value.
    while read -r option; do
        rows=$((rows + 1))
        form=
        case "$command $option" in
        'diff max') form=a.png ;;
        'fuzz only' | 'fuzz control' | 'fuzz programs' | 'fuzz shaders') form=--self-test ;;
        esac
        case $bare in *" $option "*) value= ;; *) value=x ;; esac
        [ $option != baseline ] || value=fuzz/baseline.txt
        "$raydiff" $command $form --$option $value --no-such-option >"$dir/out" 2>"$dir/err" </dev/null
        code=$?
        said= && IFS= read -r said <"$dir/err"
        case $code,$said in
        *"unknown option: '--$option'"*) bad "raydiff $command --$option: unknown" ;;
        2,*--no-such-option* | 2,*"--$option"*) ;;
        *) bad "raydiff $command --$option: exit $code" ;;
        esac
    done <"$dir/rows"
    expect 2 "unknown option: '--no-such-option'|unexpected" $command --no-such-option >"$dir/passed"
    grep -q '^passed' "$dir/passed" || cat "$dir/passed"
done <"$dir/commands"

# Each example runs as it is printed, in a fresh clone: after 1 s it is still at work or has not been refused.
ln -s "$(pwd)/fuzz" "$dir/fuzz"
ln -s "$(realpath "$raydiff")" "$dir/raydiff"
cat >"$dir/play" <<'END'
set -o pipefail
raydiff() {
    command raydiff "$@"
    code=$?
    case $code in 0 | 1 | 77) ;; *) echo "exit $code: raydiff $*" >>refused ;; esac
    return $code
}
. ./example
END
examples=0
while read -r command; do
    "$raydiff" help "$command" | awk '/^example: / { on = 1; sub("^example: ", "") } /^[^ ]/ && !/^raydiff / { on = 0 } on' >"$dir/example"
    [ -s "$dir/example" ] || bad "help $command: no example"
    examples=$((examples + $(grep -c '^raydiff ' "$dir/example")))
    case $command in fuzz) sed -i 's/--time [0-9]*/--time 1/; /--self-test/d' "$dir/example" ;; esac
    rm -f "$dir/refused"
    (cd "$dir" && PATH="$dir:$PATH" OMP_NUM_THREADS=1 LP_NUM_THREADS=0 timeout 1 bash play) >"$dir/out" 2>"$dir/err" </dev/null
    code=$?
    case $code in 0 | 1 | 77 | 124) ;; *) bad "the example of raydiff $command: exit $code" ;; esac
    [ ! -e "$dir/refused" ] || bad "the example of raydiff $command: $(cat "$dir/refused")"
done <"$dir/commands"
[ "$examples" -ge 25 ] || bad "only $examples examples"

# Values of a table, and of choices, behind the option that takes them.
offers check --builder sah | grep -qx sah_binned || bad "bash: builders behind --builder"
offers check --layout rf | grep -qx rf16 || bad "bash: layouts behind --layout"
offers render --plan '' | grep -qx whole || bad "bash: the plans of --plan"
offers check --bvh "$dir/comm" | grep -qx "$dir/commands" || bad "bash: files behind --bvh"
[ -z "$(offers check --count '')" ] || bad "bash: something behind --count"
grep -q -- "'--builder\[builders \\\\\[median\\\\\]\]:.*(.*sah_binned" "$dir/_raydiff" || bad "zsh: builders behind --builder"

# The pages are roff.
if command -v groff >/dev/null; then
    for command in '' $(cat "$dir/commands"); do
        "$raydiff" help --man $command >"$dir/page"
        groff -man -Tascii -ww "$dir/page" >"$dir/shown" 2>"$dir/err"
        [ ! -s "$dir/err" ] && [ "$(grep -c . "$dir/shown")" -gt 15 ] || bad "man page of raydiff $command"
    done
fi
expect 2 "unknown command 'chekc' .*; did you mean check\?" help chekc
expect 2 'help: ' help --man check scene
expect 2 'help: ' help --bash check

echo "help: $rows options, $failed failed"
[ "$rows" -ge 250 ] && [ "$failed" -eq 0 ]
