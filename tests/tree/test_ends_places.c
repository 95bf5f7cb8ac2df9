/* Law of every layout, in every slot of a node, on each axis and side: the ends of the number
 * formats (both zeros, subnormals, the least normal number, the largest half and float) are held to
 * the bit where the bounds are floats, by the nearest half outward where they are halves, and else
 * outward; none is refused that is in range; and a ray finds what it finds without a tree. */
#include "ref/base/half.h"
#include "ref/packed/packed_check.h"
#include "ref/packed/packed_walk.h"
#include "ref/packed/refit.h"
#include "ref/store.h"
#include "ref/trace/trace.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/groups.h"

#include <float.h>
#include <math.h>

/* Tried with both signs. */
static const float ends[] = {0.0f,         0x1p-149f, 0x1.fffffcp-127f, FLT_MIN,
                             0x1p-100f,    0x1p-25f,  0x1p-24f,         0x1p-15f,
                             0x1.ffcp-15f, 0x1p-14f,  0x1.002p-14f,     0x1.0001p+10f,
                             HALF_MAX,     65505.0f,  0x1p100f,         FLT_MAX};

/* By any float, or by none that a GPU may flush; by a half likewise. */
enum bound_held { HELD_FLOAT, HELD_NORMAL, HELD_HALF, HELD_SUBNORMAL, HELD_OUTWARD };

/* The nearest that is outward and not subnormal. */
static float normal(float x, bool up)
{
    return x == 0 || fabsf(x) >= FLT_MIN ? x : (x > 0) == up ? copysignf(FLT_MIN, x) : 0;
}

static bool named(const struct layout *layout, const char *part)
{
    return strstr(layout->name, part) != NULL;
}

/* How bounds of a node at that depth are held. */
static enum bound_held held_by(const struct layout *layout, bool root)
{
    bool half = strcmp(layout->name, "amd64_f16") == 0;
    if (named(layout, "_f32_world"))
        return HELD_NORMAL;
    if (named(layout, "f32") || (root && (half || strcmp(layout->name, "amd64") == 0)))
        return HELD_FLOAT;
    if (half)
        return HELD_SUBNORMAL;
    half = strcmp(layout->name, "rf16") == 0 || strcmp(layout->name, "half4") == 0 ||
           named(layout, "_f16_world");
    return half ? HELD_HALF : HELD_OUTWARD;
}

/* May refuse a bound of that magnitude: `taken` is what it must take. */
static float taken(const struct layout *layout)
{
    if (named(layout, "f32") || strcmp(layout->name, "amd64") == 0)
        return FLT_MAX;
    if (named(layout, "tiny8") || named(layout, "cwbvh80") || named(layout, "gfx12"))
        return 0x1p100f;
    if (named(layout, "hpb64"))
        return 0x1p126f;
    if (named(layout, "obb8"))
        return 0x1p96f;
    return strcmp(layout->name, "amd64_g1") == 0 ? 65000.0f : HALF_MAX;
}

/* Of a leaf of one triangle: the bounds that its parent has for it. */
static void expect_bounds(const struct layout *layout, const struct packed *packed,
                          const struct packed_walk *walk, const struct scene *scene, size_t *met)
{
    for (uint32_t i = 1; i < walk->visit_count; i++) {
        const struct packed_visit *visit = &walk->visit[i];
        struct wide leaf;
        layout->load(packed, visit->ref, &leaf);
        if (leaf.child_count > 0 || leaf.item_count != 1)
            continue;
        struct box exact = scene_tri_bounds(scene, packed_item(packed, &leaf, 0));
        enum bound_held held = held_by(layout, visit->parent == 0);
        for (int k = 0; k < 3 && held != HELD_OUTWARD; k++) {
            float lo = exact.lo[k], hi = exact.hi[k];
            if (held == HELD_NORMAL) {
                lo = normal(lo, false);
                hi = normal(hi, true);
            } else if (held != HELD_FLOAT) {
                bool any = held == HELD_SUBNORMAL;
                lo = half_to_float(any ? half_down(lo) : half_bound_down(lo));
                hi = half_to_float(any ? half_up(hi) : half_bound_up(hi));
            }
            if (visit->box.lo[k] != lo || visit->box.hi[k] != hi)
                fail_msg("%s, reference %u, axis %d: %a %a is held as %a %a", layout->name,
                         visit->ref, k, (double)exact.lo[k], (double)exact.hi[k],
                         (double)visit->box.lo[k], (double)visit->box.hi[k]);
        }
        *met += 1;
    }
}

static void expect_answers(const struct packed *packed, const struct scene *scene, uint32_t prim)
{
    for (uint32_t k = 0; k < END_RAYS; k++) {
        struct ray ray = groups_end_ray(scene, prim, k);
        struct job job = {.scene = scene,
                          .packed = packed,
                          .box = box_test_find("watertight"),
                          .tri = tri_test_find("woop"),
                          .query = QUERY_CLOSEST};
        struct hit got, want;
        trace_brute(scene, job.tri, job.query, &ray, &want);
        assert_int_equal(trace_ray(&job, &ray, &got, NULL), STATUS_OK);
        if ((got.prim == ABI_NO_PRIM) != (want.prim == ABI_NO_PRIM) ||
            (got.prim != ABI_NO_PRIM && got.t != want.t))
            fail_msg("%s: triangle %d at %a, not %d at %a", packed->layout->name, (int)got.prim,
                     (double)got.t, (int)want.prim, (double)want.t);
    }
}

/* A packed tree of the scene: packed of the scene's own tree, or refitted from the tree before the
 * end was put into it. Refused: STATUS_LIMIT. */
static enum status make(const struct layout *layout, const struct groups *before,
                        const struct groups *g, bool refit, float value, struct packed *packed)
{
    struct reason reason = {""};
    const struct groups *of = refit ? before : g;
    enum status status = packed_make(layout, &of->bvh, &of->scene, packed, &reason);
    bool must = fabsf(value) <= taken(layout);
    if (refit) {
        assert_int_equal(status, STATUS_OK);
        status = packed_refit(packed, &g->scene, &reason);
        must = must && !named(layout, "_scene"); /* whose frame stays, as nodes of halves do */
        must = must && (fabsf(value) <= HALF_MAX || strcmp(layout->name, "amd64") != 0);
    }
    if (status && (status != STATUS_LIMIT || must))
        fail_msg("%s%s: %a is refused: %s", layout->name, refit ? ", refitted" : "", (double)value,
                 reason.text);
    if (status)
        packed_free(packed);
    return status;
}

/* The value in a leaf of the root's slot s, or of that slot of the node below it. */
struct end {
    uint32_t s;
    bool below, refit;
    int axis;
    enum bound_side side;
    float value;
};

static size_t try_end(const struct layout *layout, const struct end *end)
{
    struct groups g = {0}, before;
    struct packed packed;
    struct packed_walk walk;
    struct reason reason = {""};
    size_t met = 0;
    uint32_t prim = groups_of_one(&g, layout, end->s, end->below);
    before = g;
    groups_fill(&before);
    groups_grow(&before);
    groups_fill(&g);
    bool possible = groups_put_end(&g.scene, prim, end->axis, end->side, end->value);
    groups_grow(&g);
    if (possible && !make(layout, &before, &g, end->refit, end->value, &packed)) {
        if (packed_check(&packed, &g.scene, NULL, &reason))
            fail_msg("%s, %a: %s", layout->name, (double)end->value, reason.text);
        assert_int_equal(packed_walk_make(&packed, &walk), STATUS_OK);
        expect_bounds(layout, &packed, &walk, &g.scene, &met);
        if (fabsf(end->value) <= 65505.0f)
            expect_answers(&packed, &g.scene, prim);
        packed_walk_free(&walk);
        packed_free(&packed);
    }
    groups_free(&g);
    groups_free(&before);
    return met;
}

/* Every value with every slot, axis and side; in turns as a leaf of the root or below it, and
 * refitted. */
static void ends_of_numbers_are_held_in_every_slot(void **state)
{
    (void)state;
    for (size_t l = 0; layouts_all[l]; l++) {
        const struct layout *layout = layouts_all[l];
        size_t met = 0, tried = 0;
        for (uint32_t s = 0; s < layout->width && !layout->faithful; s++)
            for (size_t e = 0; e < 2 * ARRAY_COUNT(ends); e++)
                for (int axis = 0; axis < 3; axis++)
                    for (enum bound_side side = 0; side < SIDES; side++, tried++) {
                        struct end end = {.s = s,
                                          .below = (e + (size_t)axis) % 2,
                                          .axis = axis,
                                          .side = side,
                                          .value = e % 2 ? -ends[e / 2] : ends[e / 2]};
                        met += try_end(layout, &end);
                        end.below = !end.below;
                        end.refit = layout->rebound != NULL;
                        met += try_end(layout, &end);
                    }
        assert_true(met >= 2 * tried);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ends_of_numbers_are_held_in_every_slot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
