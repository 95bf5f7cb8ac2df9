#!/bin/sh
# Follows README.md, "A bug in five commands": what stands there is what is printed. A line "..." is
# any number of lines.
#   sh tests/scripts/five_commands.sh RAYDIFF
set -u
raydiff=$(realpath "$1") readme=$(realpath README.md)
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
cd "$dir" || exit 4
mkdir bin && ln -s "$raydiff" bin/raydiff && PATH=$dir/bin:$PATH

# Commands of the section, in blocks: N.command and N.expected.
awk '
    /^## / { wanted = /A bug in five commands/; next }
    !wanted { next }
    /^```/ { inside = !inside; next }
    inside && /^\$ / { n++; print substr($0, 3) > (n ".command"); printf "" > (n ".expected"); next }
    inside { print > (n ".expected") }
    END { print n + 0 > "count" }
' "$readme"
count=$(cat count)
[ "$count" -eq 6 ] || { echo "README.md: $count commands, not the five and one more"; exit 1; }

# Every expected line must come, in order; without "..." between them at once.
# A changed first line must be noticed (below).
follows() { # printed, expected
    awk -v expected="$2" '
        BEGIN {
            while ((getline line < expected) > 0) want[++wants] = line
            at = 1
        }
        {
            while (want[at] == "...") { at++; loose = 1 }
            if (at <= wants && $0 == want[at]) { at++; loose = 0; next }
            if (!loose) { print "printed: " $0; print "README:  " want[at]; failed = 1; exit 1 }
        }
        END {
            if (failed) exit 1
            while (want[at] == "...") at++
            if (at <= wants) { print "never printed: " want[at]; exit 1 }
        }' "$1"
}

i=1
while [ "$i" -le "$count" ]; do
    echo "\$ $(cat "$i.command")"
    sh "$i.command" >printed 2>errors
    code=$?
    [ "$code" -le 1 ] || { echo "exit $code"; cat errors; exit 1; }
    follows printed "$i.expected" || exit 1
    sed '1{s/[a-z]/X/}' "$i.expected" >planted.expected
    if [ "$(head -n 1 "$i.expected")" != ... ] && follows printed planted.expected >/dev/null; then
        echo "a changed line was not noticed"
        exit 1
    fi
    i=$((i + 1))
done
[ "$code" -eq 0 ] || { echo "the repaired layout still fails"; exit 1; }
echo "five commands: followed"
