#!/bin/sh
# Planted bugs (ref/mutant.h): each is compiled into one C unit or one set of shaders, under
# BUILD/mutants/suite, and something of the suite must turn red. The same command is run without the
# bug first and must be green, so that a broken catcher cannot pass for a catch.
#   CC_CMD=... LIBS=... MAKE_CMD=... sh tests/mutants.sh BUILD
set -u
build=$1
out=$build/mutants/suite
rm -rf "$out"
mkdir -p "$out"
caught=0 missed=0

number() { awk -v name="MUTANT_$1" '$2 == name {print $3}' ref/mutant.h; }

# Scenes that single bugs need: 16 times the same triangle, so that every level of the tree is hit
# on both sides.
{
    echo 'v -1 -1 0'
    echo 'v 1 -1 0'
    echo 'v 0 1 0'
    for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16; do echo 'f 1 2 3'; done
} >"$out/duplicates.obj"
# Five leaves in a wide node.
{ cat "$out/duplicates.obj"; echo "f 1 2 3"; } >"$out/seventeen.obj"

judge() { # name, what was mutated, code of the healthy run, code of the mutant's
    if [ "$3" -ne 0 ]; then
        echo "BROKEN  $1: its catcher fails without the bug (exit $3)"
        missed=$((missed + 1))
    elif [ "$4" -eq 1 ] || [ "$4" -eq 3 ]; then
        echo "caught  $1 (in $2)"
        caught=$((caught + 1))
    else
        echo "MISSED  $1 (in $2): exit $4"
        missed=$((missed + 1))
    fi
}

# name, unit, then the arguments of raydiff that must turn red.
in_program() {
    name=$1 unit=$2
    shift 2
    dir=$out/$name-$(basename "$unit" .c)
    mkdir -p "$dir"
    $CC_CMD "-DMUTANT=$(number "$name")" -c -o "$dir/unit.o" "$unit" &&
        $CC_CMD -o "$dir/raydiff" "$build"/obj/raydiff.o "$build"/obj/*/cmd_*.o "$dir/unit.o" \
            "$build/libraydiff.a" $LIBS || { echo "$name does not build"; exit 4; }
    "$build/raydiff" "$@" >"$dir/healthy.log" 2>&1
    healthy=$?
    "$dir/raydiff" "$@" >"$dir/mutant.log" 2>&1
    judge "$name" "$unit" "$healthy" $?
}

# name, unit, unit test that must turn red.
in_test() {
    name=$1 unit=$2 test=$3 beside=
    dir=$out/$name-$test
    case $test in
    test_oracle*) beside="$build/obj/tests/exact_gmp.o $build/obj/tests/oracle_cases.o -lgmp" ;;
    test_bounds*)
        beside="$build/obj/tests/exact_gmp.o $build/obj/tests/oracle_cases.o -lgmp"
        beside="$build/obj/tests/trials.o $build/obj/tests/legal.o $beside"
        ;;
    esac
    [ "$test" != test_out_of_memory ] ||
        beside=-Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=aligned_alloc,--wrap=free
    mkdir -p "$dir"
    $CC_CMD "-DMUTANT=$(number "$name")" -c -o "$dir/unit.o" "$unit" &&
        $CC_CMD -o "$dir/$test" "$build/obj/tests/$test.o" "$dir/unit.o" $beside \
            "$build/libraydiff.a" $LIBS -lcmocka || { echo "$name does not build"; exit 4; }
    "$build/tests/$test" >"$dir/healthy.log" 2>&1
    healthy=$?
    "$dir/$test" >"$dir/mutant.log" 2>&1
    code=$?
    [ "$code" -lt 2 ] || code=1 # CMocka returns how many failed
    judge "$name" "$unit, by $test" "$healthy" "$code"
}

# name, unit test that includes the bug's header itself.
in_header() {
    name=$1 test=$2
    dir=$out/$name-$test
    mkdir -p "$dir"
    $CC_CMD "-DMUTANT=$(number "$name")" -c -o "$dir/unit.o" "tests/$test.c" &&
        $CC_CMD -o "$dir/$test" "$dir/unit.o" "$build/libraydiff.a" $LIBS -lcmocka ||
        { echo "$name does not build"; exit 4; }
    "$build/tests/$test" >"$dir/healthy.log" 2>&1
    healthy=$?
    "$dir/$test" >"$dir/mutant.log" 2>&1
    code=$?
    [ "$code" -lt 2 ] || code=1
    judge "$name" "a header, by $test" "$healthy" "$code"
}

# name, then arguments of raydiff or one unit test: the same bug in the shaders.
in_shaders() {
    name=$1
    shift
    dir=$out/$name-shaders
    mkdir -p "$dir"
    $MAKE_CMD -s "B=$dir/b" "MUTANT=$(number "$name")" "$dir/b/gen/shaders.c" >"$dir/make.log" 2>&1 &&
        $CC_CMD -c -o "$dir/unit.o" "$dir/b/gen/shaders.c" &&
        $CC_CMD -o "$dir/raydiff" "$build"/obj/raydiff.o "$build"/obj/*/cmd_*.o "$dir/unit.o" \
            "$build/libraydiff.a" $LIBS || { echo "$name does not build"; cat "$dir/make.log"; exit 4; }
    case $1 in
    test_*)
        $CC_CMD -o "$dir/$1" "$build/obj/tests/$1.o" "$dir/unit.o" "$build/libraydiff.a" $LIBS \
            -lcmocka || exit 4
        "$build/tests/$1" >"$dir/healthy.log" 2>&1
        healthy=$?
        grep -q '^SKIP' "$dir/healthy.log" && healthy=77
        ;;
    *)
        "$build/raydiff" "$@" >"$dir/healthy.log" 2>&1
        healthy=$?
        ;;
    esac
    if [ "$healthy" -eq 77 ]; then
        echo "SKIP $name in shaders: no Vulkan device here"
        return
    fi
    case $1 in
    test_*)
        "$dir/$1" >"$dir/mutant.log" 2>&1
        code=$?
        [ "$code" -lt 2 ] || code=1 # CMocka returns how many failed
        ;;
    *)
        "$dir/raydiff" "$@" >"$dir/mutant.log" 2>&1
        code=$?
        ;;
    esac
    judge "$name" "shaders" "$healthy" "$code"
}

# name, unit, entry of the files under fire whose seeds must end it.
in_fire() {
    name=$1 unit=$2 entry=$3
    dir=$out/$name-fire
    mkdir -p "$dir"
    $CC_CMD "-DMUTANT=$(number "$name")" -c -o "$dir/unit.o" "$unit" &&
        $CC_CMD -o "$dir/$entry" "$build/obj/fuzz/fire/entry_$entry.o" "$dir/unit.o" \
            "$build"/obj/fuzz/fire/harness.o "$build"/obj/fuzz/fire/count.o \
            "$build"/obj/fuzz/fire/main.o "$build/libraydiff.a" $LIBS ||
        { echo "$name does not build"; exit 4; }
    "$build/fire/$entry" "$build/fire/seeds/$entry" >"$dir/healthy.log" 2>&1
    healthy=$?
    "$dir/$entry" "$build/fire/seeds/$entry" >"$dir/mutant.log" 2>&1
    code=$?
    grep -q 'does not hold' "$dir/mutant.log" && [ "$code" -gt 128 ] && code=1
    judge "$name" "$unit, by the seeds of $entry" "$healthy" "$code"
}

in_program HALF_NEAREST ref/half.c check soup --layout rf16 --engine cpu --rays vertices --count 20000 --repeat 1
in_test HALF_NEAREST ref/half.c test_packed
in_program LOST_SLOT ref/layouts/layout_rf16.c check soup --layout rf16 --engine cpu --leaf 8 --count 5000 --repeat 1
in_program ZERO_IS_EMPTY ref/layouts/layout_rf16.c check platonic --layout rf16 --engine cpu --count 5000 --repeat 1
in_header SLAB_STRICT test_boxes
in_program SWAPPED_CHILD ref/trace.c check soup --layout f32 --engine cpu --count 5000 --repeat 1
in_header FAR_NOT_PADDED test_boxes
in_header NEAR_KEPT test_boxes
in_test BEHIND_FORGOT ref/trace.c test_watertight
in_program SHORT_STACK ref/packed.c check "$out/duplicates.obj" --layout f32 --leaf 1 --engine cpu --rays primary --count 5000 --repeat 1
in_test BAD_TWIN ref/twin.c test_twin
in_test BAD_TWIN ref/twin.c test_bounds
in_test NEAR_ROUNDED ref/twin.c test_bounds_judge
in_test OPERAND_KEPT ref/twin.c test_bounds
in_test FILTER_BOUND ref/oracle/filter.c test_bounds_oracle
in_test EARLY_BOUND ref/oracle/early.c test_bounds_oracle
in_test LANE_SLIPPED ref/twin.c test_twin_many
in_test OTHER_TWIN ref/judge.c test_judge_many
in_test FAN_OFF ref/judge.c test_judge_fan
in_test NOT_CERTAIN ref/judge_lost.c test_judge
in_test HUGE_BOUND ref/judge.c test_judge
in_test FAN_OFF ref/judge.c test_judge_all
in_test NOT_CERTAIN ref/judge_lost.c test_judge_all
in_test HUGE_BOUND ref/judge.c test_judge_all
in_program CULLED_ALL ref/trace.c check soup --query all --layout f32 --engine cpu --count 3000 --repeat 1
in_test FILTER_BOUND ref/oracle/filter.c test_oracle
in_test EARLY_BOUND ref/oracle/early.c test_oracle_rules
in_test EARLY_BESIDE ref/oracle/early.c test_oracle_rules
in_test FACE_FORGOT ref/oracle/pair.c test_oracle_ties
in_test MEDIUM_SIGN ref/oracle/medium.c test_oracle
in_test LOST_CARRY ref/oracle/wide.c test_oracle
in_test TREE_UNPADDED ref/oracle/closest.c test_oracle_scene
in_test ENDS_SWAPPED ref/oracle/nearest.c test_oracle_rules
in_test CULLED_ALL ref/trace.c test_all
in_test LOST_SLOT ref/layouts/layout_rf16.c test_all
in_test EXPONENT_SHORT ref/layouts/layout_cwbvh80.c test_layouts_shipped
in_test PLANE_INWARD ref/layouts/layout_cwbvh80.c test_layouts_shipped
in_test GROWN_INWARD ref/layouts/layout_amd64.c test_layouts_shipped
in_test TOP_BITS_CUT ref/layouts/layout_tiny8.c test_layouts_shipped
in_test GRID_INWARD ref/layouts/grid_number.c test_grid
in_test GRID_SUM_ROUNDED ref/layouts/grid_number.c test_grid
in_test GRID_SUBNORMAL ref/layouts/grid_number.c test_grid
in_test GRID_ITEM_BASE ref/layouts/grid.c test_grid
in_test WIDE_UNSORTED ref/trace.c test_grid
in_test WIDE_ONE_LOST ref/trace.c test_grid
in_test NEIGHBOUR gpu/tracer_tasks.c test_fuzz_tasks
in_test ORDER_KEPT gpu/tracer_tasks.c test_fuzz_tasks
in_test FLAGS_UNREAD gpu/tracer_tasks.c test_fuzz_tasks
in_test SIGN_OF_ZERO ref/float_word.c test_fuzz_numbers
in_test COUNTED_TWICE fuzz/findings.c test_fuzz_merge
in_test LAST_IS_FIRST fuzz/findings.c test_fuzz_merge
in_test PAIRS_BY_CHANCE fuzz/meetings_draw.c test_fuzz_meetings
in_test TRIAL_NOT_REFITTED fuzz/trial_tree.c test_fuzz_meetings
in_test INFINITE_LEAF ref/wide_tree.c test_wide_tree
in_test ALL_AS_RARE fuzz/feedback.c test_fuzz_feedback
in_test HELD_FORGOTTEN fuzz/feedback.c test_fuzz_feedback
in_test NOT_ESCAPED fuzz/ci_text.c test_fuzz_report
in_test UNPLAYED_PASS fuzz/report.c test_fuzz_report
in_test HALF_MESSAGE fuzz/child.c test_fuzz_child
in_test STATE_AHEAD fuzz/campaign_state.c test_fuzz_campaign
in_test SHARDS_OVERLAP fuzz/campaign_blocks.c test_fuzz_campaign
in_test BLAMED_TOGETHER fuzz/campaign_blocks.c test_fuzz_campaign_deaths
in_test STILL_LEFT_OUT fuzz/campaign_blocks.c test_fuzz_campaign_deaths
in_test SIBLINGS_HELD fuzz/child.c test_fuzz_child
in_test SHADOW_BEYOND scenes/shade.c test_shade
in_test POW_IS_EXACT scenes/shade.c test_shade
in_test EYE_UNLIT scenes/shade.c test_shade
in_test STRIP_FORGOT scenes/render.c test_render
in_test LIGHT_SLIPPED scenes/render.c test_render
in_test ANY_TREE_FITS ref/tree_file.c test_tree_file
in_test NO_DOUBT ref/tree_file.c test_tree_file
in_test ORDER_UNREAD ref/packed_unpack.c test_tree_file
in_test STEPS_SWAPPED scenes/transform.c test_transform
in_test MATERIAL_NEXT scenes/construct.c test_construct
in_test WINDING_KEPT scenes/construct.c test_construct
in_test OWN_VERTICES scenes/construct.c test_construct
in_test EXPORT_NO_RAYS fuzz/export_case.c test_vulkan_export
in_test EXPORT_EXACT fuzz/export_right.c test_vulkan_export_data
in_test EXPORT_ENDIAN fuzz/export_amber.c test_vulkan_export_amber
in_test ANY_CAUSE fuzz/shrink_play.c test_fuzz_shrink_faults
in_test ONE_ROUND fuzz/shrink.c test_fuzz_shrink
in_test UNPAID fuzz/shrink.c test_fuzz_shrink
in_test NOT_ASKED fuzz/shrink.c test_fuzz_shrink
in_test HANG_IS_CRASH fuzz/shrink_apart.c test_fuzz_shrink_apart
in_test NEVER_EXPIRES fuzz/baseline.c test_fuzz_baseline
in_test BOX_UNCOUNTED ref/look/numbers.c test_look
in_test DEPTH_LAST ref/look/numbers.c test_look
in_test AROUND_OPEN ref/look/around.c test_look
in_test SHOW_BACKWARDS scenes/show.c test_show
in_test PIXEL_LOST scenes/show.c test_show
in_test DECODED_TURNED ref/look/decoded.c test_look_decoded
in_test WRONG_IS_BLUE scenes/show_picture.c test_show_picture
in_test FOUND_ANYWAY fuzz/selftest_run.c test_fuzz_selftest
in_test DEATH_SPIRAL bench/pacing.c test_pacing
in_test TWO_IN_FLIGHT bench/pacing.c test_pacing
in_test SAME_TREE bench/paper.c test_paper
in_program SAME_TREE bench/paper.c bench paper --scene rtrs --size 16x12 --frames 1
in_test PIXELS_ALONE bench/painter.c test_painter
in_test T_BY_VALUE scenes/diff_frames.c test_diff_frames
in_test SHADOWS_UNSEEN scenes/diff_frames.c test_diff_frames
in_test BORDER_ANYWHERE scenes/diff_frames.c test_diff_frames
in_test NOBODY_WRONG scenes/diff_why.c test_diff_why
in_test PICTURE_TRUSTED scenes/diff_why.c test_diff_why
in_test LAST_BIT scenes/diff_values.c test_diff_values
in_header KEY_IGNORED test_window
in_test WARM_UP_KEPT bench/frames.c test_frames
in_test WEIGHT_ALONE scenes/shade.c test_shade
in_test OTHER_OFFSET scenes/shading.c test_render
in_test MICROSECONDS bench/painter.c test_painter
in_test NAMES_SWAPPED scenes/show_picture.c test_show_picture
in_test LAST_CODE bench/report.c test_report
in_test SHADOW_FOLLOWED scenes/diff_why.c test_diff_why
in_test ERROR_HALVED scenes/show.c test_show
in_test CERTAIN_OF_ONE bench/spread.c test_frames
in_test COUNTED_AGAIN scenes/construct.c test_construct
in_test PAIRS_UNMET fuzz/covering.c test_covering
in_test TRAIL_LOST ref/trace.c test_stackless
# Without a device there is nothing to compare.
"$build/raydiff" bench special --size 16x12 --frames 1 >/dev/null 2>&1
[ $? -eq 77 ] || in_program GENERAL_DULL gpu/frame_dispatch.c bench special --size 16x12 --frames 1
replay="replay --brief --as-expected --engine cpu --time 2"
in_program TRACER_DIES ref/trace.c $replay fuzz/corpus/bad-rays.trial
in_program TRACER_HANGS ref/trace.c $replay fuzz/corpus/bad-rays.trial
in_program HALF_NEAREST ref/half.c $replay fuzz/corpus/rounded-outward.trial
in_program ZERO_IS_EMPTY ref/layouts/layout_rf16.c $replay fuzz/corpus/triangle-zero.trial
in_program LOST_SLOT ref/layouts/layout_rf16.c $replay fuzz/corpus/eighth-slot.trial
in_test SIDES_BELIEVED scenes/image.c test_image
in_test LINE_THIN scenes/draw.c test_draw
in_test ZERO_COLOURED scenes/colour.c test_colour
in_test TICKS_EVEN scenes/colour_picture.c test_colour
in_test ALPHA_UNREAD scenes/image_diff.c test_image_diff
in_test FLAT_RANGE bench/chart.c test_chart
in_test GAPS_CLOSED bench/chart.c test_chart
in_test CLIP_INWARD ref/builders/clip.c test_sbvh
in_test PLANE_NUDGED ref/builders/build_sbvh.c test_sbvh
in_test PIECE_DROPPED ref/builders/build_sbvh.c test_sbvh
in_test REPEATS_KEPT ref/all_hits.c test_sbvh
in_test COVER_FILTER ref/cover_exact.c test_cover
in_test HTML_UNESCAPED bench/report_html.c test_report_html
in_test HTML_LEFT_OPEN bench/report_html.c test_report_html
in_test BASE64_TAIL bench/report_html.c test_report_html
in_test WRONG_UNSEEN bench/report_agreement.c test_report
in_test PART_EXCUSED bench/report.c test_report
in_test PICTURE_BELIEVED bench/report_pictures.c test_report
in_test REPLAY_FORGOTTEN bench/report_findings.c test_report
in_test ITEMS_UNCOUNTED bench/row_plot.c test_row_plot
in_fire COUNT_BELIEVED scenes/read_ply.c ply
in_fire BLOB_BELIEVED ref/packed_file.c packed
for name in PLUGIN_SIZES PLUGIN_EMPTY_LEAF PLUGIN_BELIEVED PLUGIN_UNCHECKED PLUGIN_EXCUSED; do
    in_test $name ref/plugin_pack.c test_plugin
done
in_test PLUGIN_REFS_RAW ref/plugin_layout.c test_plugin
in_test PLUGIN_ANY_VERSION ref/plugin_layout.c test_plugin
in_test PLUGIN_DEATH_UNSEEN fuzz/plugin_guard.c test_plugin
in_test GLSL_LINES_LOST gpu/glsl_text.c test_plugin
in_test GLSL_NOT_PINNED gpu/shaders.c test_plugin
in_shaders NO_PRECISE test_spirv
in_shaders SLAB_STRICT check grid:height=0 --layout f32 --engine vulkan --rays ranges --count 5000 --repeat 1
in_shaders SWAPPED_CHILD check soup --layout f32 --engine vulkan --count 5000 --repeat 1
in_shaders SHORT_STACK test_vulkan_trace
in_shaders FAR_NOT_PADDED check soup --layout f32 --engine vulkan --rays corners --count 400000 --repeat 1
in_shaders BEHIND_FORGOT test_vulkan_watertight
in_shaders LOST_SLOT check soup --layout rf16 --engine vulkan --leaf 8 --count 5000 --repeat 1
in_shaders ZERO_IS_EMPTY check platonic --layout rf16 --engine vulkan --count 5000 --repeat 1
in_program OPEN_EDGES ref/trace.c leaks sphere --layout f32 --engine cpu --box watertight --tri woop --count 4000
in_test BLOCK_CORNER ref/fast/block.c test_fast
in_test CODE_NEAREST ref/fast/fast.c test_fast
in_test FAST_UNPADDED ref/fast/kernel_portable.c test_fast
in_test FAST_CONTRACTED ref/fast/kernel_avx2.c test_fast
in_test FAST_LAST_LEFT ref/fast/kernel_portable.c test_fast
in_test CACHE_FIFO bench/cache_sim.c test_cache_sim
in_test FRONT_OF_TWO bench/pareto.c test_pareto
in_test TOUCH_ONCE bench/touch.c test_touch
in_test PACKET_LANE ref/engines/engine_embree.c test_embree
in_test SHADOW_BEHIND_HIT bench/shadow_rays.c test_touch
in_program EDGE_TURNED ref/trace.c check soup --tri pluecker --layout f32 --engine cpu --count 2000 --repeat 1
in_program BACK_LOST ref/trace.c check soup --tri pluecker --layout f32 --engine cpu --count 2000 --repeat 1
in_program T_HALVED ref/trace.c check soup --tri pluecker --layout f32 --engine cpu --count 2000 --repeat 1
in_program AXIS_SIGNED ref/trace.c check soup --tri baldwin_webber --layout f32 --engine cpu --count 2000 --repeat 1
in_program SUM_UNASKED ref/trace.c check soup --tri baldwin_webber --layout f32 --engine cpu --count 2000 --repeat 1
in_shaders WEIGHTS_SWAPPED check soup --tri baldwin_webber --layout f32 --engine vulkan --count 2000 --repeat 1
in_test AXIS_TRUSTED ref/twin.c test_bounds
in_test TRANSFORM_EXACT ref/twin.c test_bounds
in_shaders CULLED_ALL test_all_engines
in_shaders LOST_SLOT test_all_engines
in_shaders GRID_STRADDLE test_grid_gpu
in_shaders GRID_SCALE_OF_X test_grid_gpu
in_shaders WIDE_ONE_LOST check "$out/seventeen.obj" --layout bvh8_u8_node --engine cpu,vulkan --rays primary --count 5000 --repeat 1
in_shaders WIDE_UNSORTED check "$out/seventeen.obj" --layout bvh8_u8_node --engine cpu,vulkan --rays primary --count 5000 --repeat 1
in_shaders CHILD_ORDER check soup --layout cwbvh80 --engine vulkan --count 5000 --repeat 1
in_shaders WIDTH_UNREAD check soup --layout amd64_f32 --engine vulkan --count 5000 --repeat 1
in_shaders HALVES_SWAPPED check soup --layout half4 --engine vulkan --count 5000 --repeat 1
in_shaders ITEMS_BEFORE check soup --layout tiny8 --engine vulkan --count 5000 --repeat 1
in_shaders SQRT_OF_DRIVER test_vulkan_sqrt
in_shaders OFFSET_SIGN diff rtrs --engine cpu,vulkan -w 40 -h 30
in_shaders SHADOW_BEHIND diff cornell --engine cpu,vulkan -w 32 -h 24 --profile rtrs
in_shaders WEIGHT_KEPT test_vulkan_frame_ends
in_shaders GROUP_LATE diff rtrs --engine cpu,vulkan -w 7 -h 5 --plan steps
in_shaders LIGHT_LOST diff rtrs --engine cpu,vulkan -w 40 -h 30
# Robust buffer access makes it harmless, so that only watching can see it.
export RAYDIFF_VALIDATE=gpu
in_shaders PAST_LAST_RAY check soup:n=50 --layout f32 --engine vulkan --count 1000 --repeat 1
unset RAYDIFF_VALIDATE

in_test GROW_DEPTH ref/builders/grow.c test_build_fast
in_test GROW_BOUNDS ref/builders/grow.c test_build_fast
in_test BIN_UNSHARED ref/builders/build_sah_binned.c test_build_fast
in_test SORT_BACKWARDS ref/builders/keys.c test_build_fast
in_test LINKS_DEEP ref/builders/links.c test_build_fast
in_test COLLAPSE_OVER ref/builders/links.c test_build_fast
in_test MOVE_KEPT ref/builders/spots.c test_build_fast
in_test ROOM_KEPT ref/builders/links.c test_build_memory
in_test WORDS_KEPT ref/layouts/common.c test_out_of_memory
in_test WALK_OF_NOTHING ref/packed_walk.c test_out_of_memory
in_test ROOT_WITHOUT_LEAF ref/wide_tree.c test_degenerate
in_test COST_OF_LEAF ref/tree_quality.c test_build_fast
in_test OVERLAP_OWN ref/tree_overlap.c test_tree_quality
in_test CORNER_SWAPPED ref/store/store_compact.c test_stores
in_test EDGE_SIGN ref/store/store_edges.c test_stores
in_test BLOCK_PRIM_LATE ref/store/store_compact.c test_stores
in_test REFIT_LEVEL ref/packed_refit.c test_refit
in_test REFIT_BEYOND ref/layouts/grid.c test_refit
in_test REFIT_ULP ref/packed_refit.c test_refit
in_test REFIT_HALF ref/packed_refit.c test_refit
in_test REFIT_VERTICES_OLD ref/packed_refit.c test_refit
in_test MOVED_HALVED ref/quantise.c test_quantise
in_test GRID_BELOW ref/quantise.c test_quantise
in_test NEED_WITHOUT ref/original.c test_quantise
in_test GRID_AXIS ref/store/store_quantised.c test_quantise
in_shaders GRID_AXIS test_vulkan_stores


# The same bugs, each by the hard case that is there for it.
in_program HALF_NEAREST ref/half.c conform 'hard.36-half-middles.closest.cpu.rf16.median.robust.mt'
in_program LOST_SLOT ref/layouts/layout_rf16.c conform 'hard.45-leaf-slots.closest.cpu.rf16.median.robust.mt'
in_program ZERO_IS_EMPTY ref/layouts/layout_rf16.c conform 'hard.46-index-zero.closest.cpu.rf16.median.robust.mt'
in_program SWAPPED_CHILD ref/trace.c conform 'hard.16-lattice.closest.cpu.f32.median.robust.mt'
in_program CULLED_ALL ref/trace.c conform 'hard.57-parity.all.cpu.f32.median.robust.mt'
in_program OPEN_EDGES ref/trace.c conform 'hard.05-grid-vertices.closest.cpu.f32.median.watertight.woop'
in_program DEFECT_CURED tests/hard/made.c conform 'hard.79-nearest-halves.closest.cpu.rf16_nearest.*'
in_program OTHER_DEFECT tests/hard/made.c conform 'hard.79-nearest-halves.closest.cpu.rf16_nearest.*'
in_test UNGUARDED ref/engines/engine_embree.c test_bad_input
in_shaders SLAB_STRICT conform 'hard.17-on-surface.closest.vulkan.f32.median.robust.mt'
in_shaders LOST_SLOT conform 'hard.45-leaf-slots.closest.vulkan.rf16.median.robust.mt'

. tests/mutants_explain.sh

echo "$caught planted bugs caught, $missed missed"
[ "$missed" -eq 0 ]
