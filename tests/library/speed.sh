#!/bin/sh
# Both measurements of the library's time; exit 1 if one is over its bound.
#   sh tests/library/speed.sh BUILD SCENE RAYS      make library-speed
set -u
build=$(realpath "$1") scene=$2 rays=$3
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
bad=0
export OMP_NUM_THREADS=2
"$build/library_speed" "$build/shared/libraydiff.so.1" "$scene" "$rays" 9 || bad=$?
for python in python3 /usr/bin/python3; do
    "$python" -c 'import numpy' 2>/dev/null && break
done
"$build/raydiff" gen "$scene" --count 1 >"$dir/request" || exit 4
RAYDIFF_LIBRARY="$build/shared/libraydiff.so.1" PYTHONPATH=ref/library PYTHONDONTWRITEBYTECODE=1 \
    "$python" tests/library/speed.py "$dir/request" "$rays" 2 || bad=$?
exit "$bad"
