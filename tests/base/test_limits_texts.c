/* Law of every layout: a refusal's numbers are those of the scene. The limit it gives is the
 * border, the number is the one beyond it, and the node has that bound, also if a larger number of
 * the other sign is within the limit. */
#include "ref/base/half.h"
#include "ref/packed/packed_walk.h"
#include "ref/packed/refit.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "ref/store.h"
#include "tests/support/tree_fixture.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define TRIS 23u

static const uint32_t places[] = {0, 10, TRIS - 1};

static struct bvh build(const struct scene *scene, uint32_t leaf)
{
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct reason reason = {""};
    assert_int_equal(bvh_build(builder_find("median"), scene, &options, &bvh, &reason), 0);
    return bvh;
}

static float *coordinate(struct scene *scene, uint32_t prim, int axis)
{
    return &scene->vertex[3 * scene->index[3 * prim] + (uint32_t)axis];
}

/* The number behind these words of a text; 0 if there is none. */
static bool number_after(const char *text, const char *words, double *out)
{
    const char *at = strstr(text, words);
    char *end;
    *out = 0;
    if (!at)
        return false;
    at += strlen(words);
    if (strncmp(at, "FLT_MAX", 7) == 0) {
        *out = (double)FLT_MAX;
        return true;
    }
    *out = strtod(at, &end);
    return end != at;
}

static bool is_amd64(const struct layout *layout)
{
    return strncmp(layout->name, "amd64", 5) == 0;
}

/* --- the parts of a text ---------------------------------------------------------------------- */

/* One scene whose triangle `prim` is at `value` on an axis; another may be at `other`. */
struct text_case {
    const struct layout *layout;
    struct scene scene;
    struct bvh bvh;
    struct packed packed; /* of the grid, for a refit */
    struct reason reason;
    uint32_t prim;
    int axis;
    float value;
};

static struct text_case case_make(const struct layout *layout, uint32_t leaf, bool refit)
{
    struct text_case c = {.layout = layout, .scene = trees_grid(TRIS)};
    c.bvh = build(&c.scene, leaf);
    if (refit)
        assert_int_equal(packed_make(layout, &c.bvh, &c.scene, &c.packed, &c.reason), 0);
    return c;
}

static void case_free(struct text_case *c)
{
    packed_free(&c->packed);
    bvh_free(&c->bvh);
    scene_free(&c->scene);
}

static enum status try(struct text_case *c, uint32_t leaf)
{
    c->reason.text[0] = 0;
    if (c->packed.word)
        return packed_refit(&c->packed, &c->scene, &c->reason);
    struct packed packed;
    bvh_free(&c->bvh);
    c->bvh = build(&c->scene, leaf);
    enum status status = packed_make(c->layout, &c->bvh, &c->scene, &packed, &c->reason);
    packed_free(&packed);
    return status;
}

/* True if the triangle is an item below a reference; gives the bounds of all of them. */
static bool below(const struct text_case *c, const struct packed *packed, uint32_t ref,
                  struct box *all)
{
    struct wide node;
    bool found = false;
    packed->layout->load(packed, ref, &node);
    for (uint32_t i = 0; i < node.child_count; i++)
        found = below(c, packed, node.child[i], all) || found;
    for (uint32_t s = 0; s < node.item_count && node.child_count == 0; s++) {
        uint32_t prim = packed_item(packed, &node, s);
        struct box one = scene_tri_bounds(&c->scene, prim);
        box_add_box(all, &one);
        found = found || prim == c->prim;
    }
    return found;
}

static bool has_bound(const struct box *box, const struct text_case *c)
{
    return box->lo[c->axis] == c->value || box->hi[c->axis] == c->value;
}

static bool record_has_the_bound(const struct text_case *c, const struct packed *packed,
                                 uint32_t ref)
{
    struct box box = box_empty();
    return ref < packed->ref_count && below(c, packed, ref, &box) && has_bound(&box, c);
}

/* Layouts amd64 number nodes in one order, in which amd64_f32 has two records for each. */
static bool wide_node_has_the_bound(const struct text_case *c, uint32_t node)
{
    struct packed all;
    assert_int_equal(packed_make(layout_find("amd64_f32"), &c->bvh, &c->scene, &all, NULL), 0);
    bool has = 2 * node < all.node_count && record_has_the_bound(c, &all, all.root + 2 * node);
    packed_free(&all);
    return has;
}

/* "tree node 3", or for a refit "record 3"; layouts amd64: "node 3" of the wide tree, and records
 * in float16. */
static void node_has_the_bound(const struct text_case *c)
{
    const char *text = c->reason.text;
    double number;
    bool has = strstr(text, " the tree has ") != NULL;
    if (!has && c->packed.word)
        has = number_after(text, " record ", &number) &&
              record_has_the_bound(c, &c->packed, (uint32_t)number);
    else if (number_after(text, " tree node ", &number))
        has = number < c->bvh.node_count && has_bound(&c->bvh.node[(uint32_t)number].bounds, c);
    else if (number_after(text, " of node ", &number))
        has = wide_node_has_the_bound(c, (uint32_t)number);
    if (!has)
        fail_msg("'%s': it has no bound of %.9g", text, (double)c->value);
}

/* "x 0 to 1, y 0 to 1, z 0 to 70000": the bounds of what lies below one child. */
static bool is_a_box_of_the_tree(const struct text_case *c, const struct box *box)
{
    struct packed_walk walk;
    bool found = false;
    assert_int_equal(packed_walk_make(&c->packed, &walk), STATUS_OK);
    for (uint32_t i = 0; i < walk.visit_count && !found; i++) {
        struct box exact = box_empty();
        (void)below(c, &c->packed, walk.visit[i].ref, &exact);
        found = memcmp(&exact, box, sizeof exact) == 0;
    }
    packed_walk_free(&walk);
    return found;
}

static void box_is_the_one_beyond(const struct text_case *c)
{
    struct box box;
    char expected[300];
    const char *from = strstr(c->reason.text, ": a box, x ");
    assert_non_null(from);
    assert_int_equal(sscanf(from, ": a box, x %f to %f, y %f to %f, z %f to %f,", &box.lo[0],
                            &box.hi[0], &box.lo[1], &box.hi[1], &box.lo[2], &box.hi[2]),
                     6);
    (void)snprintf(expected, sizeof expected,
                   "%s: a box, x %.9g to %.9g, y %.9g to %.9g, z %.9g to %.9g, lies beyond the "
                   "frame",
                   c->layout->name, (double)box.lo[0], (double)box.hi[0], (double)box.lo[1],
                   (double)box.hi[1], (double)box.lo[2], (double)box.hi[2]);
    assert_string_equal(c->reason.text + strlen("rebuild: "), expected);
    if (!has_bound(&box, c) || !is_a_box_of_the_tree(c, &box))
        fail_msg("'%s': there is no such box", c->reason.text);
}

/* Judges the text of a refusal; returns the border, or 0 if it is a frame that was left. */
static double judge_text(const struct text_case *c)
{
    const char *text = c->reason.text + (c->packed.word ? strlen("rebuild: ") : 0);
    double limit = 0, value;
    size_t length = strlen(c->layout->name);
    assert_int_equal(strncmp(c->reason.text, "rebuild: ", 9) == 0, c->packed.word != NULL);
    if (strncmp(text, c->layout->name, length) != 0 || text[length] != ':')
        fail_msg("'%s' is not of %s", text, c->layout->name);
    if (strstr(text, "lies beyond the frame")) {
        box_is_the_one_beyond(c);
        return 0;
    }
    if (!number_after(
            text, is_amd64(c->layout) ? ": a bound as stored is at most " : ": a bound is at most ",
            &limit) ||
        !strstr(text, " in magnitude, "))
        fail_msg("'%s': no limit", text);
    /* 65488 is rounded to 65472, and one ulp outward is 65504. */
    limit = strcmp(c->layout->name, "amd64_g1") == 0 ? 65488 : (double)(float)limit;
    bool named = number_after(text, " has ", &value);
    if (named == is_amd64(c->layout))
        fail_msg("'%s': a number is missing, or too many", text);
    if ((named && (float)value != c->value) || fabs((double)c->value) <= limit)
        fail_msg("'%s': the bound is %.9g", text, (double)c->value);
    node_has_the_bound(c);
    return limit;
}

/* Numbers of another triangle, times the limit, on the same axis: a larger bound of the other sign,
 * but within the limit, must not be taken for the one beyond. */
static const float others[] = {0, 1, -1};

static const float far[] = {65520.0f, 131072.0f, 1e36f, 2e38f, 3e38f};

/* At the limit itself the scene is held, at the next float it is refused with that number. */
static void border_is(struct text_case *c, uint32_t leaf, double limit)
{
    float *at = coordinate(&c->scene, c->prim, c->axis);
    float sign = c->value < 0 ? -1.0f : 1.0f, was = *at;
    if (c->packed.word)
        return; /* a refit of the grid keeps the scene's frame; the border is that of packing */
    *at = sign * (float)limit;
    if (try(c, leaf))
        fail_msg("%s: %.9g is refused: %s", c->layout->name, (double)*at, c->reason.text);
    *at = c->value = sign * nextafterf((float)limit, INFINITY);
    if (limit < (double)FLT_MAX) {
        assert_int_equal(try(c, leaf), STATUS_LIMIT);
        assert_true(judge_text(c) == limit);
    }
    *at = was;
}

/* Of one place; returns how many were refused. */
static uint32_t refusals_of_place(struct text_case *c, uint32_t leaf, const struct scene *grid)
{
    float value = c->value;
    double limit = 0;
    uint32_t refused = 0;
    bool framed = c->packed.word && strstr(c->layout->name, "_scene"); /* also a refit's frame */
    for (size_t o = 0; o < ARRAY_COUNT(others) && (o == 0 || refused > 0); o++) {
        memcpy(c->scene.vertex, grid->vertex, 9 * TRIS * sizeof *grid->vertex);
        c->value = value;
        *coordinate(&c->scene, c->prim, c->axis) = value;
        if (others[o] != 0 && limit > 0 && !framed)
            *coordinate(&c->scene, (c->prim + 7) % TRIS, c->axis) = others[o] * (float)limit;
        if (try(c, leaf)) {
            limit = judge_text(c);
            refused++;
            if (o == 0 && c->prim == places[0] && limit > 0)
                border_is(c, leaf, limit);
        } else if (o > 0 && !is_amd64(c->layout)) { /* whose root may hold it, in float32 */
            fail_msg("%s: %.9g is held beside %.9g", c->layout->name, (double)value,
                     (double)others[o] * limit);
        }
    }
    return refused;
}

static uint32_t refusals_at(struct text_case *c, uint32_t leaf, float value)
{
    uint32_t refused = 0;
    struct scene grid = trees_grid(TRIS);
    for (size_t p = 0; p < ARRAY_COUNT(places); p++)
        for (int side = 0; side < 6; side++) {
            c->prim = places[p];
            c->axis = side / 2;
            c->value = side % 2 ? -value : value;
            refused += refusals_of_place(c, leaf, &grid);
        }
    scene_free(&grid);
    return refused;
}

static void must_give_its_numbers(bool refit)
{
    uint32_t refused = 0, layouts_refusing = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        uint32_t before = refused;
        if (refit && !layouts_all[l]->rebound) /* it is built anew, whatever the boxes */
            continue;
        for (size_t f = 0; f < ARRAY_COUNT(far) && !layouts_all[l]->faithful; f++) {
            uint32_t leaf = (uint32_t)(1 + f % 3);
            struct text_case c = case_make(layouts_all[l], leaf, refit);
            refused += refusals_at(&c, leaf, far[f]);
            case_free(&c);
        }
        layouts_refusing += refused > before;
    }
    assert_true(refused > 2000 && layouts_refusing > 20);
}

static void refusals_give_the_bound_beyond_the_limit(void **state)
{
    (void)state;
    must_give_its_numbers(false);
}

static void refusals_of_a_refit_give_the_bound_beyond_the_limit(void **state)
{
    (void)state;
    must_give_its_numbers(true);
}

static void refusals_name_what_is_not_finite(void **state)
{
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    for (size_t l = 0; layouts_all[l]; l++)
        for (uint32_t i = 0; i < 9 * TRIS && !layouts_all[l]->faithful; i += 4) {
            struct scene scene = trees_grid(TRIS);
            struct bvh bvh = trees_make(&scene, 2, TREES_BALANCED);
            struct packed packed;
            struct reason reason = {""};
            char expected[200];
            float was = scene.vertex[i];
            scene.vertex[i] = bad[i % 3];
            (void)snprintf(expected, sizeof expected,
                           "%s: triangle %u has a vertex that is not finite", layouts_all[l]->name,
                           i / 9);
            assert_int_equal(packed_make(layouts_all[l], &bvh, &scene, &packed, &reason),
                             STATUS_LIMIT);
            assert_string_equal(reason.text, expected);
            scene.vertex[i] = was;
            uint32_t node = i % bvh.node_count, k = i % 6;
            struct box *box = &bvh.node[node].bounds;
            *(k < 3 ? &box->lo[k] : &box->hi[k - 3]) = bad[i % 3];
            (void)snprintf(expected, sizeof expected,
                           "%s: tree node %u has a bound that is not finite", layouts_all[l]->name,
                           node);
            assert_int_equal(packed_make(layouts_all[l], &bvh, &scene, &packed, &reason),
                             STATUS_LIMIT);
            assert_string_equal(reason.text, expected);
            bvh_free(&bvh);
            scene_free(&scene);
        }
}

/* More items than any array here has: refused before the first is read. */
static void refusals_count_items(void **state)
{
    (void)state;
    struct scene scene = trees_grid(1);
    struct bvh bvh = trees_make(&scene, 1, TREES_BALANCED);
    uint32_t limited = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        const struct layout *layout = layouts_all[l];
        struct packed packed;
        struct reason reason = {""};
        double limit, said;
        bvh.prim_count = UINT32_MAX;
        if (!layout_is_wide(layout) || layout->faithful)
            continue;
        assert_int_equal(packed_make(layout, &bvh, &scene, &packed, &reason), STATUS_LIMIT);
        assert_true(number_after(reason.text, " at most ", &limit));
        if (strstr(reason.text, "at most 2^"))
            assert_true(number_after(reason.text, "at most 2^", &limit));
        if (strstr(reason.text, "at most 2^"))
            limit = ldexp(1, (int)limit);
        bvh.prim_count = (uint32_t)limit + 1;
        if (!strstr(reason.text, "a wide tree")) {
            assert_int_equal(packed_make(layout, &bvh, &scene, &packed, &reason), STATUS_LIMIT);
            limited++;
        }
        assert_true(number_after(reason.text, "this tree has ", &said) ||
                    number_after(reason.text, "this one has ", &said));
        assert_true((uint32_t)said ==
                    (strstr(reason.text, "a wide tree") ? UINT32_MAX : bvh.prim_count));
    }
    assert_true(limited > 1);
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refusals_give_the_bound_beyond_the_limit),
        cmocka_unit_test(refusals_of_a_refit_give_the_bound_beyond_the_limit),
        cmocka_unit_test(refusals_name_what_is_not_finite),
        cmocka_unit_test(refusals_count_items),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
