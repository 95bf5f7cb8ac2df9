#!/bin/sh
# Scenes that single planted bugs of tests/planted need: sh tests/planted/scenes.sh FOLDER
set -eu
out=$1

# 16 times the same triangle, so that every level of the tree is hit on both sides.
{
    echo 'v -1 -1 0'
    echo 'v 1 -1 0'
    echo 'v 0 1 0'
    for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16; do echo 'f 1 2 3'; done
} >"$out/duplicates.obj"
# Five leaves in a wide node.
{ cat "$out/duplicates.obj"; echo "f 1 2 3"; } >"$out/seventeen.obj"

# A closed box of 2 x 2 x 2000, in which woop's rounding outweighs the distance to the walls.
awk 'BEGIN { for (i = 0; i < 8; i++)
        print "v", i % 2 * 2 - 1, int(i / 2) % 2 * 2 - 1, (int(i / 4) * 2 - 1) * 1000
    split("1 2 4 3 5 7 8 6 1 5 6 2 3 4 8 7 1 3 7 5 2 6 8 4", q, " ")
    for (i = 0; i < 6; i++) print "f", q[4*i+1], q[4*i+2], q[4*i+3], q[4*i+4] }' >"$out/corridor.obj"

# Triangles at 1, 1/2, 1/4, ...: with builder rtrs a tree 16 deep, all of which waits on the stack of
# a ray that leaves the origin.
awk 'BEGIN { for (i = 0; i < 17; i++) { x = 2 ^ -i
    printf "v %.9g 0 0\nv %.9g %.9g 0\nv %.9g 0 %.9g\nf %d %d %d\n", \
        x, x, x / 8, x, x / 8, 3*i+1, 3*i+2, 3*i+3 } }' >"$out/deep.obj"
