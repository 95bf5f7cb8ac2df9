# Part of tests/mutants.sh: what raydiff explain says of each planted bug that makes an answer wrong.
# The healthy program must find nothing wrong among the same rays.

# Makes $dir/raydiff with the bug NAME compiled into UNIT ("shaders": into all shaders).
mutant_program() {
    name=$1 unit=$2
    dir=$out/$name-$(basename "$unit" .c)
    [ -x "$dir/raydiff" ] && return
    mkdir -p "$dir"
    source=$unit
    if [ "$unit" = shaders ]; then
        source=$dir/b/gen/shaders.c
        $MAKE_CMD -s "B=$dir/b" "MUTANT=$(number "$name")" "$source" >"$dir/make.log" 2>&1
        $CC_CMD -c -o "$dir/unit.o" "$source"
    else
        $CC_CMD "-DMUTANT=$(number "$name")" -c -o "$dir/unit.o" "$source"
    fi && $CC_CMD -o "$dir/raydiff" "$build"/obj/raydiff.o "$build"/obj/*/cmd_*.o "$dir/unit.o" \
        "$build/libraydiff.a" $LIBS || { echo "$name does not build"; exit 4; }
}

# name, unit, cause, exit code, arguments of raydiff explain.
explains() {
    name=$1 unit=$2 cause=$3 code=$4
    shift 4
    mutant_program "$name" "$unit"
    "$build/raydiff" explain "$@" >"$dir/explain-healthy.log" 2>&1
    healthy=$?
    if [ "$healthy" -eq 77 ]; then
        echo "SKIP explain $name in shaders: no Vulkan device here"
        return
    fi
    "$dir/raydiff" explain "$@" >"$dir/explain-mutant.log" 2>&1
    got=$?
    if [ "$healthy" -ne 0 ]; then
        echo "BROKEN  explain $name in $unit: the healthy program exits $healthy"
        missed=$((missed + 1))
    elif [ "$got" -eq "$code" ] && grep -q "^cause  *$cause:" "$dir/explain-mutant.log"; then
        echo "caught  explain $name in $unit: $cause"
        caught=$((caught + 1))
    else
        echo "MISSED  explain $name in $unit: exit $got, $(grep '^cause' "$dir/explain-mutant.log")"
        missed=$((missed + 1))
    fi
}

# A closed box of 2 x 2 x 2000, in which woop's rounding outweighs the distance to the walls.
awk 'BEGIN { for (i = 0; i < 8; i++)
        print "v", i % 2 * 2 - 1, int(i / 2) % 2 * 2 - 1, (int(i / 4) * 2 - 1) * 1000
    split("1 2 4 3 5 7 8 6 1 5 6 2 3 4 8 7 1 3 7 5 2 6 8 4", q, " ")
    for (i = 0; i < 6; i++) print "f", q[4*i+1], q[4*i+2], q[4*i+3], q[4*i+4] }' >"$out/corridor.obj"
at_the_edge='0x1.3f1fbp-2,-0x1.3db6fp-4,-0x1.f47f7cp-2 -0x1.4fc822p+0,0x1.13dae2p+0,0x1.c2cb04p+0'

# Triangles at 1, 1/2, 1/4, ...: with builder rtrs a tree 16 deep, all of which waits on the stack of
# a ray that leaves the origin.
awk 'BEGIN { for (i = 0; i < 17; i++) { x = 2 ^ -i
    printf "v %.9g 0 0\nv %.9g %.9g 0\nv %.9g 0 %.9g\nf %d %d %d\n", \
        x, x, x / 8, x, x / 8, 3*i+1, 3*i+2, 3*i+3 } }' >"$out/deep.obj"

explains HALF_NEAREST ref/half.c rounded_inward 1 soup --rays vertices --count 20000
explains LOST_SLOT ref/layouts/layout_rf16.c slot_not_read 1 soup --leaf 8 --count 5000
explains ZERO_IS_EMPTY ref/layouts/layout_rf16.c sentinel 1 platonic --count 5000
explains SLAB_STRICT ref/trace.c strict_comparison 1 grid:height=0 --layout f32 --rays ranges --count 5000
explains SWAPPED_CHILD ref/trace.c child_reference 3 soup --layout f32 --count 5000
explains FAR_NOT_PADDED ref/trace.c box_padding_too_small 1 soup --layout f32 --rays corners --count 400000
explains SHORT_STACK ref/packed.c stack 3 "$out/duplicates.obj" --layout f32 --leaf 1 --rays primary --count 5000
explains LOST_SLOT shaders slot_not_read 1 soup --leaf 8 --engine vulkan --count 5000
explains ZERO_IS_EMPTY shaders sentinel 1 platonic --engine vulkan --count 5000
explains SLAB_STRICT shaders strict_comparison 1 grid:height=0 --layout f32 --engine vulkan --rays ranges --count 5000
explains SWAPPED_CHILD shaders child_reference 3 soup --layout f32 --engine vulkan --count 5000
explains FAR_NOT_PADDED shaders box_padding_too_small 1 soup --layout f32 --engine vulkan --rays corners --count 400000
explains NEAR_KEPT ref/trace.c box_padding_too_small 1 soup --layout f32 --box watertight --rays corners --count 400000
explains BEHIND_FORGOT ref/trace.c box_padding_too_small 1 "$out/corridor.obj" --layout f32 --leaf 1 --box watertight --tri woop --ray "$at_the_edge"
explains BEHIND_FORGOT shaders box_padding_too_small 1 "$out/corridor.obj" --layout f32 --leaf 1 --box watertight --tri woop --engine vulkan --ray "$at_the_edge"
explains SHORT_STACK shaders stack 3 "$out/deep.obj" --builder rtrs --eps 0 --leaf 1 --layout f32 --engine vulkan --ray '0,0,0 32,1,1'

# name, unit, cause, arguments of raydiff check: its first finding's command, run as printed, names
# the cause; so does the one in the JSON.
check_tells_how() {
    name=$1 unit=$2 cause=$3
    shift 3
    mutant_program "$name" "$unit"
    "$dir/raydiff" check "$@" --json "$dir/check.json" >"$dir/check-mutant.log" 2>&1
    told=$(sed -n 's/^  explain: raydiff //p' "$dir/check-mutant.log" | head -n 1)
    eval "\"$dir/raydiff\" $told" >"$dir/told.log" 2>&1
    got=$?
    if [ -n "$told" ] && [ "$got" -eq 1 ] && grep -q "^cause  *$cause:" "$dir/told.log" &&
        grep -qF "\"explain\": \"raydiff $told\"" "$dir/check.json"; then
        echo "caught  $name in $unit: as check tells to explain it, $cause"
        caught=$((caught + 1))
    else
        echo "MISSED  $name in $unit: check tells '$told', exit $got, $(grep '^cause' "$dir/told.log")"
        missed=$((missed + 1))
    fi
}
check_tells_how HALF_NEAREST ref/half.c rounded_inward soup:n=900 --rays vertices --count 20000 --engine cpu --seed 7 --repeat 1
check_tells_how SLAB_STRICT shaders strict_comparison grid:height=0 --layout f32 --rays ranges --count 5000 --engine vulkan --repeat 1
