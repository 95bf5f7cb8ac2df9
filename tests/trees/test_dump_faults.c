/* Faults planted in dumps: each is named with its node and rule, and nothing else is. */
#define _POSIX_C_SOURCE 200809L
#include "scenes/scenes.h"
#include "tests/trees/dump_fixture.h"

static struct dumped soup_of_64(void)
{
    return dumped_make(built_soup(64, 7), "median", 2);
}

static uint32_t depth_of(const struct bvh *bvh, uint32_t node)
{
    uint32_t depth = 0;
    for (uint32_t at = 0; at != node; depth++)
        at = node < bvh->node[at].snd ? bvh->node[at].fst : bvh->node[at].snd;
    return depth;
}

/* The last of the deepest nodes, a leaf of several triangles or none. */
static uint32_t deep(const struct bvh *bvh, bool leaf)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        if ((leaf ? bvh->node[i].item_count > 1 : bvh->node[i].item_count == 0) &&
            depth_of(bvh, i) >= depth_of(bvh, found))
            found = i;
    return found;
}

static bool is_below(const struct bvh *bvh, uint32_t node, uint32_t prim)
{
    const struct bvh_node *of = &bvh->node[node];
    if (of->item_count == 0)
        return is_below(bvh, of->fst, prim) || is_below(bvh, of->snd, prim);
    for (uint32_t i = 0; i < of->item_count; i++)
        if (bvh->prim[of->item_first + i] == prim)
            return true;
    return false;
}

static float *side_of(struct box *box, unsigned side)
{
    return side < 3 ? &box->lo[side] : &box->hi[side - 3];
}

/* So many floats further in, at a deep leaf and a deep inner node, on each side. */
static void a_box_too_small_is_told_to_the_float(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    static const uint32_t steps[] = {1, 2, 1000};
    for (uint32_t t = 0; t < 6 * 2 * ARRAY_COUNT(steps); t++) {
        const unsigned side = t % 6;
        const uint32_t node = deep(&d.bvh, t / 6 % 2), by = steps[t / 12];
        assert_true(depth_of(&d.bvh, node) >= 4);
        float *bound = side_of(&d.dump.node[node].box, side), whole = *bound;
        for (uint32_t i = 0; i < by; i++)
            *bound = nextafterf(*bound, side < 3 ? INFINITY : -INFINITY);
        struct dump_report report = dump_found(&d.dump, &d.scene);
        assert_int_equal(report.faults, 1);
        assert_int_equal(report.small_boxes, 1);
        const struct dump_fault fault = dump_fault_of(&report, DUMP_SMALL);
        assert_int_equal(fault.node, node);
        assert_int_equal(fault.side, side);
        assert_true(fault.bound == *bound && fault.needs == whole);
        assert_int_equal(dump_steps(fault.bound, fault.needs), by);
        struct box tri = scene_tri_bounds(&d.scene, fault.triangle);
        assert_true(*side_of(&tri, side) == whole && is_below(&d.bvh, node, fault.triangle));
        char text[DUMP_FAULT_TEXT], want[64];
        snprintf(want, sizeof want, ": %u step%s, ", by, by == 1 ? "" : "s");
        assert_non_null(strstr(dump_fault_text(&fault, text), want));
        free(report.fault);
        *bound = whole;
    }
    assert_int_equal(dump_faults(&d.dump, &d.scene), 0);
    dumped_free(&d);
}

/* Zeros of both signs are one place. */
static void steps_count_floats(void **state)
{
    (void)state;
    assert_int_equal(dump_steps(0.0f, -0.0f), 0);
    assert_int_equal(dump_steps(-0x1p-149f, 0x1p-149f), 2);
    assert_int_equal(dump_steps(1, 2), 1 << 23);
    assert_int_equal(dump_steps(-INFINITY, INFINITY), 2 * 0x7F800000u);
    assert_int_equal(dump_steps(FLT_MAX, INFINITY), 1);
    assert_true(dump_step(0x1p-149f, -2) == -0x1p-149f && dump_step(-0x1p-149f, 2) == 0x1p-149f);
    assert_true(dump_step(1, -1) == nextafterf(1, 0) && dump_step(FLT_MAX, 9) == INFINITY);
    assert_true(dump_step(-FLT_MAX, -9) == -INFINITY && isnan(dump_step(NAN, 1)));
}

/* A box that is larger is loose and sound, and it alone costs more. */
static void a_box_too_large_is_counted(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    const uint32_t node = deep(&d.bvh, true);
    d.dump.node[node].box.hi[1] = nextafterf(d.dump.node[node].box.hi[1], INFINITY);
    struct dump_report report = dump_found(&d.dump, &d.scene);
    assert_int_equal(report.faults, 0);
    assert_int_equal(report.loose, 1);
    assert_true(report.sah_tight == tree_sah(&d.bvh));
    assert_true(report.sah > report.sah_tight);
    free(report.fault);
    dumped_free(&d);
}

static void a_bound_that_is_no_number_is_named(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    const uint32_t node = deep(&d.bvh, false);
    d.dump.node[node].box.lo[2] = NAN;
    struct dump_report report = dump_found(&d.dump, &d.scene);
    assert_int_equal(report.faults, 1);
    const struct dump_fault fault = dump_fault_of(&report, DUMP_NAN);
    assert_int_equal(fault.node, node);
    assert_int_equal(fault.side, 2);
    free(report.fault);
    dumped_free(&d);
}

static void a_missing_triangle_is_named(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    struct dump_node *leaf = &d.dump.node[deep(&d.bvh, true)];
    const uint32_t lost = d.dump.item[leaf->first + leaf->count - 1];
    leaf->count--;
    struct dump_report report = dump_found(&d.dump, &d.scene);
    assert_int_equal(report.faults, 1);
    assert_int_equal(dump_fault_of(&report, DUMP_MISSING).triangle, lost);
    free(report.fault);
    dumped_free(&d);
}

/* Another triangle's number in a leaf: doubled there, unless the tree splits, and the one whose
 * place it took is missing. */
static void a_doubled_triangle_is_named(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    const uint32_t node = deep(&d.bvh, true), place = d.dump.node[node].first;
    const uint32_t lost = d.dump.item[place], other = d.dump.item[0];
    d.dump.item[place] = other;
    d.dump.node[node].box = d.dump.node[0].box; /* so that no box is too small */
    for (uint32_t at = 0; at != node;
         at = node < d.bvh.node[at].snd ? d.bvh.node[at].fst : d.bvh.node[at].snd)
        d.dump.node[at].box = d.dump.node[0].box;
    struct dump_report report = dump_found(&d.dump, &d.scene);
    assert_int_equal(report.faults, 2);
    assert_int_equal(dump_fault_of(&report, DUMP_DOUBLED).node, node);
    assert_int_equal(dump_fault_of(&report, DUMP_DOUBLED).triangle, other);
    assert_int_equal(dump_fault_of(&report, DUMP_MISSING).triangle, lost);
    free(report.fault);
    d.dump.splits = true;
    report = dump_found(&d.dump, &d.scene);
    assert_int_equal(report.faults, 1);
    assert_int_equal(report.count[DUMP_MISSING], 1);
    free(report.fault);
    d.dump.item[place + 1] = other; /* twice in one leaf */
    report = dump_found(&d.dump, &d.scene);
    assert_int_equal(dump_fault_of(&report, DUMP_DOUBLED).node, node);
    free(report.fault);
    dumped_free(&d);
}

static void a_triangle_that_there_is_not_is_named(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    const uint32_t node = deep(&d.bvh, true), place = d.dump.node[node].first;
    const uint32_t lost = d.dump.item[place];
    static const uint32_t none[] = {64, UINT32_MAX};
    for (size_t i = 0; i < ARRAY_COUNT(none); i++) {
        d.dump.item[place] = none[i];
        struct dump_report report = dump_found(&d.dump, &d.scene);
        assert_int_equal(report.faults, 2);
        assert_int_equal(dump_fault_of(&report, DUMP_TRIANGLE).node, node);
        assert_int_equal(dump_fault_of(&report, DUMP_TRIANGLE).triangle, none[i]);
        assert_int_equal(dump_fault_of(&report, DUMP_MISSING).triangle, lost);
        free(report.fault);
    }
    dumped_free(&d);
}

/* A deep inner node's second child becomes another number: what was below it is then lost. */
static void children_that_make_no_tree_are_named(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    const uint32_t node = deep(&d.bvh, false), lost = d.bvh.node[node].snd;
    const uint32_t up = d.bvh.node[0].snd <= node ? d.bvh.node[0].snd : d.bvh.node[0].fst;
    const struct {
        uint32_t child;
        enum dump_rule rule;
    } tries[] = {{node, DUMP_CYCLE},
                 {0, DUMP_CYCLE},
                 {up, DUMP_CYCLE},
                 {d.bvh.node[node].fst, DUMP_SHARED},
                 {d.bvh.node_count, DUMP_CHILD},
                 {UINT32_MAX, DUMP_CHILD}};
    for (size_t i = 0; i < ARRAY_COUNT(tries); i++) {
        d.dump.child[d.dump.node[node].first + 1] = tries[i].child;
        struct dump_report report = dump_found(&d.dump, &d.scene);
        const struct dump_fault fault = dump_fault_of(&report, tries[i].rule);
        assert_int_equal(fault.node, node);
        assert_int_equal(fault.child, tries[i].child);
        assert_int_equal(dump_fault_of(&report, DUMP_UNREACHED).node, lost);
        assert_int_equal(report.faults, 2 + d.bvh.node[lost].item_count);
        assert_int_equal(report.nodes, d.bvh.node_count - 1);
        free(report.fault);
    }
    dumped_free(&d);
}

static void a_node_that_nothing_leads_to_is_named(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    const size_t count = d.dump.node_count;
    struct dump_node *more = realloc(d.dump.node, (count + 1) * sizeof *more);
    assert_non_null(more);
    d.dump.node = more;
    d.dump.node[d.dump.node_count++] = (struct dump_node){.leaf = true};
    struct dump_report report = dump_found(&d.dump, &d.scene);
    assert_int_equal(report.faults, 1);
    assert_int_equal(dump_fault_of(&report, DUMP_UNREACHED).node, count);
    free(report.fault);
    dumped_free(&d);
}

/* A nudge inwards by one float anywhere: faults are found exactly if bvh_check finds the tree
 * unsound. */
static void boxes_are_judged_as_bvh_check_does(void **state)
{
    (void)state;
    struct rng rng = rng_make(8, 0);
    uint32_t unsound[2] = {0}, split = 0;
    for (uint32_t b = 0; b < 2; b++) {
        struct scene needles;
        assert_int_equal(scene_open("needles:n=800", 1, &needles, NULL), STATUS_OK);
        struct dumped d = dumped_make(needles, b ? "sbvh" : "median", 2);
        split += bvh_is_split(&d.bvh);
        for (uint32_t turn = 0; turn < 300; turn++) {
            const uint32_t node = rng_below(&rng, d.bvh.node_count);
            const unsigned side = rng_below(&rng, 6);
            float *bound = side_of(&d.bvh.node[node].bounds, side), whole = *bound;
            *bound = nextafterf(whole, side < 3 ? INFINITY : -INFINITY);
            *side_of(&d.dump.node[node].box, side) = *bound;
            const bool sound = bvh_check(&d.bvh, &d.scene, NULL) == STATUS_OK;
            assert_int_equal(dump_faults(&d.dump, &d.scene) == 0, sound);
            unsound[b] += !sound;
            *bound = *side_of(&d.dump.node[node].box, side) = whole;
        }
        dumped_free(&d);
    }
    assert_int_equal(split, 1);
    assert_true(unsound[0] == 300 && unsound[1] > 50 && unsound[1] < 300);
}

static void grow(struct tree_dump *dump, int32_t by)
{
    for (size_t i = 0; i < dump->node_count; i++)
        for (unsigned side = 0; side < 6; side++) {
            float *bound = side_of(&dump->node[i].box, side);
            *bound = dump_step(*bound, side < 3 ? -by : by);
        }
}

/* Boxes of a tree that splits, smaller by some floats: grown by the gap they cover all, by one less
 * they do not. */
static void the_gap_is_the_least_growth(void **state)
{
    (void)state;
    static const uint32_t by[] = {1, 2, 3, 7, 100, 3000};
    struct scene needles;
    uint32_t found = 0;
    assert_int_equal(scene_open("needles:n=300", 1, &needles, NULL), STATUS_OK);
    for (size_t t = 0; t < ARRAY_COUNT(by); t++) {
        struct dumped d = dumped_make(needles, "sbvh", 2);
        d.dump.splits = true;
        grow(&d.dump, -(int32_t)by[t]);
        struct dump_report report = dump_found(&d.dump, &d.scene);
        assert_true(report.count[DUMP_UNCOVERED] > 0);
        assert_in_range(report.gap, 1, by[t]);
        grow(&d.dump, (int32_t)report.gap - 1);
        assert_true(dump_faults(&d.dump, &d.scene) > 0);
        grow(&d.dump, 1);
        assert_int_equal(dump_faults(&d.dump, &d.scene), 0);
        found += report.gap > 2;
        free(report.fault);
        tree_dump_free(&d.dump);
        bvh_free(&d.bvh);
    }
    assert_true(found >= 3);
    scene_free(&needles);
}

/* Without a scene a box must hold the boxes of the leaves below. */
static void without_triangles_leaves_are_held_against_boxes(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    const uint32_t node = deep(&d.bvh, false);
    struct dump_report report = dump_found(&d.dump, NULL);
    assert_int_equal(report.faults, 0);
    assert_int_equal(report.judged, report.inner);
    assert_true(isnan(report.overlap) && report.sah == tree_sah(&d.bvh));
    free(report.fault);
    float *bound = &d.dump.node[node].box.hi[0];
    *bound = nextafterf(*bound, -INFINITY);
    report = dump_found(&d.dump, NULL);
    const struct dump_fault fault = dump_fault_of(&report, DUMP_SMALL);
    assert_int_equal(fault.node, node);
    assert_true(d.dump.node[fault.child].leaf && d.dump.node[fault.child].box.hi[0] > *bound);
    free(report.fault);
    dumped_free(&d);
}

static void another_number_of_triangles_is_refused(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    struct scene other = built_soup(65, 7);
    struct dump_report report;
    struct reason reason = {""};
    assert_int_equal(dump_check(&d.dump, &other, 4, true, &report, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "a tree of 64 triangles, the scene has 65");
    scene_free(&other);
    dumped_free(&d);
}

/* All faults are counted, those named are the first of each rule. */
static void faults_beyond_the_most_are_counted(void **state)
{
    (void)state;
    struct dumped d = soup_of_64();
    struct dump_report report;
    for (size_t i = 0; i < d.dump.node_count; i++)
        d.dump.node[i].box.lo[0] = NAN;
    assert_int_equal(dump_check(&d.dump, &d.scene, 3, false, &report, NULL), STATUS_OK);
    assert_int_equal(report.count[DUMP_NAN], d.dump.node_count);
    assert_int_equal(report.fault_count, 3);
    for (uint32_t i = 0; i < 3; i++)
        assert_int_equal(report.fault[i].node, i);
    assert_true(isnan(report.sah));
    free(report.fault);
    dumped_free(&d);
}

/* Nodes that have all nodes as children, and leaves that have all of the list. */
static void hostile_numbers_end(void **state)
{
    (void)state;
    enum { NODES = 1000 };
    struct tree_dump dump = {.node = calloc(NODES, sizeof *dump.node),
                             .child = calloc(NODES, 2 * sizeof *dump.child),
                             .item = calloc(NODES, sizeof *dump.item),
                             .node_count = NODES,
                             .child_count = NODES + NODES / 2,
                             .item_count = NODES};
    assert_true(dump.node && dump.child && dump.item);
    for (uint32_t i = 0; i < NODES; i++) {
        dump.node[i] =
            (struct dump_node){.first = i % 2 ? i / 2 : 0, .count = NODES, .leaf = i % 2};
        dump.child[i] = i;
        dump.child[NODES + i / 2] = 0;
    }
    dump.node[0].count = NODES + NODES / 2;
    struct dump_report report = dump_found(&dump, NULL);
    assert_true(report.count[DUMP_CYCLE] > 0 && report.count[DUMP_SHARED] > 0);
    assert_true(report.count[DUMP_TAKEN] > 0);
    free(report.fault);
    tree_dump_free(&dump);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_too_small_is_told_to_the_float),
        cmocka_unit_test(steps_count_floats),
        cmocka_unit_test(a_box_too_large_is_counted),
        cmocka_unit_test(a_bound_that_is_no_number_is_named),
        cmocka_unit_test(a_missing_triangle_is_named),
        cmocka_unit_test(a_doubled_triangle_is_named),
        cmocka_unit_test(a_triangle_that_there_is_not_is_named),
        cmocka_unit_test(children_that_make_no_tree_are_named),
        cmocka_unit_test(a_node_that_nothing_leads_to_is_named),
        cmocka_unit_test(boxes_are_judged_as_bvh_check_does),
        cmocka_unit_test(the_gap_is_the_least_growth),
        cmocka_unit_test(without_triangles_leaves_are_held_against_boxes),
        cmocka_unit_test(another_number_of_triangles_is_refused),
        cmocka_unit_test(faults_beyond_the_most_are_counted),
        cmocka_unit_test(hostile_numbers_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
