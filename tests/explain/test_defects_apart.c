/* Imitations of wrong tracers: no two of worlds answer alike, so that each names its own fault; and
 * a conservative test of oriented boxes turns no ray away that one moved as far as it was would
 * meet. */
#include "ref/base/rng.h"
#include "ref/explain/oriented.h"
#include "ref/explain/world_defect.h"
#include "scenes/rays/rays.h"
#include "scenes/rays/world_rays.h"
#include "scenes/worlds.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- worlds ----------------------------------------------------------------------------------- */

struct defect_answer {
    struct hit hit;
    uint32_t tag;
};

static bool apart[WORLD_DEFECT_COUNT][WORLD_DEFECT_COUNT];

/* Masks, flags, indices and geometries of all kinds; every other instance in a mirror. */
static void colour(struct world *world, struct rng *rng)
{
    for (uint32_t i = 0; i < world->mesh_count; i++)
        for (uint32_t g = 0; g < world->mesh[i].geometry_count; g++)
            world->mesh[i].geometry[g].opaque = g % 2;
    for (uint32_t i = 0; i < world->instance_count; i++) {
        struct instance *one = &world->instance[i];
        one->custom = rng_below(rng, 1u << 24);
        one->mask = one->mask ? 1 + rng_below(rng, 255) : 0;
        one->flags = rng_below(rng, 4) | (0x840u >> 4 * rng_below(rng, 3) & 15u);
        for (int k = 0; k < 4 && i % 2; k++)
            one->m[0][k] = -one->m[0][k];
    }
}

/* What the tracer with each defect answers to each ray; those that differ are noted. */
static void look_at(const char *spec, size_t count)
{
    struct rng rng = rng_make(5, 1);
    struct world world;
    struct world_look look;
    struct ray *ray = NULL;
    struct ray_mode *mode = NULL;
    struct reason reason = {""};
    assert_int_equal(world_open(spec, 3, &world, &reason), STATUS_OK);
    colour(&world, &rng);
    if (world_rays_new(&world, ray_set_find("mixed"), RAY_MODES_MIXED, 3, count, &ray, &mode,
                       &reason) ||
        world_look_make(&world, tri_test_find("mt"), &look, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < count; i++) {
        struct defect_answer answer[WORLD_DEFECT_COUNT];
        struct hit given = {.prim = ABI_NO_PRIM};
        memset(answer, 0, sizeof answer);
        if (i % 16 == 5)
            mode[i].mask = 0;
        if (i % 3)
            given.prim = rng_below(&rng, world_tri_count(&world));
        for (enum world_defect d = 0; d < WORLD_DEFECT_COUNT; d++) {
            world_look_bend(&look, d);
            world_look_trace(&look, i % 2 ? QUERY_ANY : QUERY_CLOSEST, &ray[i], mode[i], &given,
                             &answer[d].hit, &answer[d].tag);
            for (enum world_defect k = 0; k < d; k++)
                if (memcmp(&answer[d], &answer[k], sizeof answer[d]) != 0)
                    apart[d][k] = true;
        }
    }
    world_look_free(&look);
    free(ray);
    free(mode);
    world_free(&world);
}

static void no_two_wrong_tracers_answer_alike(void **state)
{
    (void)state;
    look_at("mixed:count=60", 1500);
    look_at("placed-stretched:count=5", 300);
    look_at("crowd:n=1100,size=0.3", 40); /* numbers of more than ten bits */
    for (enum world_defect d = 0; d < WORLD_DEFECT_COUNT; d++)
        for (enum world_defect k = 0; k < d; k++)
            if (!apart[d][k])
                fail_msg("one that %s answers as one that %s", world_defect_about(d)->text,
                         world_defect_about(k)->text);
}

/* --- oriented boxes --------------------------------------------------------------------------- */

static const int8_t axes[][3][3] = {{{1, 0, 0}, {0, 1, 1}, {0, -1, 1}},
                                    {{2, -1, 2}, {2, 2, -1}, {-1, 2, 2}},
                                    {{6, 2, 3}, {-3, 6, 2}, {-2, -3, 6}}};

/* A small box about a point, and a ray through the point that begins `by` off along each axis. */
static bool turned_away(struct rng *rng, float off, float by)
{
    const int8_t(*a)[3] = axes[rng_below(rng, 3)];
    struct oblique_box box = {.slack = 0x1p-18f};
    struct oblique_ray ray = {.by = by, .least = 0};
    float point[3];
    for (int k = 0; k < 3; k++) {
        point[k] = rng_range(rng, -2, 2);
        ray.dir[k] = rng_range(rng, -1, 1);
    }
    for (int k = 0; k < 3; k++)
        ray.org[k] = point[k] - 3 * ray.dir[k] + (rng_below(rng, 2) ? off : -off);
    for (int j = 0; j < 3; j++) {
        double at = 0;
        for (int k = 0; k < 3; k++) {
            box.axis[j][k] = a[j][k];
            at += (double)a[j][k] * (double)point[k];
        }
        box.lo[j] = (float)at - 0x1p-10f;
        box.hi[j] = (float)at + 0x1p-10f;
    }
    return oriented_conservative(&box, &ray, 100);
}

static void a_ray_that_was_moved_is_not_turned_away(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 1);
    uint32_t away = 0;
    for (uint32_t i = 0; i < 3000; i++) {
        assert_false(turned_away(&rng, 0, 0));
        assert_false(turned_away(&rng, 0.25f, 0.25f));
        away += turned_away(&rng, 0.25f, 0);
    }
    assert_true(away > 2000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_two_wrong_tracers_answer_alike),
        cmocka_unit_test(a_ray_that_was_moved_is_not_turned_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
