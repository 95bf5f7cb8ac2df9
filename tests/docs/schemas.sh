#!/bin/sh
# What check, leaks and tree write as JSON, and scene convert as world JSON, holds against docs/schemas; a wrong
# key, type, word or a key that is gone does not.
#   sh tests/docs/schemas.sh RAYDIFF
set -u
raydiff=$1
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
failed=0
bad() {
    echo "FAILED  $*"
    failed=$((failed + 1))
}
holds() { perl tests/docs/schema.pl "docs/schemas/$1.json" "$2"; }
written() { # schema, exit code, command
    schema=$1 code=$2
    shift 2
    "$raydiff" "$schema" "$@" --json "$dir/$schema.json" >"$dir/text" 2>&1
    [ $? = "$code" ] || bad "$schema $*: not exit $code"
    holds "$schema" "$dir/$schema.json" || bad "$schema $*: not as its schema"
}
planted() { # schema, change of its text
    sed "$2" "$dir/$1.json" >"$dir/planted.json"
    cmp -s "$dir/$1.json" "$dir/planted.json" && bad "$1: nothing planted by $2"
    holds "$1" "$dir/planted.json" >"$dir/text" && bad "$1: not noticed: $2"
}
"$raydiff" precompute --scene rtrs --item-count 2 --out "$dir/seed.json" >"$dir/text" 2>&1 || bad "precompute"
written check 1 rtrs --bvh "$dir/seed.json" --engine cpu --count 2000 --repeat 1
written check 2 sphere:n=200 --layout rf16 --engine cpu --count 100 --repeat 1 --brute 0
written check 0 sphere:n=4 --engine cpu,brute --query closest,any,all --move 0.01 --count 100 --repeat 1
written check 0 sphere:n=4 --engine cpu,brute --layout f32,bvh2_u8_scene --steps refit:jitter:3,refit:far:9,rebuild --count 100 --repeat 1
written check 0 sphere:n=4 --engine cpu --layout f32 --store quantised --count 100 --repeat 1
# Shaders compiled anew.
written check 0 sphere:n=4 --engine vulkan --layout f32 --compiler raw,opt --count 100 --repeat 1
for change in 's/"bits_free": *false/"bits_free": 0/' 's/"translates"/"translated"/' 's/"kept": *[0-9]*/"kept": "all"/'; do
    planted check "$change"
done
# Modes of Embree.
if "$raydiff" check sphere:n=1 --engine embree:sse2 --count 10 >"$dir/text" 2>&1 || [ $? != 77 ]; then
    written check 0 sphere:n=4 --engine embree:sse2:8 --count 100 --repeat 1
    planted check 's/"both_right": *[0-9]*/"both_right": "all"/'
    planted check 's/"neither_right"/"neither"/'
fi
# A world's rows, with findings of a layout that is wrong once its tree was checked; engines that trace none.
sed 's/"mine"/"late"/; s/            out->box\[i\] = box(packed, out->child\[i\]);/{ & static volatile int loads; if (loads++ > 3000) out->box[i].hi[0] = out->box[i].lo[0]; }/' \
    fuzz/samples/layout/mine.c >"$dir/late.c"
cc -std=c17 -O2 -ffp-contract=off -shared -fPIC -I. -o "$dir/late.so" "$dir/late.c" || bad 'a layout is not compiled'
written check 1 crowd:n=40 --engine cpu --layout "$dir/late.so" --count 2000 --repeat 2 --threads 1
for change in 's/"instances": *40/"instances": "40"/' 's/"modes": *"mixed"/"modes": "some"/' 's/"mask"/"maks"/' 's/"geometry"/"geo"/' \
    's/"front": *true/"front": 1/'; do
    planted check "$change"
done
written check 0 mixed:count=20 --engine cpu,brute --query closest,any,all --layout f32 --count 200 --repeat 1
# Answers of a file to rays in a world: those that may meet what the file has given them.
"$raydiff" gen crowd:n=3 --count 3 --out "$dir/rays" 2>"$dir/text" || bad 'gen of a world'
printf 'raydiff 2\nm\nm\nm\n' >"$dir/hits"
"$raydiff" judge crowd:n=3 "$dir/rays" "$dir/hits" --json "$dir/judge.json" >"$dir/text" 2>&1
grep -q '"modes": *"given"' "$dir/judge.json" || bad 'judge: the modes of a file'
holds check "$dir/judge.json" || bad 'judge: not as the schema of check'
written leaks 0 sphere:n=8 --engine cpu --layout f32 --tri woop --box watertight --count 2000
for schema in check leaks; do
    planted $schema 's/"status"/"state"/'
    planted $schema 's/"status": *"ok"/"status": "fine"/'
    planted $schema 's/"exit": *0/"exit": "0"/'
    planted $schema 's/"raydiff"/"extra": 1, "raydiff"/'
done
# Trees of others: a sound one, and each fault that the golden inputs and the seeds of the readers have.
written tree 0 fuzz/samples/two.tree
for change in 's/"sah": *2.5/"sah": "2.5"/' 's/"cycle"/"circle"/' 's/"named": *\[\]/"named": null/' 's/"bytes": *96/"bytes": 96.5/'; do
    planted tree "$change"
done
for file in tests/golden/input/*.tree; do
    "$raydiff" tree "$file" --json "$dir/tree.json" >"$dir/text" 2>&1
    case $? in
    0 | 1) holds tree "$dir/tree.json" || bad "tree $file: not as its schema" ;;
    2) ;; # no tree, or one of a scene that is not named
    *) bad "tree $file" ;;
    esac
done
printf 'raydiff tree 1\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\ntriangle 0 1 2\nnode -inf -1 0 inf 1 0 1 0 9\nleaf 0 0 0 0.5 nan 0 0 0 7\nend\n' \
    >"$dir/faulty.tree"
written tree 1 "$dir/faulty.tree"
for change in 's/"rule": *"small"/"rule": "tiny"/' 's/"steps"/"step"/' 's/"needs": *"/"needs": 1, "x": "/'; do
    planted tree "$change"
done
# Worlds: of each kind of member, and each of its words.
for seed in 1 2 3; do
    "$raydiff" scene convert mixed:count=60 "$dir/world.json" --seed $seed >"$dir/text" 2>&1 || bad "mixed $seed: not written"
    holds world "$dir/world.json" || bad "mixed $seed: not as its schema"
done
for change in 's/"mask"/"maks"/' 's/"raydiff_world": 1/"raydiff_world": 2/' 's/"kind": "cells"/"kind": "cell"/' \
    's/"force_opaque"/"opaque"/' 's/"opaque": false/"opaque": 0/' 's/"mesh": null/"mesh": "null"/'; do
    planted world "$change"
done
[ "$failed" = 0 ] || { echo "$failed failed"; exit 1; }
echo "what check, leaks, tree and scene convert write is as docs/schemas has it; 26 planted faults seen"
