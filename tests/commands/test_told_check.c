/* The JSON of raydiff check: each number and each flag beside its own name. */
#define _GNU_SOURCE /* open_memstream */
#include "tests/commands/told_check.h"

static json_t *written(const struct check_scene *scene)
{
    static const struct turnout none;
    struct reason reason;
    assert_int_equal(check_write_json(told_file(), scene, 1, &none, 1, &reason), STATUS_OK);
    return told_file_json();
}

static json_t *row_json(const struct check_scene *scene, const char *part)
{
    json_t *root = written(scene), *row = json_array_get(json_object_get(root, "rows"), 0);
    json_t *out = json_deep_copy(part ? json_object_get(row, part) : row);
    json_decref(root);
    return out;
}

static const struct told_number numbers[] = {
    {"exit", 1},
    {"scenes.0.triangles", TRIANGLES},
    {"scenes.0.vertices", 501},
    {"scenes.0.count", 505},
    {"scenes.0.instances", 502},
    {"rows.0.leaf", 21},
    {"rows.0.node_bytes", 31000},
    {"rows.0.item_bytes", 32100},
    {"rows.0.memory_bytes", 34300},
    {"rows.0.rays", 41},
    {"rows.0.hits", 42},
    {"rows.0.compared_with_brute", 44},
    {"rows.0.tree.nodes", 23},
    {"rows.0.tree.leaves", 24},
    {"rows.0.tree.depth", 25},
    {"rows.0.tree.largest_leaf", 26},
    {"rows.0.braid", 22},
    {"rows.0.step.number", 504},
    {"rows.0.step.updated", 0},
    {"rows.0.step.wrong_anew", 106},
    {"rows.0.moved.extents", 503},
    {"rows.0.moved.sah_before", 101},
    {"rows.0.moved.sah_after", 102},
    {"rows.0.moved.build_ns", 10300},
    {"rows.0.moved.pack_ns", 10410},
    {"rows.0.moved.refit_ns", 200},
    {"rows.0.scene_bytes", 33200},
    {"rows.0.counts.right", 201},
    {"rows.0.counts.tie", 202},
    {"rows.0.counts.near_tie", 203},
    {"rows.0.counts.boundary", 204},
    {"rows.0.counts.border", 205},
    {"rows.0.counts.in_plane", 206},
    {"rows.0.counts.slab", 207},
    {"rows.0.counts.noise", 208},
    {"rows.0.counts.out_of_contract", 209},
    {"rows.0.counts.wrong", 210},
    {"rows.0.wrong.missed", 302},
    {"rows.0.wrong.phantom", 303},
    {"rows.0.wrong.triangle", 304},
    {"rows.0.wrong.distance", 305},
    {"rows.0.wrong.barycentric", 306},
    {"rows.0.wrong.not_finite", 307},
    {"rows.0.wrong.not_repeatable", 308},
    {"rows.0.wrong.any_disagrees", 309},
    {"rows.0.wrong.twice", 310},
    {"rows.0.wrong.order", 311},
    {"rows.0.wrong.masked", 312},
    {"rows.0.wrong.culled", 313},
    {"rows.0.wrong.opacity", 314},
    {"rows.0.wrong.instance", 315},
    {"rows.0.wrong.facing", 316},
    {"rows.0.err_over_bound", 45.5},
    {"rows.0.displacement.answers", 51},
    {"rows.0.displacement.allowed", 56},
    {"rows.0.displacement.p50", 52},
    {"rows.0.displacement.p99", 53},
    {"rows.0.displacement.max", 54},
    {"rows.0.displacement.lost_in_closed_fans", 55},
    {"rows.0.displacement.beyond", 57},
    {"rows.0.lists.triangles", 61},
    {"rows.0.lists.double_hits", 62},
    {"rows.0.lists.closed", 1},
    {"rows.0.lists.parity_known", 63},
    {"rows.0.lists.parity_off", 64},
    {"rows.0.original.judged", 200000},
    {"rows.0.original.beyond", 66},
    {"rows.0.original.lost", 67},
    {"rows.0.original.phantom", 68},
    {"rows.0.original.other", 69},
    {"rows.0.original.certified", 70},
    {"rows.0.original.displacement", 71},
    {"rows.0.original.displacement_decoded", 72},
    {"rows.0.bit_differences", 73},
    {"rows.0.judged", 1},
    {"rows.0.differences", 95},
    {"rows.0.mrays_per_s.median", 97},
    {"rows.0.mrays_per_s.min", 96},
    {"rows.0.mrays_per_s.max", 98},
    {"rows.0.box_tests", 107},
    {"rows.0.triangle_tests", 108},
    {"rows.0.other_bits", 87},
    {"rows.0.beside.both_right", 91},
    {"rows.0.beside.alone_right", 92},
    {"rows.0.beside.other_right", 93},
    {"rows.0.beside.neither_right", 94},
    {"rows.0.compiled.decorated", 1},
    {"rows.0.compiled.translates", 0},
    {"rows.0.compiled.source", 81},
    {"rows.0.compiled.operations", 1082},
    {"rows.0.compiled.kept", 83},
    {"rows.0.compiled.open", 85},
    {"rows.0.compiled.lost", 1082 - 83 + 85},
    {"rows.0.compiled.words", 86},
    {"rows.0.compiled.bits_free", 1},
    {"rows.0.compiled.moved", 87},
};

/* All but the edges, whose limits are computed, and the finding. */
static void the_json_of_a_row(void **state)
{
    (void)state;
    const struct engine engine = engine_made();
    const struct match_life life = {.count = 0};
    static struct row row;
    row = row_made(&engine);
    row.options.life = &life;
    const struct check_scene scene = scene_made(&row);
    struct told_number edges[3 * MATCH_EDGES];
    char path[3 * MATCH_EDGES][40];
    for (size_t c = 0; c < MATCH_EDGES; c++)
        for (size_t k = 0; k < 3; k++) {
            static const char *const name[] = {"hits", "lost", "at_most"};
            const double is[] = {(double)(401 + c), (double)(411 + c),
                                 match_edges_limit(c, 401 + c)};
            snprintf(path[3 * c + k], sizeof path[0], "%zu.%s", c, name[k]);
            edges[3 * c + k] = (struct told_number){path[3 * c + k], is[k]};
        }
    json_t *json = written(&scene), *at = json_array_get(json_object_get(json, "rows"), 0);
    json_t *displacement = json_object_get(at, "displacement");
    told_json(json_incref(json_object_get(displacement, "lost_beside_edges")), edges,
              ARRAY_COUNT(edges));
    json_object_del(displacement, "lost_beside_edges");
    json_object_del(at, "findings");
    told_json(json, numbers, ARRAY_COUNT(numbers));
}

static const struct told_number finding_numbers[] = {
    {"0.ray", 601},
    {"0.got.prim", 603},
    {"0.got.t", 8},
    {"0.world.mask", 17},
    {"0.world.flags", 18},
    {"0.world.custom", 611},
    {"0.world.front", 1},
    {"0.world.got.instance", 617},
    {"0.world.got.geometry", 619},
    {"0.world.got.triangle", 621},
    {"0.world.expected.instance", 623},
    {"0.world.expected.geometry", 625},
    {"0.world.expected.triangle", 627},
};

/* Either of bits or of a judgement. */
static void the_json_of_a_finding(void **state)
{
    (void)state;
    const struct engine engine = engine_made();
    static struct row row;
    row = row_made(&engine);
    const struct check_scene scene = scene_made(&row);
    struct told_number all[ARRAY_COUNT(finding_numbers) + 6];
    size_t more = ARRAY_COUNT(finding_numbers);
    memcpy(all, finding_numbers, sizeof finding_numbers);
    row.finding[0].bits = true;
    all[more++] = (struct told_number){"0.expected.prim", 605};
    all[more++] = (struct told_number){"0.expected.t", 9};
    all[more++] = (struct told_number){"0.world.expected_custom", 613};
    all[more++] = (struct told_number){"0.world.expected_front", 0};
    told_json(row_json(&scene, "findings"), all, more);
    row.finding[0].bits = false;
    more = ARRAY_COUNT(finding_numbers);
    all[more++] = (struct told_number){"0.judgement.expected", 607};
    all[more++] = (struct told_number){"0.judgement.t_lo", 11};
    all[more++] = (struct told_number){"0.judgement.t_hi", 12};
    all[more++] = (struct told_number){"0.judgement.over", 13};
    all[more++] = (struct told_number){"0.judgement.displacement", 14};
    all[more++] = (struct told_number){"0.judgement.lost", 609};
    told_json(row_json(&scene, "findings"), all, more);
}

static void flags_of_the_json(void **state)
{
    (void)state;
    static const char *const flags[] = {"judged",
                                        "lists.closed",
                                        "compiled.translates",
                                        "compiled.decorated",
                                        "compiled.bits_free",
                                        "step.updated"};
    const struct engine engine = engine_made();
    const struct match_life life = {.count = 0};
    for (size_t i = 0; i < ARRAY_COUNT(flags); i++) {
        static struct row row;
        row = row_made(&engine);
        const struct check_scene scene = scene_made(&row);
        row.options.life = &life;
        row.judged = i == 0;
        row.lists.closed = i == 1;
        row.compiled.translates = i == 2;
        row.compiled.free = i != 3;
        row.bits = i != 4;
        row.life.updated = i == 5;
        told_flag(row_json(&scene, NULL), flags[i], flags, ARRAY_COUNT(flags));
    }
}

/* Where what was prepared anew answers all right, their number is 0; where nothing was, it is null.
 */
static void how_many_are_wrong_anew(void **state)
{
    (void)state;
    const struct engine engine = engine_made();
    const struct match_life life = {.count = 0};
    for (size_t i = 0; i < 4; i++) {
        static struct row row;
        row = row_made(&engine);
        const struct check_scene scene = scene_made(&row);
        row.options.life = &life;
        row.life.again = i >= 2;
        row.life.wrong_again = i % 2;
        json_t *json = row_json(&scene, NULL),
               *told = json_object_get(json_object_get(json, "step"), "wrong_anew");
        if (row.life.again)
            assert_int_equal(json_integer_value(told), row.life.wrong_again);
        assert_true(row.life.again ? json_is_integer(told) : json_is_null(told));
        json_decref(json);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_json_of_a_row),
        cmocka_unit_test(the_json_of_a_finding),
        cmocka_unit_test(flags_of_the_json),
        cmocka_unit_test(how_many_are_wrong_anew),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
