#!/bin/sh
# raydiff explain --query all, by laws: it names what check names; a list without a fault is right for every engine;
# hits at the same t stand for each other; and the conclusion tells truly where lost hits lie.
#   sh tests/reported/lists.sh PATH/raydiff
set -u
. tests/guest/outsiders.sh
cc -std=c17 -O1 -shared -fPIC "-I$root" -DWAY=2 -o way2.so "$root/tests/peers/wrong_engine.c" || bad 'a wrong engine'
for tracer in embree_12 trimesh_457; do
    cc -std=c11 -O2 -ffp-contract=off -shared -fPIC "-I$root" -o $tracer.so "$root/tests/reported/$tracer.c" -lm || bad "$tracer"
done
# Two triangles lie on each other: the nearest hit may be either.
printf 'v %s\n' '0 0 1' '4 0 1' '0 4 1' '0 0 2' '4 0 2' '0 4 2' >scene.obj
printf 'f %s\n' '1 2 3' '1 2 3' '4 5 6' '4 5 6' >>scene.obj
expect 1 'WRONG: missed; 1 listed, of 4 exact hits, 3 lost, of which 3 found as the nearest from there on: the list alone' \
    explain scene.obj --query all --ray '1,1,0 0,0,1' --engine ./embree_12.so --wide
# The first rays' lists are right, and so is every list of an honest engine.
for engine in cpu brute embree vulkan fast; do
    expect 0 'conclusion: (no list is wrong|.*)' explain soup:n=60,size=0.8 --query all --count 100 --engine $engine
    expect 0 'conclusion: the list is (right|allowed)' explain soup:n=60,size=0.8 --query all --index 3 --count 100 --engine $engine
done
# The command of a triangle that is listed twice shows it.
"$raydiff" check soup:n=60,size=0.8 --engine inside:./way2.so --query all --count 300 --repeat 1 >out 2>&1
twice=$(awk '/^WRONG twice/ { look = 1; next } /^WRONG/ { look = 0 } look && sub(/^ *explain: raydiff /, "") { print; exit }' out)
[ -n "$twice" ] || bad 'nothing is listed twice'
eval "\"\$raydiff\" $twice" >out 2>&1
[ $? -eq 1 ] && grep -q 'WRONG: twice' out || bad "$twice"
# "Behind the last" only where all that are lost are: of the first rays on which something is.
behind=0 between=0
for index in $(seq 0 29); do
    [ $((index % 2)) -eq 0 ] && tracer=trimesh_457 || tracer=embree_12
    "$raydiff" explain soup:n=200,size=0.5 --count 100 --query all --engine ./$tracer.so --index "$index" --wide >out 2>&1
    is=$(awk '/ LOST/ { lost++; seen = 1; next } /^    +[0-9]+ .*(inside|edge|vertex|in_plane)/ { if (seen) after = 1; else before++ }
        END { print (lost && before && !after) + 0 }' out)
    said=$(grep -c 'they lie behind the last that is listed' out)
    [ "$is" -eq "$said" ] || bad "ray $index: said $said, is $is"
    behind=$((behind + is)) between=$((between + $(grep -c 'WRONG: missed' out) - is))
done
[ "$behind" -gt 3 ] && [ "$between" -gt 3 ] || bad "behind the last: $behind, between: $between"
[ "$failed" -eq 0 ] && echo 'lists: all said is so'
exit "$failed"
