#!/bin/sh
# Follows docs/built-in-layout.md word for word, in a copy of the tree.
#   sh tests/house/tutorial.sh BUILD
set -u
build=$1
copy=$(mktemp -d) || exit 4
trap 'rm -rf "$copy"' EXIT
git ls-files -z --cached --others --exclude-standard | tar --null -T - -cf - | tar -xf - -C "$copy" || exit 4
# The objects come along, so that only what the tutorial touches is compiled.
mkdir -p "$copy/build"
cp -a "$build/obj" "$build/gen" "$build/spv" "$build/spirv_tool" "$copy/build/" 2>/dev/null
cd "$copy" || exit 4

# Blocks follow a line "<!-- tutorial: NAME -->"; NAME is a file to write, or "run".
awk -v out="$copy/steps" '
    /^<!-- tutorial: / { name = $3; next }
    name != "" && /^```/ && !inside { inside = 1; block++; file = out "." block; print name > (file ".name"); next }
    inside && /^```$/ { inside = 0; name = ""; next }
    inside { print > file }
    END { print block > (out ".count") }
' docs/built-in-layout.md
count=$(cat steps.count)
[ "$count" -ge 4 ] || { echo "docs/built-in-layout.md: found $count tutorial blocks, expected at least 4"; exit 1; }

i=1
while [ "$i" -le "$count" ]; do
    name=$(cat "steps.$i.name")
    if [ "$name" = run ]; then
        echo "--- running step $i"
        sh -eu "steps.$i" || { echo "tutorial: step $i failed"; exit 1; }
    else
        echo "--- writing $name"
        mv "steps.$i" "$name"
    fi
    i=$((i + 1))
done
build/raydiff list layouts | grep -q '^  bf16' || { echo "tutorial: bf16 is not in the list"; exit 1; }
echo "tutorial: followed, $count steps"
