#!/bin/sh
# Leaks of closed meshes on every driver that needs no GPU:
#   sh tests/scripts/leaks.sh BUILD OUTPUT [RAYS [LAYOUTS]]
# Three meshes and a sphere under four transforms, triangle test woop with box test watertight, on cpu and
# vulkan; a driver or mesh that is not here is left out, with a line (generated ones stand in for meshes). Writes
# OUTPUT.txt; fails if any ray leaks, if vulkan differs from cpu in a bit, or if nothing could be run.
set -u
raydiff=$1/raydiff out=$2 rays=${3:-1000000} layouts=${4:-rf16}
mkdir -p "$(dirname "$out")"
scenes=sphere:n=16
for mesh in scenes/fetched/bunny.obj scenes/fetched/dragon-11k.ply.gz; do
    if [ -r "$mesh" ]; then
        scenes="$scenes $mesh"
    else
        echo "SKIP $mesh: not fetched (make scenes)"
    fi
done
for made in flake platonic; do
    [ "$(echo "$scenes" | wc -w)" -ge 3 ] || scenes="$scenes $made"
done
scenes="$scenes placed-identity placed-turned placed-stretched placed-mirrored"
# An answer for each scene and layout, of either engine.
answers=$(($(echo "$scenes" | wc -w) * $(echo "$layouts" | tr , '\n' | grep -c .)))
code=0 ran=0
rm -f "$out.tmp"
for driver in stock mesa25 swiftshader; do
    # shellcheck disable=SC2086 # scene names have no spaces
    "$raydiff" leaks $scenes --engine cpu,vulkan --layout $layouts --tri woop --box watertight \
        --driver $driver --count "$rays" >"$out.part" 2>"$out.err"
    result=$?
    echo "driver $driver: exit code $result" | tee -a "$out.tmp"
    cat "$out.part" >>"$out.tmp"
    # Skipped only if what is missing is named.
    [ "$result" -eq 77 ] && grep -m 1 "^engine vulkan answered 0 of .*$driver" "$out.part" && continue
    ran=$((ran + 1))
    for engine in cpu vulkan; do
        grep -qx "engine $engine answered $answers of $answers" "$out.part" || result=1
    done
    [ "$result" -eq 0 ] || { tail -n 3 "$out.err" && code=1; }
done
rm -f "$out.part" "$out.err"
mv "$out.tmp" "$out.txt"
[ $ran -gt 0 ] || { echo "leaks: no driver could be run" && exit 77; }
exit $code
