/* Scenes that are hardly any: none, one or two triangles, all centres the same, one huge among many
 * tiny ones, flat, a line, far away. Every builder's tree in every layout is packed or refused in
 * one line, and traced by every engine on the processor to what all triangles say. */
#include "ref/engine.h"
#include "ref/trace/trace.h"
#include "ref/packed/packed_check.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#define RAYS    24u
#define MANY    60u
#define ENGINES 5u

enum { NONE, ONE, TWO, SAME_CENTRE, COPIES, HUGE_AND_TINY, FLAT, LINE, FAR_AWAY, KINDS };

static const char *const kind_name[KINDS] = {
    "none", "one", "two", "equal centroids", "copies", "a huge", "flat", "a line", "1e30 far away"};

static struct scene scene_of(int kind)
{
    struct scene scene = built_soup(kind <= TWO ? (uint32_t)kind : MANY, 11);
    float *v = scene.vertex;
    for (size_t c = 0; c < 9 * (size_t)scene.tri_count; c++) {
        size_t prim = c / 9, corner = c / 3 % 3, k = c % 3;
        switch (kind) {
        case SAME_CENTRE:
            v[c] = (corner == 0 ? 1.0f : corner == 1 ? -1.0f : 0) * (float)(prim + 1 + k);
            break;
        case COPIES:
            v[c] = v[c % 9];
            break;
        case HUGE_AND_TINY:
            v[c] = prim == 7 ? v[c] * 1e6f : v[9 * prim + k] + (v[c] - v[9 * prim + k]) * 0.01f;
            break;
        case FLAT:
            v[c] = k == 1 ? 0.1f : v[c];
            break;
        case LINE:
            v[c] = k == 2 ? v[c] : -3;
            break;
        case FAR_AWAY:
            v[c] += 1e30f;
            break;
        default:
            break;
        }
    }
    return scene;
}

/* At the middles of triangles, from outside. The tiny ones are not so tiny that a formula in
 * float32 finds them where they are not, which only those notice who test all triangles. */
static void aim(const struct scene *scene, struct ray ray[RAYS])
{
    struct rng rng = rng_make(5, 0);
    for (uint32_t i = 0; i < RAYS; i++) {
        float v[3][3] = {{0}};
        ray[i] = (struct ray){.tmax = 1e30f};
        if (scene->tri_count)
            scene_tri(scene, i % scene->tri_count, v);
        for (int k = 0; k < 3; k++) {
            float back = rng_range(&rng, -30, 30);
            ray[i].org[k] = (v[0][k] + v[1][k] + v[2][k]) / 3 + back;
            ray[i].dir[k] = -back;
        }
    }
}

struct degenerate_asked {
    int kind;
    const struct builder *builder;
    const struct layout *layout;
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct ray ray[RAYS];
    struct hit truth[RAYS];
    void *engine[ENGINES];
};

static const char *const engine_name[ENGINES] = {"cpu", "cpu_stackless", "fast", "fast_small",
                                                 "dual_split"};

/* Whether what it packs loses nothing. */
static bool is_lossless(const struct degenerate_asked *a)
{
    return !a->builder->faithful && !a->layout->faithful &&
           strncmp(a->layout->name, "amd64_g", 7) != 0;
}

/* One line that begins with who says it. */
static void must_be_a_line(const struct degenerate_asked *a, const char *who,
                           const struct reason *reason)
{
    if (!reason->text[0] || strchr(reason->text, '\n') || strchr(reason->text, '?'))
        fail_msg("%s, %s, %s: %s says \"%s\"", kind_name[a->kind], a->builder->name,
                 a->layout->name, who, reason->text);
}

static void must_agree(const struct degenerate_asked *a, const char *engine, const struct hit *hit)
{
    for (uint32_t i = 0; i < RAYS; i++) {
        if (hit[i].prim != ABI_NO_PRIM)
            assert_in_range(hit[i].prim, 0, a->scene.tri_count - 1);
        bool is = hit[i].prim != ABI_NO_PRIM, should = a->truth[i].prim != ABI_NO_PRIM;
        /* What is out of contract, published to lose hits, or has no area has only to end. */
        if (a->kind < LINE && is_lossless(a) &&
            (is != should || (is && float_bits(hit[i].t) != float_bits(a->truth[i].t))))
            fail_msg("%s, %s, %s, %s: ray %u: t %a prim %d, expected t %a prim %d",
                     kind_name[a->kind], a->builder->name, a->layout->name, engine, i,
                     (double)hit[i].t, (int)hit[i].prim, (double)a->truth[i].t,
                     (int)a->truth[i].prim);
    }
}

/* Returns how many engines traced it. */
static uint32_t trace_it(struct degenerate_asked *a)
{
    const struct job job = {.scene = &a->scene,
                            .packed = &a->packed,
                            .box = box_test_find("watertight"),
                            .tri = tri_test_find("woop"),
                            .query = QUERY_CLOSEST};
    uint32_t traced = 0;
    for (size_t e = 0; e < ENGINES; e++) {
        struct reason reason = {""};
        struct trace_report report;
        struct hit hit[RAYS];
        const struct engine *engine = engine_find(engine_name[e]);
        enum status status = engine->prepare(a->engine[e], &job, &reason);
        if (!status)
            status = engine->trace(a->engine[e], a->ray, RAYS, hit, &report, &reason);
        if (status) {
            must_be_a_line(a, engine->name, &reason);
            if (status != STATUS_LIMIT && status != STATUS_UNSUPPORTED && is_lossless(a))
                fail_msg("%s, %s, %s, %s: %s", kind_name[a->kind], a->builder->name,
                         a->layout->name, engine->name, reason.text);
            continue;
        }
        must_agree(a, engine->name, hit);
        traced++;
    }
    return traced;
}

/* Returns whether the layout takes the tree. */
static bool pack_it(struct degenerate_asked *a, uint32_t *traced)
{
    struct reason reason = {""};
    enum status status = packed_make(a->layout, &a->bvh, &a->scene, &a->packed, &reason);
    if (status) {
        bool large = a->kind == HUGE_AND_TINY || a->kind == FAR_AWAY;
        must_be_a_line(a, "the layout", &reason);
        if (status != STATUS_LIMIT || a->packed.word || (is_lossless(a) && !large) ||
            strncmp(reason.text, a->layout->name, strlen(a->layout->name)) != 0)
            fail_msg("%s, %s, %s: status %d, %s", kind_name[a->kind], a->builder->name,
                     a->layout->name, status, reason.text);
        return false;
    }
    if (is_lossless(a) && packed_check(&a->packed, &a->scene, NULL, &reason))
        fail_msg("%s, %s: %s", kind_name[a->kind], a->builder->name, reason.text);
    *traced += trace_it(a);
    packed_free(&a->packed);
    return true;
}

static void engines_open(struct degenerate_asked *a)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    for (size_t e = 0; e < ENGINES; e++)
        assert_int_equal(engine_open(engine_find(engine_name[e]), &options, &a->engine[e], NULL),
                         STATUS_OK);
}

static void scenes_that_are_hardly_any(void **state)
{
    (void)state;
    struct degenerate_asked a = {.kind = 0};
    const struct build_options options = {.leaf = 3, .eps = BUILD_EPS_DEFAULT};
    engines_open(&a);
    for (; a.kind < KINDS; a.kind++) {
        uint32_t taken = 0, refused = 0, traced = 0, hits = 0;
        a.scene = scene_of(a.kind);
        aim(&a.scene, a.ray);
        for (uint32_t i = 0; i < RAYS; i++) {
            trace_brute(&a.scene, tri_test_find("woop"), QUERY_CLOSEST, &a.ray[i], &a.truth[i]);
            hits += a.truth[i].prim != ABI_NO_PRIM;
        }
        for (size_t b = 0; builders_all[b]; b++) {
            struct reason reason = {""};
            a.builder = builders_all[b];
            a.layout = layouts_all[0];
            if (a.builder->build(&a.scene, &options, &a.bvh, &reason)) {
                must_be_a_line(&a, "the builder", &reason);
                assert_true(a.builder->faithful);
                continue;
            }
            for (size_t l = 0; layouts_all[l]; l++) {
                a.layout = layouts_all[l];
                if (pack_it(&a, &traced))
                    taken++;
                else
                    refused++;
            }
            bvh_free(&a.bvh);
        }
        printf("%-16s %3u packed, %3u refused, %4u traced, %2u of %u rays hit\n", kind_name[a.kind],
               taken, refused, traced, hits, RAYS);
        assert_true(taken > 0 && traced > 0);
        assert_true(a.kind >= LINE || (hits > RAYS / 2) == (a.kind != NONE));
        scene_free(&a.scene);
    }
    for (size_t e = 0; e < ENGINES; e++)
        engine_find(engine_name[e])->close(a.engine[e]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_that_are_hardly_any),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
