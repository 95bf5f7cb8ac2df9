/* Causes that only asking again can tell: engines that keep their inside to themselves, made here
 * to be wrong at one scale alone or at all, and engines that do not answer alike twice. */
#include "fuzz/play/player.h"
#include "fuzz/play/scaled.h"
#include "ref/trace/trace.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

enum causes_plan {
    PLAN_RIGHT,
    PLAN_THRESHOLD,    /* an absolute threshold of the determinant */
    PLAN_LOSES,        /* always a miss */
    PLAN_ONCE,         /* wrong the first time, then right */
    PLAN_TWICE,        /* wrong the first two times, then right */
    PLAN_FARTHER,      /* t is larger by planned.share of itself, at every scale */
    PLAN_NOW_AND_THEN, /* a hash of the ray's bits says which rays are lost */
    PLAN_FAR,          /* what is farther away than ten times the triangle's width is lost */
    PLAN_EACH_OTHER,   /* another wrong distance each time */
    PLAN_TOGETHER      /* several rays are not finished together, planned.fails times */
};

static struct {
    enum causes_plan plan;
    struct job job;
    uint32_t asked;
    float share;
    float narrow; /* if not 0, the triangle's size as a share of the distance it is seen from */
    uint32_t salt;
    uint32_t fails, flags; /* of PLAN_TOGETHER, the flags of the last call that fails */
} planned;

static uint32_t hash_of(const struct ray *ray)
{
    uint32_t hash = planned.salt, word[8];
    memcpy(word, ray, sizeof word);
    for (int i = 0; i < 8; i++)
        hash = (hash ^ word[i]) * 0x9E3779B1u ^ hash >> 15;
    return hash;
}

static enum status planned_open(const struct engine *engine, const struct engine_options *options,
                                void **self, struct reason *reason)
{
    (void)engine, (void)options, (void)reason;
    *self = &planned;
    planned.asked = 0;
    return STATUS_OK;
}

static enum status planned_prepare(void *self, const struct job *job, struct reason *reason)
{
    (void)self, (void)reason;
    planned.job = *job;
    return STATUS_OK;
}

static enum status planned_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                                 struct trace_report *report, struct reason *reason)
{
    (void)self, (void)reason;
    if (planned.plan == PLAN_TOGETHER && count > 1 && planned.fails > 0) {
        report->flags = --planned.fails ? ABI_FLAG_STACK : planned.flags;
        return STATUS_DEVICE;
    }
    const char *test = planned.plan == PLAN_THRESHOLD ? "mt_rtrs" : "mt";
    const struct hit miss = {.prim = ABI_NO_PRIM};
    for (size_t i = 0; i < count; i++) {
        planned.asked++;
        trace_brute(planned.job.scene, tri_test_find(test), QUERY_CLOSEST, &ray[i], &hit[i]);
        if (planned.plan == PLAN_LOSES || (planned.plan == PLAN_ONCE && planned.asked == 1) ||
            (planned.plan == PLAN_TWICE && planned.asked <= 2))
            hit[i] = miss;
        if (planned.plan == PLAN_FARTHER)
            hit[i].t *= 1 + planned.share;
        if (planned.plan == PLAN_NOW_AND_THEN && hash_of(&ray[i]) >> 31)
            hit[i] = miss;
        const float *v = planned.job.scene->vertex;
        if (planned.plan == PLAN_FAR && fabsf(ray[i].org[2]) > 10 * v[3])
            hit[i] = miss;
        if (planned.plan == PLAN_EACH_OTHER)
            hit[i].t += (float)planned.asked;
    }
    return STATUS_OK;
}

static struct model planned_model(const struct engine *engine, void *self,
                                  const struct tri_test *tri)
{
    (void)engine, (void)self, (void)tri;
    return (struct model){.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
}

static void planned_close(void *self)
{
    (void)self;
}

static const struct engine planned_engine = {.name = "planned",
                                             .open = planned_open,
                                             .prepare = planned_prepare,
                                             .trace = planned_trace,
                                             .model = planned_model,
                                             .close = planned_close};

/* A triangle of that size, a ray at its middle. */
static struct fuzz_trial one_triangle(float size)
{
    struct fuzz_trial trial;
    struct reason reason;
    if (fuzz_trial_make(3, 1, 1, &trial, &reason))
        fail_msg("%s", reason.text);
    const float wide = planned.narrow > 0.0f ? planned.narrow * size : size;
    const float vertex[9] = {0, 0, 0, wide, 0, 0, 0, wide, 0};
    memcpy(trial.scene.vertex, vertex, sizeof vertex);
    for (uint32_t i = 0; i < 3; i++)
        trial.scene.index[i] = i;
    const float before = planned.narrow > 0.0f ? 1 : 0; /* the ray comes from aside */
    trial.ray[0] = (struct ray){.org = {(0.25f - before) * wide, 0.25f * wide, -size},
                                .dir = {before * wide, 0, size},
                                .tmax = 1000.0f};
    return trial;
}

/* What a triangle of that size comes to: "" or kind.cause. */
static void play(enum causes_plan plan, float size, char text[FUZZ_SIGNATURE_MOST])
{
    const struct engine *engine = &planned_engine;
    const struct engine_options options = {.threads = 1};
    struct fuzz_trial trial = one_triangle(size);
    struct fuzz_result result;
    struct fuzz_player *player = NULL;
    struct fuzz_field field;
    struct reason reason;
    planned.plan = plan;
    text[0] = 0;
    if (fuzz_field_make(&engine, 1, NULL, 0, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason) ||
        fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
    assert_true(result.finding_count <= 1);
    if (result.finding_count > 0) {
        if (fuzz_explain(player, &trial, &result.finding[0], &reason))
            fail_msg("%s", reason.text);
        fuzz_signature_print(&result.finding[0].signature, text);
    }
    fuzz_player_close(player);
    fuzz_trial_free(&trial);
}

static void a_cause_is_found_by_asking_again(void **state)
{
    (void)state;
    static const struct {
        enum causes_plan plan;
        float size;
        const char *signature;
    } expected[] = {
        {PLAN_RIGHT, 4e-3f, ""},
        {PLAN_THRESHOLD, 4e-3f, "planned.-.missed.scale"},
        {PLAN_THRESHOLD, 5e-3f, ""}, /* 1.25e-7 is above the threshold */
        {PLAN_LOSES, 4e-3f, "planned.-.missed.outside"},
        {PLAN_LOSES, 0x1p38f, "planned.-.missed.outside"}, /* as large as can be: no other scale */
        {PLAN_ONCE, 4e-3f, "planned.-.missed.not_repeatable"},
        {PLAN_TWICE, 4e-3f, "planned.-.missed.not_repeatable"},
        {PLAN_EACH_OTHER, 4e-3f, "planned.-.distance.not_repeatable"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(expected); i++) {
        char text[FUZZ_SIGNATURE_MOST];
        play(expected[i].plan, expected[i].size, text);
        if (strcmp(text, expected[i].signature) != 0)
            fail_msg("plan %d, triangle of %g: '%s', not '%s'", (int)expected[i].plan,
                     (double)expected[i].size, text, expected[i].signature);
    }
}

/* A distance that is wrong by the same share at every scale: what changes with axes of their own is
 * the judge's measure of it, so that somewhere it is called right. And rays that are lost now and
 * then, at any scale: half of them are right at the last one. */
static void what_is_wrong_at_any_scale_is_not_called_scale(void **state)
{
    (void)state;
    size_t farther = 0, lost = 0;
    char text[FUZZ_SIGNATURE_MOST];
    planned.narrow = 0x1p-13f; /* some numbers are small, so that axes of their own are asked */
    for (planned.share = 0x1p-22f; planned.share < 0.01f; planned.share *= 1.0625f) {
        play(PLAN_FARTHER, 4e-3f, text);
        farther += strcmp(text, "planned.-.distance.outside") == 0;
        if (strstr(text, ".scale"))
            fail_msg("t off by %a: %s", (double)planned.share, text);
    }
    planned.narrow = 0x1p-10f;
    play(PLAN_FAR, 4e-3f, text); /* axes of their own change the ratio of width and distance */
    assert_string_equal(text, "planned.-.missed.outside");
    planned.narrow = 0.0f;
    for (planned.salt = 1; planned.salt < 60; planned.salt++) {
        play(PLAN_NOW_AND_THEN, 4e-3f, text);
        lost += strcmp(text, "planned.-.missed.outside") == 0;
        if (strstr(text, ".scale"))
            fail_msg("salt %u: %s", planned.salt, text);
    }
    assert_true(farther > 20 && lost > 15);
}

/* Rays that finish one by one and not together end in a loop's cap only if the loop alone ended
 * them when they are asked together again. */
static void rays_that_end_only_together_are_asked_again(void **state)
{
    (void)state;
    const struct engine *engine = &planned_engine;
    const struct engine_options options = {.threads = 1};
    const uint32_t other = ABI_FLAG_STACK | ABI_FLAG_VISITS;
    planned.plan = PLAN_TOGETHER;
    for (uint32_t flags = 0; flags < 256; flags++)
        for (uint32_t fails = 0; fails < 3; fails++) {
            struct fuzz_trial trial = one_triangle(1), both;
            struct fuzz_result result;
            struct fuzz_player *player = NULL;
            struct fuzz_field field;
            struct reason reason;
            assert_int_equal(fuzz_trial_make(3, 1, 2, &both, &reason), STATUS_OK);
            memcpy(both.scene.vertex, trial.scene.vertex, 9 * sizeof *trial.scene.vertex);
            memcpy(both.scene.index, trial.scene.index, 3 * sizeof *trial.scene.index);
            both.ray[0] = both.ray[1] = trial.ray[0];
            planned.fails = fails;
            planned.flags = flags;
            if (fuzz_field_make(&engine, 1, NULL, 0, &options, &field, &reason) ||
                fuzz_player_open(&field, &player, &reason) ||
                fuzz_play(player, &both, 1, &result, NULL, NULL, &reason))
                fail_msg("%s", reason.text);
            assert_int_equal(result.finding_count, fails > 0);
            if (fails > 0) {
                const struct fuzz_signature *is = &result.finding[0].signature;
                bool loop = fails > 1 && (flags & ABI_FLAG_LOOP) && !(flags & other);
                assert_int_equal(fuzz_explain(player, &both, &result.finding[0], &reason),
                                 STATUS_OK);
                assert_int_equal(is->kind, FUZZ_KIND_UNFINISHED);
                assert_int_equal(is->cause, loop ? CAUSE_LOOP_CAP : CAUSE_NOT_REPEATABLE);
            }
            fuzz_player_close(player);
            fuzz_trial_free(&both);
            fuzz_trial_free(&trial);
        }
}

/* Each number of a hit counts, to the last bit; t alone is scaled, and a miss is a miss. */
static void a_scaled_hit_is_the_same_in_every_number(void **state)
{
    (void)state;
    const struct hit hit = {0.7f, 0.3f, 0.6f, 5}, miss = {.prim = ABI_NO_PRIM};
    for (int power = -40; power <= 40; power++) {
        const struct hit right = {ldexpf(hit.t, power), hit.u, hit.v, hit.prim};
        struct hit wrong[] = {right, right, right, right, right, miss};
        wrong[0].t = nextafterf(right.t, 0);
        wrong[1].u = nextafterf(right.u, 0);
        wrong[2].v = nextafterf(right.v, 1);
        wrong[3].prim--;
        wrong[4].t = ldexpf(right.t, 1);
        assert_true(fuzz_hit_is_scaled(&hit, &right, power));
        assert_true(fuzz_hit_is_scaled(&miss, &miss, power));
        assert_false(fuzz_hit_is_scaled(&miss, &right, power));
        for (size_t i = 0; i < ARRAY_COUNT(wrong); i++)
            assert_false(fuzz_hit_is_scaled(&hit, &wrong[i], power));
    }
}

/* Only exponents change: of positions alike, of the direction alike, of the range what follows. */
static void a_scaled_trial_is_the_same_question(void **state)
{
    (void)state;
    static const struct {
        float size, direction, tmin, tmax;
        int positions, directions;
        bool possible;
    } cases[] = {
        {0x1.8p-140f, 1, 0, 1000, 178, 38, true},        /* tmax becomes infinite */
        {1, 0x1p-20f, 0.75f, 1000, 38, 58, true},        /* tmin 0.75 * 2^-20 */
        {0x1p20f, 0x1p-39f, 0x1p-140f, 1, 18, 18, true}, /* 2^-59 of tmin would be 0 */
        {0x1p39f, 1, 0, 1, 0, 38, true},
        {0x1p39f, 0x1p39f, 0, 1, 0, 0, false},
        {0x1p41f, 1, 0, 1, 0, 0, false},
        {INFINITY, 1, 0, 1, 0, 0, false},
        {1, NAN, 0, 1, 0, 0, false},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct fuzz_trial trial = one_triangle(cases[i].size), scaled;
        struct ray *ray = &trial.ray[0];
        struct reason reason;
        bool possible;
        int power;
        *ray = (struct ray){
            {cases[i].size, 0, 0}, cases[i].tmin, {0, 0, cases[i].direction}, cases[i].tmax};
        assert_int_equal(fuzz_trial_scaled(&trial, 0, FUZZ_SCALE_ALL, FUZZ_SCALE_STEPS, &scaled,
                                           &power, &possible, &reason),
                         STATUS_OK);
        assert_int_equal(possible, cases[i].possible);
        if (possible) {
            int positions = cases[i].positions, directions = cases[i].directions;
            assert_int_equal(scaled.ray_count, 1);
            for (int k = 0; k < 9; k++)
                assert_true(scaled.scene.vertex[k] == ldexpf(trial.scene.vertex[k], positions));
            assert_true(scaled.ray[0].org[0] == ldexpf(ray->org[0], positions));
            assert_true(scaled.ray[0].dir[2] == ldexpf(ray->dir[2], directions));
            assert_true(scaled.ray[0].tmin == ldexpf(ray->tmin, positions - directions));
            assert_true(scaled.ray[0].tmax == ldexpf(ray->tmax, positions - directions));
            assert_int_equal(fuzz_trial_check(&scaled, &reason), STATUS_OK);
        } else {
            assert_null(scaled.ray);
        }
        fuzz_trial_free(&scaled);
        fuzz_trial_free(&trial);
    }
}

/* An axis of tiny numbers grows to the size of the others; t, and which corner is where, stay. */
static void axes_scale_each_by_itself(void **state)
{
    (void)state;
    static const struct {
        float dir[3], tmin, tmax;
        int positions[3], t;
        bool possible;
    } cases[] = {
        {{0, -1, 0}, 0, INFINITY, {155, 38, 38}, 0, true},
        {{0, -1, 0}, 0x1p-149f, 1, {155, 38, 38}, 0, true},
        {{0x1p-38f, -1, 0x1p-3f}, 0, 8, {155, 38, 38}, 79, true},
        {{1, 0, 0}, 0, 8, {155, 38, 38}, 117, true},
        {{1, 0, 0}, 0, 0x1.000002p20f, {155, 38, 38}, 117, true}, /* tmax becomes infinite */
        {{1, 0x1.8p-30f, 0}, 0, 8, {155, 38, 38}, 117, true},
        {{1, 0x1p-60f, 0}, 0, 8, {155, 38, 38}, 117, true}, /* 2^-139 */
        {{0, NAN, 0}, 0, 8, {0}, 0, false},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct fuzz_trial trial = one_triangle(1), scaled;
        struct ray *ray = &trial.ray[0];
        struct reason reason;
        bool possible;
        int power;
        for (int k = 0; k < 3; k++)
            trial.scene.vertex[3 * k] = (float)(k + 1) * 0x1p-118f; /* at most 2^-116 */
        trial.scene.vertex[8] = 1;
        *ray = (struct ray){{0x1p-119f, 1, 0}, cases[i].tmin, {0}, cases[i].tmax};
        memcpy(ray->dir, cases[i].dir, sizeof ray->dir);
        assert_int_equal(fuzz_trial_scaled(&trial, 0, FUZZ_SCALE_AXES, FUZZ_SCALE_STEPS, &scaled,
                                           &power, &possible, &reason),
                         STATUS_OK);
        if (possible != cases[i].possible)
            fail_msg("case %zu: %d", i, possible);
        for (int k = 0; k < 9 && possible; k++)
            assert_true(scaled.scene.vertex[k] ==
                        ldexpf(trial.scene.vertex[k], cases[i].positions[k % 3]));
        for (int k = 0; k < 3 && possible; k++) {
            assert_true(scaled.ray[0].org[k] == ldexpf(ray->org[k], cases[i].positions[k]));
            assert_true(scaled.ray[0].dir[k] ==
                        ldexpf(ray->dir[k], cases[i].positions[k] - cases[i].t));
        }
        assert_true(!possible || scaled.ray[0].tmin == ldexpf(ray->tmin, cases[i].t));
        assert_true(!possible || scaled.ray[0].tmax == ldexpf(ray->tmax, cases[i].t));
        fuzz_trial_free(&scaled);
        fuzz_trial_free(&trial);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cause_is_found_by_asking_again),
        cmocka_unit_test(what_is_wrong_at_any_scale_is_not_called_scale),
        cmocka_unit_test(rays_that_end_only_together_are_asked_again),
        cmocka_unit_test(a_scaled_hit_is_the_same_in_every_number),
        cmocka_unit_test(a_scaled_trial_is_the_same_question),
        cmocka_unit_test(axes_scale_each_by_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
