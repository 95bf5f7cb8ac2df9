#!/bin/sh
# raydiff.py over the shared library that was built:
#   sh tests/library/python.sh BUILD [--trimesh]     --trimesh: it has to be installed
set -u
build=$(realpath "$1")
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
# The system's Python has the system's numpy, whatever comes first in PATH.
for python in python3 /usr/bin/python3 none; do
    "$python" -c 'import numpy' 2>/dev/null && break
done
[ "$python" != none ] || { echo "no Python has numpy (Debian: python3-numpy)"; exit 1; }
export RAYDIFF_LIBRARY="$build/shared/libraydiff.so.1" PYTHONPATH=ref/library PYTHONDONTWRITEBYTECODE=1
for spec in sphere:n=8 soup:n=500; do
    for query in closest any; do
        "$build/raydiff" gen "$spec" --count 2000 --query $query >"$dir/rays" || exit 1
        "$python" tests/library/alike.py "$dir/rays" "$dir/hits" "$dir/verdicts" || exit 1
        "$build/raydiff" judge "$spec" "$dir/rays" "$dir/hits" --json "$dir/json" >"$dir/said"
        [ $? -eq 1 ] || { echo "$spec: raydiff judge finds nothing wrong"; cat "$dir/said"; exit 1; }
        "$python" tests/library/alike.py --compare "$dir/json" "$dir/said" "$dir/verdicts" || exit 1
    done
done
"$python" tests/library/judged.py || exit 1
"$python" tests/library/trimesh_judged.py "${2:-}"
