#!/bin/sh
# Engine fast, Embree and the user's copy of tinybvh in one race: sh tests/bench/tinybvh.sh PATH/raydiff FOLDER [SCENE;..]
# FOLDER has tiny_bvh.h. Its answers to camera rays are judged before it is raced. Exit code 77: no copy is named.
set -u
raydiff=${1?} folder=${2:-} scene=${3:-}
[ -n "$folder" ] || { echo 'SKIPPED tinybvh: TINYBVH=FOLDER names no copy'; exit 77; }
[ -r "$folder/tiny_bvh.h" ] || { echo "tinybvh: $folder/tiny_bvh.h cannot be read" >&2; exit 2; }
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
version=$(sed -n 's/^#define TINY_BVH_VERSION_[A-Z]*[^0-9]*\([0-9]*\).*/\1/p' "$folder/tiny_bvh.h" | head -n 3 | paste -sd .)
echo "tinybvh $version, sha256 $(sha256sum <"$folder/tiny_bvh.h" | cut -c1-16)"
c++ -std=c++17 -O3 -march=native -shared -fPIC -I. "-I$folder" -o "$dir/tinybvh.so" fuzz/samples/engine/tinybvh_engine.cpp \
    2>"$dir/log" || { cat "$dir/log"; echo 'FAILED  tinybvh: the adapter does not compile'; exit 1; }
for rays in primary random; do
    "$raydiff" check sphere:n=40 --engine "inside:$dir/tinybvh.so" --rays $rays --query closest,any --count 20000 --repeat 1 \
        >"$dir/log" 2>&1
    tail -n 1 "$dir/log"
done
"$raydiff" bench fast --engine "fast,inside:$dir/tinybvh.so" --count 100000 ${scene:+--scene "$scene"}
