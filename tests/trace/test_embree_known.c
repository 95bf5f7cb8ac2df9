/* What fuzz/baseline.txt says of Embree 3 and 4, with numbers: two constants that do not scale, and
 * in worlds what roundings they make. Skipped where there is a newer Embree or none. */
#include "fuzz/findings/baseline.h"
#include "fuzz/play/player.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static void need_embree(void)
{
    const struct engine_options options = {.threads = 1};
    const struct engine *embree = engine_find("embree");
    char text[200] = "";
    void *self;
    struct reason reason;
    if (engine_open(embree, &options, &self, &reason))
        skip();
    embree->close(self);
    engine_describe(embree, &options, text, sizeof text);
    if (!version_told(text, "Embree 3..4.3.3"))
        skip();
}

struct known_question {
    float vertex[9][3][3];
    uint32_t triangles;
    struct ray ray;
    enum query query;
    bool in_world;             /* in one instance at the identity, but: */
    float wide;                /* x and z are scaled by this, if not 0 */
    struct filter_rule filter; /* then; not all: no triangle is opaque */
};

static struct fuzz_trial trial_of(const struct known_question *q)
{
    struct fuzz_trial trial;
    struct reason reason;
    if (fuzz_trial_make(3 * q->triangles, q->triangles, 1, &trial, &reason))
        fail_msg("%s", reason.text);
    memcpy(trial.scene.vertex, q->vertex, q->triangles * sizeof q->vertex[0]);
    for (uint32_t i = 0; i < 3 * q->triangles; i++)
        trial.scene.index[i] = i;
    trial.ray[0] = q->ray;
    trial.query = q->query;
    if (q->in_world && trial_world_make(q->triangles, 1, 1, 1, &trial.world, &reason))
        fail_msg("%s", reason.text);
    if (q->wide > 0)
        trial.world.instance[0].m[0][0] = trial.world.instance[0].m[2][2] = q->wide;
    if (q->in_world) {
        trial.world.filter = q->filter;
        trial.world.geometry[0].opaque = q->filter.kind == FILTER_ALL;
    }
    return trial;
}

/* What the engine does wrong, and what the baseline says of it: "" or the signature. */
static void play(const char *name, const struct known_question *q, char text[FUZZ_SIGNATURE_MOST])
{
    const struct engine *engine = engine_find(name);
    const struct engine_options options = {.threads = 1};
    struct fuzz_trial trial = trial_of(q);
    struct baseline baseline;
    struct baseline_answer answer;
    struct fuzz_result result;
    struct fuzz_player *player = NULL;
    struct fuzz_field field;
    struct reason reason;
    text[0] = 0;
    if (fuzz_field_make(&engine, 1, NULL, 0, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason) ||
        fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason) ||
        baseline_open(&baseline, &reason))
        fail_msg("%s", reason.text);
    if (result.finding_count > 0) {
        if (fuzz_explain(player, &trial, &result.finding[0], &reason))
            fail_msg("%s", reason.text);
        fuzz_signature_print(&result.finding[0].signature, text);
        baseline_ask(&baseline, &result.finding[0].signature, "embree: Embree 3.13.5", "2026-12-01",
                     &answer);
        assert_int_equal(answer.state, BASELINE_KNOWN);
        baseline_ask(&baseline, &result.finding[0].signature, "embree: Embree 4.3.3", "2026-12-01",
                     &answer);
        assert_int_equal(answer.state, BASELINE_KNOWN);
        baseline_ask(&baseline, &result.finding[0].signature, "embree: Embree 4.4.0", "2026-12-01",
                     &answer);
        assert_int_equal(answer.state, BASELINE_NEW);
    }
    baseline_close(&baseline);
    fuzz_player_close(player);
    fuzz_trial_free(&trial);
}

/* Triangles are so small that the triangle test is sure of them. */
#define SIZE 0x1p-50f

/* More than four triangles, so that Embree makes boxes. The ray runs along z at x = 0; triangle 0
 * reaches from x = -SIZE to `margin`, and is hit at z = t. The others lie aside. */
static struct known_question beside_a_border(float margin, float t)
{
    struct known_question q = {.triangles = 5, .ray = {.dir = {0, 0, 1}, .tmax = 1e30f}};
    const float first[3][3] = {{-SIZE, -SIZE, t}, {-SIZE, SIZE, t}, {margin, 0, t}};
    memcpy(q.vertex[0], first, sizeof first);
    for (int i = 1; i < 5; i++)
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                q.vertex[i][c][k] = first[c][k] - (k == 0 ? 4.0f * SIZE * (float)i : 0.0f);
    return q;
}

/* A direction of 0 is taken for 1e-18: at z = t the box test looks at x = 1e-18 t. */
static void a_direction_of_0_moves_the_ray_by_1e_18_t(void **state)
{
    (void)state;
    need_embree();
    static const struct {
        float margin, t;
        bool lost;
    } cases[] = {{0.5e-18f, 1, true},     {2e-18f, 1, false},     {2e-18f, 4, true},
                 {8e-18f, 4, false},      {1.25e-16f, 250, true}, {5e-16f, 250, false},
                 {0.5e-18f, 0.25f, false}};
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        char text[FUZZ_SIGNATURE_MOST];
        struct known_question q = beside_a_border(cases[i].margin, cases[i].t);
        play("embree_robust", &q, text);
        if (strcmp(text, cases[i].lost ? "embree_robust.-.missed.scale" : "") != 0)
            fail_msg("margin %g, t %g: '%s'", (double)cases[i].margin, (double)cases[i].t, text);
        for (int c = 0; c < 15; c++) /* 2^10 times as large, margins too, in the same place */
            for (int k = 0; k < 3; k++)
                q.vertex[c / 3][c % 3][k] *= 1024.0f;
        q.ray.dir[2] = 1024.0f;
        play("embree_robust", &q, text);
        assert_string_equal(text, "");
    }
}

/* Its sign is lost, too: a ray that leans away from the border is moved across it. */
static void the_sign_of_a_small_direction_is_lost(void **state)
{
    (void)state;
    need_embree();
    char text[FUZZ_SIGNATURE_MOST];
    struct known_question q = beside_a_border(0.5e-18f, 1);
    q.ray.dir[0] = -0x1p-60f; /* -8.7e-19 */
    play("embree_robust", &q, text);
    assert_string_equal(text, "embree_robust.-.missed.scale");
    q.ray.dir[0] = -0x1p-59f; /* -1.7e-18 is taken as it is */
    play("embree_robust", &q, text);
    assert_string_equal(text, "");
}

/* Found by a campaign of worlds: so do both box tests where the component is not 0. In the space of
 * the mesh a ray leans by -2^-60 a step and meets the plane y = 0 after 2^46 of them, at x = -1 -
 * 2^-14, where the second and all later triangles are; moved the other way it is at x = -1 + 2^-14,
 * beside their boxes. */
static void both_box_tests_move_rays_that_lean_by_less(void **state)
{
    (void)state;
    need_embree();
    static const char *const engine[] = {"embree", "embree_robust"};
    struct known_question q = {
        .triangles = 9,
        .in_world = true,
        .wide = 512,
        .ray = {.org = {-512, 1, 0}, .dir = {-0x1p-51f, -0x1p-46f, 0x1p-40f}, .tmax = INFINITY}};
    const float first[3][3] = {{0, 0, 0}, {-1, 0, 1}, {-1, 0, 0}};
    const float other[3][3] = {{-1, 0, 1}, {-2, 0, 0}, {-1, 0, 0}};
    for (int i = 0; i < 9; i++)
        memcpy(q.vertex[i], i == 0 ? first : other, sizeof first);
    for (size_t e = 0; e < ARRAY_COUNT(engine); e++) {
        char text[FUZZ_SIGNATURE_MOST], lost[64];
        struct known_question quick = q;
        snprintf(lost, sizeof lost, "%s.-.missed.scale", engine[e]);
        play(engine[e], &q, text);
        assert_string_equal(text, lost);
        for (int k = 0; k < 3; k++) /* the same line in a sixteenth of the steps */
            quick.ray.dir[k] *= 16.0f;
        play(engine[e], &quick, text);
        assert_string_equal(text, "");
    }
}

/* The determinant is a^2 d of a right angle of sides a, seen along d. */
/* Found in an hour of fuzzing. x spans 2^-117, y and z 1: no scale of all axes alike is right. */
static void an_axis_of_tiny_numbers_is_scaled_by_itself(void **state)
{
    (void)state;
    need_embree();
    char text[FUZZ_SIGNATURE_MOST];
    struct known_question q = {
        .triangles = 5, .ray = {.org = {0x1p-119f, 1, 0}, .dir = {0, -1, 0}, .tmax = INFINITY}};
    static const float thin[3][3] = {{0, 0, 1}, {0x1p-117f, 0, -1}, {0, 0, 0}};
    static const float line[3][3] = {{0, 0, 1}, {0, 0, 1}, {0, 1, 0}};
    for (int i = 0; i < 5; i++)
        memcpy(q.vertex[i], i < 4 ? thin : line, sizeof thin);
    play("embree_robust", &q, text);
    assert_string_equal(text, "embree_robust.-.missed.scale");
}

static void a_subnormal_determinant_gives_nan(void **state)
{
    (void)state;
    need_embree();
    for (int e = -44; e <= -38; e++) {
        char text[FUZZ_SIGNATURE_MOST];
        float a = ldexpf(1.0f, e), d = ldexpf(1.0f, -40);
        struct known_question q = {
            .triangles = 1,
            .vertex = {{{0, 0, 0}, {a, 0, 0}, {0, a, 0}}},
            .ray = {.org = {0.25f * a, 0.25f * a, -d}, .dir = {0, 0, d}, .tmax = 1e30f}};
        play("embree", &q, text);
        bool subnormal = a * a * d < 0x1p-126f;
        assert_string_equal(text, subnormal ? "embree.-.not_finite.scale" : "");
    }
}

/* At another scale an any-hit ray may be told of the farther triangle, which is as right; and where
 * the nearest hit lies at the begin of the range, the answer is the one behind. */
static void what_cures_need_not_be_the_nearest_hit(void **state)
{
    (void)state;
    need_embree();
    for (int nearer = 0; nearer < 2; nearer++) {
        char text[FUZZ_SIGNATURE_MOST];
        struct known_question q = beside_a_border(0.5e-18f, 1);
        memcpy(q.vertex[1], q.vertex[0], sizeof q.vertex[1]);
        for (int c = 0; c < 3; c++)
            q.vertex[nearer][c][2] = 0.875f;
        q.query = QUERY_ANY;
        play("embree_robust", &q, text);
        assert_string_equal(text, "embree_robust.-.missed.scale");
    }
    struct known_question q = {
        .triangles = 2,
        .vertex = {{{0x1p-51f, 0, 0}, {0, 0, -0x1p-46f}, {0x1p-45f, 0x1.8p-45f, 0}},
                   {{0x1p-51f, 0, 0}, {0, 0, -0x1p-46f}, {0, 0, -0x1.4p-46f}}},
        .ray = {.org = {0x1p-45f, 0x1.8p-45f, 0},
                .dir = {-0x1p-30f, -0x1.8p-30f, -0x1.4p-31f},
                .tmax = INFINITY}};
    char text[FUZZ_SIGNATURE_MOST];
    play("embree", &q, text);
    assert_string_equal(text, "embree.-.not_finite.scale");
}

/* A right angle of sides a, met within, off the lines of the filter's grid, from a little way off:
 * twice the sum of its edge functions is 2 a^2 |d|. */
static struct known_question met_in_the_middle(float a, float d)
{
    return (struct known_question){
        .vertex = {{{0, 0, a}, {a, 0, 0}, {0, 0, 0}}},
        .triangles = 1,
        .ray = {.org = {0.375f * a, 4 * a, 0.3125f * a}, .dir = {0, -d, 0}, .tmax = INFINITY},
        .in_world = true};
}

/* In scenes the twin of Embree's formula knows that constant. In worlds a filter reads u and v, and
 * takes one triangle for another's place. */
static void u_and_v_of_small_edge_functions_are_0(void **state)
{
    (void)state;
    need_embree();
    static const struct {
        float a, d;
        bool lost;
    } cases[] = {{0x1p-18f, 0x1p-26f, true}, {0x1p-18f, 0x1p-20f, false},
                 {0x1p-14f, 0x1p-34f, true}, {0x1p-14f, 0x1p-30f, false},
                 {0x1p-20f, 0x1p-22f, true}, {0x1p-20f, 0x1p-18f, false}};
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        char text[FUZZ_SIGNATURE_MOST];
        struct known_question q = met_in_the_middle(cases[i].a, cases[i].d);
        play("embree_robust", &q, text);
        if (strcmp(text, cases[i].lost ? "embree_robust.-.barycentric.scale" : "") != 0)
            fail_msg("a %g, d %g: '%s'", (double)cases[i].a, (double)cases[i].d, text);
        q.in_world = false;
        play("embree_robust", &q, text);
        assert_string_equal(text, "");
    }
}

/* Some seeds pass the cell of u = v = 0 and not the one that is hit, and some the other way round.
 * */
static void a_filter_takes_small_triangles_for_others(void **state)
{
    (void)state;
    need_embree();
    unsigned passed = 0, lost = 0;
    for (uint32_t seed = 0; seed < 24; seed++) {
        char text[FUZZ_SIGNATURE_MOST];
        struct known_question q = met_in_the_middle(0x1p-18f, 0x1p-26f);
        q.filter = (struct filter_rule){.kind = FILTER_CELLS, .seed = seed, .share = 128};
        play("embree_robust", &q, text);
        passed += strncmp(text, "embree_robust.-.opacity.", 24) == 0;
        lost += strncmp(text, "embree_robust.-.missed.", 23) == 0;
    }
    assert_true(passed > 0 && lost > 0);
}

/* Found by a campaign of worlds: from 2^24 away a triangle of size 2 has no normal. */
static void far_from_a_triangle_t_is_noise(void **state)
{
    (void)state;
    need_embree();
    char text[FUZZ_SIGNATURE_MOST];
    const struct known_question q = {.vertex = {{{0, -1, 1.5f}, {1.5f, 1, 1.5f}, {1, -1, 0}}},
                                     .triangles = 1,
                                     .ray = {.org = {-0x1.dbac2p+23f, -0x1.dbac22p+24f, 1},
                                             .dir = {0x1.dbac22p+0f, 0x1.dbac22p+1f, 0},
                                             .tmax = INFINITY},
                                     .in_world = true};
    play("embree_robust", &q, text);
    assert_string_equal(text, "embree_robust.-.distance.world");
}

/* Found by another: a flat box 1e-4 in front of the origin, at distance 2 of that of the axes. */
static void the_default_box_test_leaves_flat_boxes(void **state)
{
    (void)state;
    need_embree();
    char text[FUZZ_SIGNATURE_MOST];
    struct known_question q = {
        .vertex = {{{0, 0x1p-25f, 0x1.fb2984p+0f}, {0, 0, 0x1.fb298p+0f}, {0, 0, 0x1.fb2986p+0f}}},
        .triangles = 5,
        .ray = {.org = {-0x1.75p-13f, -0x1.23ep-13f, 0x1.fb284p+0f},
                .dir = {0x1.74fcp+0f, 0x1.23ep+0f, 0x1.458p-3f},
                .tmax = INFINITY},
        .in_world = true};
    const float other[3][3] = {{1, 0, 2}, {0, 0x1p-25f, 0x1.fb2984p+0f}, {0, 0, 0x1.fb2986p+0f}};
    for (int i = 1; i < 5; i++)
        memcpy(q.vertex[i], other, sizeof other);
    play("embree", &q, text);
    assert_string_equal(text, "embree.-.missed.world");
    play("embree_robust", &q, text);
    assert_string_equal(text, "");
    q.in_world = false;
    play("embree", &q, text);
    assert_string_equal(text, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_direction_of_0_moves_the_ray_by_1e_18_t),
        cmocka_unit_test(the_sign_of_a_small_direction_is_lost),
        cmocka_unit_test(both_box_tests_move_rays_that_lean_by_less),
        cmocka_unit_test(an_axis_of_tiny_numbers_is_scaled_by_itself),
        cmocka_unit_test(a_subnormal_determinant_gives_nan),
        cmocka_unit_test(what_cures_need_not_be_the_nearest_hit),
        cmocka_unit_test(u_and_v_of_small_edge_functions_are_0),
        cmocka_unit_test(a_filter_takes_small_triangles_for_others),
        cmocka_unit_test(far_from_a_triangle_t_is_noise),
        cmocka_unit_test(the_default_box_test_leaves_flat_boxes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
