#!/bin/sh
# Wrong inputs of every command, ten and more each, and the one line that answers each: tests/docs/wrong_inputs.txt.
#   sh tests/docs/wrong_inputs.sh RAYDIFF [--write]     --write: makes the answers anew
# A line "$ ARGUMENTS" and below it what is printed on the standard error output: one line, with exit code 2, before any
# work is done. It names what is wrong, and either what would be right or where to read it.
set -u
raydiff=$(realpath "$1")
table=$(realpath tests/docs/wrong_inputs.txt)
write=${2:-}
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $*" >&2
    failed=$((failed + 1))
    [ "$failed" -lt 10 ] || { echo "$failed failed, the rest is left out" >&2; exit 1; }
}
# Files of the sources are read in a copy, in which nothing may be left behind. text.md is of no kind that a command reads.
mkdir -p "$dir/in/fuzz" && cp -r fuzz/corpus "$dir/in/fuzz/" && cd "$dir/in" || exit 4
printf '# A text\n\nraydiff finds no scene in this text, no trial, no tree and no table of answers.\n' >text.md
# Worlds, each against one rule: name, instances, other members.
world() {
    echo '{"raydiff_world": 1, "meshes": [{"scene": "sphere:n=2"}], "instances": ['"$2]$3}" >"$1.world.json"
}
world singular '{"mesh": 0}, {"mesh": 0, "transform": [1, 0, 0, 0,  0, 1, 0, 0,  1, 1, 0, 0]}' ''
world huge '{"mesh": 0, "transform": [1e39, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0]}' ''
world no_mesh '{"mesh": 0}, {"mesh": 1}' ''
world custom '{"mesh": 0, "custom": 16777216}' ''
world mask '{"mesh": 0, "mask": 256}' ''
world both '{"mesh": 0, "flags": ["force_opaque", "force_no_opaque"]}' ''
world flag '{"mesh": 0, "flags": ["cull"]}' ''
world filter '{"mesh": 0}' ', "filter": {"kind": "some"}'
world far '{"mesh": 0, "transform": [1, 0, 0, 3e38,  0, 1, 0, 0,  0, 0, 1, 0]}, {"mesh": 0, "transform": [1e38, 0, 0, 3e38,  0, 1, 0, 0,  0, 0, 1, 0]}' ''
find . -type f | sort | xargs cksum >"$dir/before"
sed -n 's/^\$ //p' "$table" >"$dir/inputs"
while IFS= read -r arguments; do
    eval "set -- $arguments"
    timeout 60 "$raydiff" "$@" >"$dir/out" 2>"$dir/err" </dev/null
    code=$?
    [ "$code" -eq 2 ] || bad "$arguments: exit $code"
    [ "$(wc -l <"$dir/err")" -eq 1 ] || bad "$arguments: $(wc -l <"$dir/err") lines"
    [ -s "$dir/out" ] && bad "$arguments: something is on the standard output"
    grep -q "^raydiff $1: " "$dir/err" || bad "$arguments: whose line is it?"
    grep -qE '\(see raydiff [a-z]+ --help\)$|did you mean|is none of|--list|No such file|is no folder|[Nn]ot a directory|is a directory|not with|[a-z]+\.(md|obj|trial|xyz|jpg)|[0-9]' "$dir/err" ||
        bad "$arguments: no suggestion: $(cat "$dir/err")"
    printf '$ %s\n' "$arguments"
    cat "$dir/err"
done <"$dir/inputs" >"$dir/got"
find . -type f | sort | xargs cksum | diff "$dir/before" - || bad 'a file is made or changed'
[ "$write" = --write ] && cp "$dir/got" "$table"
# Bounds of ranges may be of the machine, and so may engines and drivers.
cmp -s "$dir/got" "$table" || { diff "$table" "$dir/got" | head -20; bad 'other answers than in tests/docs/wrong_inputs.txt'; }
for command in $("$raydiff" help | awk '/^  +[a-z]+ / && !/^  +raydiff/ { print $1 }' | sort -u); do
    grep -q "^\$ $command" "$table" || continue
    [ "$(grep -c "^\$ $command\\( \\|\$\\)" "$table")" -ge 10 ] || bad "$command: fewer than ten"
done
[ "$(sed 's/ .*//' "$dir/inputs" | sort -u | wc -l)" -ge 20 ] || bad 'commands are missing'
echo "wrong_inputs: $(wc -l <"$dir/inputs") inputs of $(sed 's/ .*//' "$dir/inputs" | sort -u | wc -l) commands, $failed failed"
[ "$failed" -eq 0 ]
