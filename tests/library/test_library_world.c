/* Laws of worlds in ref/library/raydiff.h: numbers of placed triangles, masks, and that the library
 * judges as `raydiff judge` does a file of version 2. */
#include "ref/library/raydiff.h"
#include "ref/match/match.h"
#include "ref/oracle/oracle_world.h"
#include "ref/outside/recorded.h"
#include "scenes/rays/world_rays.h"
#include "scenes/scenes.h"

#include <math.h>
#include <stdarg.h>
#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define RAYS      3000u
#define INSTANCES 6u
#define MESHES    2u

/* Two meshes in six instances, for the library and for the match beside it. */
struct library_world {
    struct scene scene[MESHES];
    struct raydiff_mesh mesh[MESHES];
    struct raydiff_instance instance[INSTANCES];
    struct world world;
    struct raydiff_oracle *oracle;
    struct ray *ray;
    struct ray_mode *mode;
    uint32_t mask[RAYS];
    struct hit hit[RAYS];
    uint32_t tag[RAYS];
    struct raydiff_answer answer[RAYS];
    struct raydiff_judged judged[RAYS];
    struct pool pool;
    struct match match;
};

static void place(struct library_world *w)
{
    for (uint32_t i = 0; i < INSTANCES; i++) {
        const float s = 0.5f + 0.25f * (float)i;
        const float m[12] = {s, 0,    0.125f, 2.5f * (float)i, 0, i == 2 ? -s : s,
                             0, 0.5f, 0,      0.25f,           s, 0};
        memcpy(w->instance[i].transform, m, sizeof m);
        w->instance[i].mesh = i % MESHES;
        w->instance[i].mask = i == 5 ? 0 : 1u << (i % 3);
    }
}

static void make_world(struct library_world *w)
{
    static const char *const specs[MESHES] = {"sphere:n=4", "soup:n=40"};
    w->world = (struct world){.mesh_count = MESHES, .instance_count = INSTANCES, .borrows = true};
    w->world.mesh = calloc(MESHES, sizeof *w->world.mesh);
    w->world.instance = calloc(INSTANCES, sizeof *w->world.instance);
    for (uint32_t i = 0; i < MESHES; i++) {
        assert_int_equal(scene_open(specs[i], 1, &w->scene[i], NULL), STATUS_OK);
        const struct scene *scene = &w->scene[i];
        w->mesh[i] = (struct raydiff_mesh){scene->vertex, scene->index, scene->vertex_count,
                                           scene->tri_count};
        struct geometry *geometry = calloc(1, sizeof *geometry);
        *geometry = (struct geometry){.count = scene->tri_count, .opaque = true};
        w->world.mesh[i] = (struct world_mesh){&w->scene[i], geometry, 1};
    }
    for (uint32_t i = 0; i < INSTANCES; i++) {
        memcpy(w->world.instance[i].m, w->instance[i].transform, sizeof w->world.instance[i].m);
        w->world.instance[i].mesh = w->instance[i].mesh;
        w->world.instance[i].mask = w->instance[i].mask;
    }
    assert_int_equal(world_finish(&w->world, NULL), STATUS_OK);
}

static struct library_world *make(void)
{
    struct library_world *w = calloc(1, sizeof *w);
    struct raydiff_why why;
    struct reason reason;
    const struct match_options options = {.builder = builders[0],
                                          .build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT},
                                          .box = box_tests[0],
                                          .tri = tri_tests[0],
                                          .query = QUERY_CLOSEST,
                                          .repeats = 1,
                                          .brute_budget = UINT64_MAX};
    place(w);
    make_world(w);
    if (raydiff_oracle_make_world(w->mesh, MESHES, w->instance, INSTANCES, &w->oracle, &why))
        fail_msg("%s", why.line);
    assert_int_equal(
        world_rays_new(&w->world, ray_sets[0], RAY_MODES_ALL, 5, RAYS, &w->ray, &w->mode, NULL),
        STATUS_OK);
    for (size_t i = 0; i < RAYS; i++)
        w->mask[i] = w->mode[i].mask = i % 2 ? 0xFF : (uint32_t)(i / 2 % 8);
    if (match_make_world(&w->world, w->ray, w->mode, RAYS, &options, &w->pool, &w->match, &reason))
        fail_msg("%s", reason.text);
    return w;
}

static void end(struct library_world *w)
{
    match_free(&w->match);
    pool_free(&w->pool);
    raydiff_oracle_free(w->oracle);
    world_free(&w->world);
    for (uint32_t i = 0; i < MESHES; i++)
        scene_free(&w->scene[i]);
    free(w->ray);
    free(w->mode);
    free(w);
}

/* Answers of engine brute, one in five spoiled, with the tags that the library assumes. */
static void answer(struct library_world *w)
{
    struct row row;
    const uint32_t count = world_tri_count(&w->world);
    match_run(&w->match, engine_find("brute"), &row);
    assert_int_equal(row.status, ROW_OK);
    memcpy(w->hit, w->match.answer, sizeof w->hit);
    for (size_t i = 0; i < RAYS; i++) {
        struct hit *hit = &w->hit[i];
        if (i % 5 == 0 && i / 5 % 4 == 0)
            *hit = hit_none();
        else if (i % 5 == 0 && i / 5 % 4 == 1 && hit->prim != ABI_NO_PRIM)
            hit->prim = (hit->prim + 168) % count; /* the same triangle of another instance */
        else if (i % 5 == 0 && hit->prim != ABI_NO_PRIM)
            hit->t *= i % 2 ? 1.01f : 1.0f + 0x1p-22f;
        struct oracle_pair pair;
        w->tag[i] = 0;
        if (hit->prim != ABI_NO_PRIM) {
            oracle_pair(w->match.oracle, &w->ray[i], hit->prim, &pair);
            if (pair.det && oracle_is_front(w->match.oracle, &pair, hit->prim))
                w->tag[i] = ABI_TAG_FRONT;
        }
        w->answer[i] = (struct raydiff_answer){hit->t, hit->u, hit->v, hit->prim};
    }
}

static void library_and_command_judge_worlds_alike(void **state)
{
    (void)state;
    struct library_world *w = make();
    struct recorded recorded = {
        .ray = w->ray, .mode = w->mode, .hit = w->hit, .tag = w->tag, .count = RAYS};
    const struct engine *engine;
    struct raydiff_counts counts;
    struct raydiff_why why;
    struct row row;
    answer(w);
    for (int demand = 0; demand < 2; demand++) {
        const struct raydiff_judging how = {.mask = w->mask, .demand_watertight = demand};
        w->match.options.demands.watertight = demand;
        assert_int_equal(recorded_engine(&recorded, &engine, NULL), STATUS_OK);
        match_run(&w->match, engine, &row);
        assert_int_equal(row.status, ROW_OK);
        if (raydiff_judge(w->oracle, &how, w->ray->org, w->answer, RAYS, 0, w->judged, &counts,
                          &why))
            fail_msg("%s", why.line);
        for (int v = 0; v < RAYDIFF_VERDICTS; v++)
            assert_int_equal(counts.verdict[v], row.count[v]);
        for (int f = 1; f < RAYDIFF_FAULTS; f++)
            assert_int_equal(counts.fault[f], row.wrong[f]);
        assert_int_equal(counts.faults, row.differences);
        assert_int_equal(counts.in_fans, row.fans_lost);
        assert_int_equal(counts.hits, row.hits);
        assert_true(counts.displacement == row.displacement.most);
        assert_true(counts.fault[RAYDIFF_FAULT_MISSED] > 20 &&
                    counts.fault[RAYDIFF_FAULT_DISTANCE] > 20 &&
                    counts.verdict[RAYDIFF_VERDICT_RIGHT] > RAYS / 2);
        assert_true(counts.fault[RAYDIFF_FAULT_MASKED] > 0);
        for (size_t k = 0; k < row.finding_count; k++) {
            const size_t i = row.finding[k].ray_index;
            const struct raydiff_judging one = {.mask = w->mask + i};
            char text[RAYDIFF_REASON_BYTES], line[480];
            assert_int_equal(
                raydiff_reason(w->oracle, &one, w->ray[i].org, &w->answer[i], text, NULL),
                RAYDIFF_ERROR_NONE);
            judge_line(&row.finding[k].ray, &row.finding[k].judgement, &row.finding[k].got, line,
                       sizeof line);
            assert_non_null(strstr(text, line));
        }
    }
    end(w);
}

static void exact_answers_are_of_what_masks_meet(void **state)
{
    (void)state;
    struct library_world *w = make();
    struct raydiff_nearest *exact = calloc(RAYS, sizeof *exact), *all = calloc(RAYS, sizeof *all);
    size_t differ = 0;
    assert_int_equal(raydiff_exact(w->oracle, w->ray->org, w->mask, RAYS, 0, exact, NULL),
                     RAYDIFF_ERROR_NONE);
    assert_int_equal(raydiff_exact(w->oracle, w->ray->org, NULL, RAYS, 0, all, NULL),
                     RAYDIFF_ERROR_NONE);
    for (size_t i = 0; i < RAYS; i++) {
        assert_int_equal(exact[i].triangle, w->match.truth[i].prim);
        assert_int_equal(exact[i].kind, w->match.truth[i].class);
        differ += exact[i].triangle != all[i].triangle;
        uint32_t instance, triangle;
        if (all[i].triangle == RAYDIFF_NOTHING)
            continue;
        assert_int_equal(raydiff_placed(w->oracle, all[i].triangle, &instance, &triangle, NULL), 0);
        assert_int_equal(raydiff_first_of(w->oracle, instance) + triangle, all[i].triangle);
        assert_int_not_equal(instance, 5); /* it is inactive */
        assert_in_range(triangle, 0, w->mesh[instance % MESHES].triangle_count - 1);
    }
    assert_true(differ > 50);
    struct raydiff_crossing list[64];
    size_t found;
    for (size_t i = 0; i < 200; i++) {
        assert_int_equal(raydiff_exact_all(w->oracle, w->ray[i].org, 64, list, &found, NULL), 0);
        size_t k = 0;
        while (k < found && k < 64 && list[k].kind == RAYDIFF_CLASS_IN_PLANE)
            k++;
        assert_int_equal(k < found ? list[k].triangle : RAYDIFF_NOTHING, all[i].triangle);
    }
    free(exact);
    free(all);
    end(w);
}

static void hard_rays_are_those_of_the_world(void **state)
{
    (void)state;
    struct library_world *w = make();
    static float ray[8 * RAYS];
    assert_int_equal(raydiff_hard_rays(w->oracle, NULL, 5, RAYS, ray, NULL), RAYDIFF_ERROR_NONE);
    assert_memory_equal(ray, w->ray, sizeof ray);
    end(w);
}

static void triangles_are_instance_0(void **state)
{
    (void)state;
    static const float vertex[] = {0, 0, 0, 4, 0, 0, 0, 4, 0};
    static const uint32_t index[] = {0, 1, 2, 2, 1, 0};
    struct raydiff_oracle *oracle;
    uint32_t instance = 9, triangle = 9;
    assert_int_equal(raydiff_oracle_make(vertex, 3, index, 2, &oracle, NULL), 0);
    assert_int_equal(raydiff_placed(oracle, 1, &instance, &triangle, NULL), 0);
    assert_int_equal(instance, 0);
    assert_int_equal(triangle, 1);
    assert_int_equal(raydiff_placed(oracle, 2, &instance, &triangle, NULL), RAYDIFF_ERROR_INPUT);
    assert_int_equal(raydiff_first_of(oracle, 0), 0);
    assert_int_equal(raydiff_first_of(oracle, 1), 2);
    assert_int_equal(raydiff_first_of(oracle, 2), RAYDIFF_NOTHING);
    assert_int_equal(raydiff_first_of(NULL, 0), RAYDIFF_NOTHING);
    raydiff_oracle_free(oracle);
}

static void refused(enum raydiff_error error, const struct raydiff_why *why, const char *line)
{
    assert_int_equal(error, RAYDIFF_ERROR_INPUT);
    assert_string_equal(why->line, line);
}

static void what_is_no_world_is_named(void **state)
{
    (void)state;
    struct library_world *w = make();
    struct raydiff_oracle *oracle;
    struct raydiff_why why;
    struct raydiff_nearest exact[2];
    const struct raydiff_judging known = {.formula = "mt"};
    w->instance[3].mesh = 2;
    refused(raydiff_oracle_make_world(w->mesh, MESHES, w->instance, INSTANCES, &oracle, &why), &why,
            "instance 3: mesh 2, but the world has 2");
    assert_null(oracle);
    place(w);
    w->instance[4].mask = 256;
    refused(raydiff_oracle_make_world(w->mesh, MESHES, w->instance, INSTANCES, &oracle, &why), &why,
            "instance 4: mask 256 is over 255 (8 bits)");
    place(w);
    memset(w->instance[1].transform, 0, sizeof w->instance[1].transform);
    assert_int_equal(
        raydiff_oracle_make_world(w->mesh, MESHES, w->instance, INSTANCES, &oracle, &why),
        RAYDIFF_ERROR_INPUT);
    assert_non_null(strstr(why.line, "instance 1: "));
    w->mesh[1].vertex_count = 3;
    assert_int_equal(
        raydiff_oracle_make_world(w->mesh, MESHES, w->instance, INSTANCES, &oracle, &why),
        RAYDIFF_ERROR_INPUT);
    assert_non_null(strstr(why.line, "mesh 1: triangle 1: vertex index"));
    refused(raydiff_oracle_make_world(NULL, 1, NULL, 0, &oracle, &why), &why, "meshes: is NULL");
    w->mask[1] = 300;
    refused(raydiff_exact(w->oracle, w->ray->org, w->mask, 2, 0, exact, &why), &why,
            "ray 1: ray mask 300 is over 255 (8 bits)");
    refused(raydiff_judge(w->oracle, &known, w->ray->org, w->answer, 2, 0, NULL, NULL, &why), &why,
            "formula: in a world transforms are the tracer's own: it is unknown");
    refused(raydiff_check_tree(w->oracle, "", 0, NULL, &why), &why,
            "oracle: is of a world, a packed tree of triangles");
    assert_int_equal(raydiff_oracle_make(w->mesh[0].vertex, w->mesh[0].vertex_count,
                                         w->mesh[0].index, w->mesh[0].triangle_count, &oracle,
                                         NULL),
                     RAYDIFF_ERROR_NONE);
    refused(raydiff_exact(oracle, w->ray->org, w->mask, 1, 0, exact, &why), &why,
            "masks: there are no instances to meet");
    raydiff_oracle_free(oracle);
    end(w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(library_and_command_judge_worlds_alike),
        cmocka_unit_test(exact_answers_are_of_what_masks_meet),
        cmocka_unit_test(hard_rays_are_those_of_the_world),
        cmocka_unit_test(triangles_are_instance_0),
        cmocka_unit_test(what_is_no_world_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
