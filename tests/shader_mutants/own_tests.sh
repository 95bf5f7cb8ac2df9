#!/bin/sh
# Plays what survived on the shaders' own tests, unchanged programs behind a layer that swaps one module, and notes what
# they kill in FOLDER/SHADER.csv: sh tests/shader_mutants/own_tests.sh BUILD FOLDER SHADER [TEST...]
# EQUIVALENT=/dev/null plays those that are proven to be equivalent, too: none must be killed.
# A mutant that a test was played on has a line in FOLDER/SHADER.own; it is not played again.
set -u
build=$1 folder=$2 shader=$3
shift 3
tests=${*:-test_vulkan_shaders test_grid_gpu test_vulkan_drivers test_vulkan_trace test_vulkan_stores test_vulkan_slots test_stackless test_vulkan_tasks test_vulkan_watertight test_vulkan_trace_ends test_lists_exact}
dir=$(mktemp -d) || exit 4
trap 'rm -rf "$dir"' EXIT
${CC:-cc} -D_GNU_SOURCE -shared -fPIC -O1 -I. -o "$dir/libswap.so" tests/shader_mutants/swap_layer.c ||
    { echo "shader mutants: vulkan/vk_layer.h is needed" >&2; exit 77; }
cat >"$dir/swap.json" <<END
{"file_format_version": "1.1.0", "layer": {"name": "VK_LAYER_RAYDIFF_swap", "type": "GLOBAL",
 "library_path": "$dir/libswap.so", "api_version": "1.3.0", "implementation_version": "1", "description": "swap"}}
END
export RAYDIFF_WHOLE_MODULES=1 VK_LAYER_PATH="$dir" VK_INSTANCE_LAYERS=VK_LAYER_RAYDIFF_swap SWAP_FROM="$build/spv/$shader.spv" \
    SWAP_TO="$dir/mutant.spv" SWAP_SEEN="$dir/seen" OMP_NUM_THREADS=1 SHADER="$shader"
touch "$folder/$shader.own"
red() { # test
    timeout -k 5 "${LIMIT:-120}" "$build/tests/$1" >"$dir/log" 2>&1 </dev/null
    code=$?
    [ "$code" -ne 0 ] && [ "$code" -ne 77 ]
}
# The tests that make a pipeline of this shader, and are green with it.
cp "$SWAP_FROM" "$SWAP_TO"
mine=
for test in $tests; do
    [ -x "$build/tests/$test" ] || continue
    rm -f "$dir/seen"
    if red "$test"; then
        echo "shader mutants: $test is red with $shader as built" >&2
    elif [ -e "$dir/seen" ]; then
        mine="$mine $test"
    fi
done
# The last line of a mutant counts.
tac "$folder/$shader.csv" | awk -F, '!seen[$1]++' | tac >"$dir/csv" && cp "$dir/csv" "$folder/$shader.csv"
perl tests/shader_mutants/score.pl "${EQUIVALENT:-tests/shader_mutants/equivalent.txt}" "$folder/$shader.csv" 2>/dev/null |
    sed -n 's/^survived: [^ ]* \([^ ]*\): .*/\1/p' | while read -r name; do
    grep -qxF "$name" "$folder/$shader.own" && continue
    "$build/shader_mutants" write "$shader" "$name" "$SWAP_TO" || exit 4
    for test in $mine; do
        red "$test" || continue
        how=
        [ "$code" -lt 124 ] || how=" crashes"
        [ "$code" -ne 124 ] && [ "$code" -ne 137 ] || how=" hangs"
        sed -i "s/^\($(echo "$name" | sed 's/[.[\*^$]/\\&/g'),[a-z]*\),survived,[^,]*,/\1,killed,$test$how,/" "$folder/$shader.csv"
        echo "$name $test$how"
        break
    done
    echo "$name" >>"$folder/$shader.own"
done
