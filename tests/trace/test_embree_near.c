/* Embree's default mode among layers that lie a few units of the last place apart, seen from one
 * place: what it answers behind a hit that its formula is sure of is within twice that hit's error,
 * or its box test may miss the hit. How near it comes to that is printed. */
#include "ref/engine.h"
#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#define LAYERS    4
#define TRIANGLES 48
#define RAYS      1000
#define SCENES    60

static struct {
    struct scene scene;
    struct ray ray[RAYS];
    struct hit hit[RAYS];
    struct oracle_answer truth[RAYS];
    size_t answers, behind, excused;
    double most; /* of what was answered behind a certain hit: by how much, over its bound */
} now;

/* Layers of one triangle: each a copy, farther from the origin by some u of its distance. Half of
 * them are flat along an axis and seen at a grazing angle, which is where the box test errs most.
 */
static void draw_layers(struct rng *rng, uint32_t first, const float origin[3])
{
    float v[3][3], scale = ldexpf(1.0f, (int)rng_below(rng, 8) - 4);
    uint32_t flat = rng_below(rng, 6);
    int power = -(int)rng_below(rng, 12);
    float height = ldexpf(rng_range(rng, -1.0f, 1.0f), power);
    for (int c = 0; c < 3; c++)
        for (uint32_t k = 0; k < 3; k++)
            v[c][k] = origin[k] + scale * (flat == k ? height : rng_range(rng, -1.0f, 1.0f));
    for (uint32_t layer = 0; layer < LAYERS; layer++) {
        double part = 1.0 + ldexp((double)(layer * (1u + rng_below(rng, 12))), -24);
        for (uint32_t c = 0; c < 3; c++)
            for (uint32_t k = 0; k < 3; k++)
                now.scene.vertex[9 * (first + layer) + 3 * c + k] =
                    (float)((double)origin[k] + ((double)v[c][k] - (double)origin[k]) * part);
    }
}

static void draw_scene(struct rng *rng)
{
    float far = ldexpf(1.0f, (int)(rng_below(rng, 6)) * 2 - 4), origin[3];
    if (scene_make(3 * TRIANGLES, TRIANGLES, &now.scene))
        fail_msg("no memory");
    for (uint32_t i = 0; i < 3 * TRIANGLES; i++)
        now.scene.index[i] = i;
    for (int k = 0; k < 3; k++)
        origin[k] = rng_below(rng, 4) ? rng_range(rng, -far, far) : 0.0f;
    for (uint32_t i = 0; i < TRIANGLES; i += LAYERS)
        draw_layers(rng, i, origin);
    for (size_t i = 0; i < RAYS; i++) {
        float v[3][3], w[3], sum = 0x1p-20f;
        for (int c = 0; c < 3; c++) {
            w[c] = rng_float(rng);
            sum += w[c];
        }
        scene_tri(&now.scene, rng_below(rng, TRIANGLES), v);
        now.ray[i] = (struct ray){.tmax = 1e30f};
        for (int k = 0; k < 3; k++) {
            float at = (w[0] * v[0][k] + w[1] * v[1][k] + w[2] * v[2][k]) / sum;
            now.ray[i].org[k] = origin[k];
            now.ray[i].dir[k] = at - origin[k];
        }
    }
}

/* How far behind certain hits the answer lies. */
static void measure(const struct oracle *oracle, const struct ray *ray, const struct hit *hit)
{
    static struct oracle_crossing *list;
    static size_t capacity;
    size_t count;
    struct reason reason;
    double t = hit->prim == ABI_NO_PRIM ? INFINITY : (double)hit->t;
    if (oracle_crossings(oracle, ray, t, &list, &capacity, &count, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < count; i++) {
        float v[3][3];
        scene_tri(&now.scene, list[i].prim, v);
        struct twin twin = twin_eval(TWIN_EMBREE, ROUNDING_EMBREE, ray, v);
        double over = (t - list[i].pair.t_hi) / twin.t_err;
        if (!twin.certain || !(over > 0.0))
            continue;
        now.behind++;
        if (over > 2.0)
            now.excused++;
        else
            now.most = fmax(now.most, over);
    }
}

static void play(const struct engine *engine, void *self)
{
    const struct model model = engine_model(engine, self, NULL);
    const struct job job = {.scene = &now.scene, .query = QUERY_CLOSEST};
    struct oracle *oracle;
    struct judge *judge;
    struct reason reason;
    if (engine->prepare(self, &job, &reason) ||
        engine->trace(self, now.ray, RAYS, now.hit, &(struct trace_report){0}, &reason) ||
        oracle_make(&now.scene, &oracle, &reason) ||
        oracle_closest(oracle, ORACLE_AUTO, ORACLE_CLOSED, now.ray, RAYS, 1, now.truth, NULL,
                       &reason) ||
        judge_make(oracle, &model, QUERY_CLOSEST, &judge, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < RAYS; i++) {
        struct judgement out;
        assert_int_equal(judge_answer(judge, &now.ray[i], &now.truth[i], &now.hit[i], &out), 0);
        if (out.verdict == VERDICT_WRONG) {
            char line[500];
            judge_line(&now.ray[i], &out, &now.hit[i], line, sizeof line);
            fail_msg("%s", line);
        }
        now.answers++;
        measure(oracle, &now.ray[i], &now.hit[i]);
    }
    judge_free(judge);
    oracle_free(oracle);
}

static void what_embree_loses_among_layers_is_within_its_errors(void **state)
{
    (void)state;
    const struct engine *engine = engine_find("embree");
    const struct engine_options options = {.threads = 1};
    struct rng rng = rng_make(14, 2);
    struct reason reason;
    void *self;
    const char *scenes = getenv("RAYDIFF_NEAR_SCENES");
    long count = scenes ? strtol(scenes, NULL, 10) : SCENES;
    if (engine_open(engine, &options, &self, &reason))
        skip();
    for (long i = 0; i < count; i++) {
        draw_scene(&rng);
        play(engine, self);
        scene_free(&now.scene);
    }
    engine->close(self);
    print_message(
        "%zu answers, %zu certain hits before them, by at most %.3f of twice their error; "
        "%zu that the box test may miss\n",
        now.answers, now.behind, now.most / 2.0, now.excused);
    assert_true(now.behind > 0 && now.most > 0.0 && now.excused > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_embree_loses_among_layers_is_within_its_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
