/* What rays from a surface meet, and fates that are planted. */
#include "tests/trace/spawned.h"

typedef void rounded_fn(const struct spawn_hit *hit, const float org[3], void *user);

/* Calls `use` with the hit as if its point, rounded to float32, were exact. noinline: the compiler
 * is to treat it as it treats any such code. */
__attribute__((noinline)) static void with_rounded(const struct spawn_hit *from, rounded_fn *use,
                                                   void *user)
{
    struct spawn_hit hit = *from;
    float org[3];
    for (int k = 0; k < 3; k++) {
        org[k] = (float)hit.at[k];
        hit.at[k] = (double)org[k];
    }
    hit.fuzz = 0;
    use(&hit, org, user);
}

static void assert_rounded(const struct spawn_hit *hit, const float org[3], void *user)
{
    (void)user;
    assert_true(hit->at[0] == 0x1.99999ap-4);
    assert_true(hit->at[1] == 0x1.99999ap-3);
    assert_true(hit->at[2] == 0x1.333334p-2);
    assert_true(org[0] == 0x1.99999ap-4f && org[1] == 0x1.99999ap-3f && org[2] == 0x1.333334p-2f);
}

/* gcc 12.2 with -ftree-slp-vectorize keeps 0.1 and 0.2 as they are. */
static void rounding_to_float32_and_back_is_not_left_out(void **state)
{
    (void)state;
    struct spawn_hit hit = {.at = {0.1, 0.2, 0.3}, .fuzz = 1};
    with_rounded(&hit, assert_rounded, NULL);
}

struct fate_tally {
    const struct field *field;
    size_t met, missed, open;
};

static void compare_with_oracle(const struct spawn_hit *hit, const float org[3], void *user)
{
    struct fate_tally *tally = user;
    const struct field *f = tally->field;
    struct ray ray = spawn_ray(hit, org);
    for (uint32_t prim = 0; prim < f->scene.tri_count; prim++) {
        struct oracle_pair pair;
        double distance = -1;
        oracle_pair(f->oracle, &ray, prim, &pair);
        bool exact = pair.class == ORACLE_INSIDE && pair.range == ORACLE_WITHIN;
        enum spawn_meets meets = spawn_meets(&f->scene, hit, prim, &distance);
        tally->met += meets == SPAWN_MEETS;
        tally->missed += meets == SPAWN_MISSES;
        tally->open += meets == SPAWN_UNDECIDED;
        if (meets == SPAWN_MEETS)
            assert_true(exact && fabs(distance - pair.t_lo) <= 1e-6 * distance + 1e-13);
        if (meets == SPAWN_MISSES)
            assert_false(exact);
    }
}

/* From a point that is a float, what the ray meets is decided by the oracle, too. */
static void what_is_met_from_an_exact_point_is_what_the_oracle_says(void **state)
{
    (void)state;
    struct field *f = opened("soup:n=60,size=0.7", 1, 0);
    struct fate_tally tally = {.field = f};
    shoot(f, "random", "mt");
    for (size_t i = 0; i < f->count; i++)
        with_rounded(&f->hit[i], compare_with_oracle, &tally);
    assert_true(tally.met > 1000 && tally.missed > 1000);
    assert_true(tally.open < tally.met / 100);
    closed(f);
}

/* Triangles over each other at heights 0, 0.01 and 1, and one beside the first, rising from one of
 * its edges; the ray comes down on the first and leaves straight up. */
static struct field *storeys(void)
{
    static const float vertex[12][3] = {{0, 0, 0},     {4, 0, 0},     {0, 4, 0}, {0, 0, 0.01f},
                                        {4, 0, 0.01f}, {0, 4, 0.01f}, {0, 0, 1}, {4, 0, 1},
                                        {0, 4, 1},     {0, 0, 0},     {4, 0, 0}, {2, -2, 1}};
    struct field *f = calloc(1, sizeof *f);
    assert_non_null(f);
    assert_int_equal(scene_make(12, 4, &f->scene), STATUS_OK);
    for (uint32_t i = 0; i < 12; i++) {
        f->scene.index[i] = i;
        memcpy(f->scene.vertex + 3 * i, vertex[i], sizeof vertex[i]);
    }
    prepare(f);
    f->hit[0] = (struct spawn_hit){.primary = {{1, 1, 0.005f}, 0, {0, 0, -1}, 1e30f},
                                   .hit = {0.005f, 0.25f, 0.25f, 0},
                                   .at = {1, 1, 0},
                                   .normal = {0, 0, 1},
                                   .dir = {0, 0, 1}};
    f->count = 1;
    return f;
}

static struct spawn_fate fate_at(const struct field *f, const float org[3],
                                 const struct spawn_near *near)
{
    struct ray ray = spawn_ray(&f->hit[0], org);
    struct oracle_answer truth = truth_of(f, &ray);
    struct spawn_fate exact =
        spawn_fate_exact(f->oracle, &f->scene, &f->topology, &f->hit[0], near, org, &truth);
    struct spawn_fate answer =
        spawn_fate_answer(&f->scene, &f->topology, &f->hit[0], near, org, truth.prim);
    assert_memory_equal(&exact, &answer, sizeof exact); /* no ties here */
    return exact;
}

static void fates_are_told_apart(void **state)
{
    (void)state;
    struct field *f = storeys();
    const struct spawn_hit *hit = &f->hit[0];
    struct spawn_near near = spawn_near_find(&f->scene, hit, 0.005);
    assert_int_equal(near.prim, ABI_NO_PRIM);
    near = spawn_near_find(&f->scene, hit, 0.5);
    assert_int_equal(near.prim, 1);
    assert_false(near.undecided);
    assert_true(fabs(near.distance - 0.01) < 1e-9);
    const struct {
        float org[3];
        struct spawn_fate fate;
    } cases[] = {
        {{1, 1, 0}, {.self = true}},
        {{1, 1, -0.001f}, {.self = true}},
        {{1, 1, 0.001f}, {false}},
        {{1, 1, 0.009f}, {false}},
        {{1, 1, 0.011f}, {.near = true, .skipped = true}},
        {{1, 1, 2}, {.near = true, .skipped = true}},
        {{1, 1, -0.011f}, {.near = true, .self = true}},
        {{2, -0.5f, 0}, {.near = true, .beside = true, .skipped = true}}, /* onto the slope */
        {{9, 1, 0}, {.near = true, .skipped = true}},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct spawn_fate fate = fate_at(f, cases[i].org, &near);
        if (fate.self != cases[i].fate.self || fate.beside != cases[i].fate.beside ||
            fate.near != cases[i].fate.near || fate.skipped != cases[i].fate.skipped)
            fail_msg("case %zu: self %d, beside %d, near %d, skipped %d", i, fate.self, fate.beside,
                     fate.near, fate.skipped);
    }
    near.undecided = true; /* then nothing is said of skipping */
    struct spawn_fate fate = fate_at(f, cases[4].org, &near);
    assert_false(fate.near || fate.skipped);
    closed(f);
}

/* The triangle that the point lies on the border of may or may not be met. */
static void surfaces_at_the_point_itself_are_undecided(void **state)
{
    (void)state;
    struct field *f = storeys();
    struct spawn_hit *hit = &f->hit[0];
    double distance;
    hit->at[1] = 0; /* on the edge shared with the slope */
    hit->fuzz = 0x1p-40;
    assert_int_equal(spawn_meets(&f->scene, hit, 3, &distance), SPAWN_UNDECIDED);
    struct spawn_near near = spawn_near_find(&f->scene, hit, 0.5);
    assert_true(near.undecided);
    closed(f);
}

static void a_huge_offset_skips_surfaces(void **state)
{
    (void)state;
    struct field *f = opened("soup:n=60,size=0.7", 1, 0);
    size_t skipped[2] = {0}, near_count[2] = {0}, self = 0;
    shoot(f, "random", "mt");
    for (size_t i = 0; i < f->count; i++) {
        const struct spawn_hit *hit = &f->hit[i];
        static const float constant[2] = {1e-5f, 0.5f};
        float p[3], error[3], out[3];
        struct spawn_near near = spawn_near_find(&f->scene, hit, 1);
        spawn_point_make(hit, &f->scene, SPAWN_ALONG, p, error);
        for (int c = 0; c < 2; c++) {
            spawn_constant(p, hit->normal, constant[c], out);
            struct ray ray = spawn_ray(hit, out);
            struct oracle_answer truth = truth_of(f, &ray);
            struct spawn_fate fate =
                spawn_fate_exact(f->oracle, &f->scene, &f->topology, hit, &near, out, &truth);
            skipped[c] += fate.skipped;
            near_count[c] += fate.near;
            self += fate.self;
        }
    }
    assert_int_equal(self, 0);
    assert_true(near_count[1] > f->count / 4 && skipped[1] > near_count[1] / 2);
    assert_true(skipped[0] < skipped[1] / 100);
    closed(f);
}

/* A point in the plane x + y + z = 0 but for `off`, beside the triangle; the ray leaves upwards. */
static uint32_t steps_from(const struct field *f, float off)
{
    const struct spawn_hit hit = {.hit = {1, 0, 0, 0}, .normal = {1, 1, 1}, .dir = {1, 1, 1}};
    const float p[3] = {1, -1, off};
    float out[3];
    return spawn_least(f->oracle, &f->scene, &hit, p, out);
}

/* Two corners are (0.5, -0.5, 0) and (0, 1, -1) away from the first. A point is behind the plane if
 * it is by more than the bound on double's rounding, 12 2^-53 of the products' sizes, here 2. */
static void behind_is_what_is_certainly_behind(void **state)
{
    (void)state;
    static const float vertex[9] = {0, 0, 0, 0.5f, -0.5f, 0, 0, 1, -1};
    struct field *f = calloc(1, sizeof *f);
    assert_non_null(f);
    assert_int_equal(scene_make(3, 1, &f->scene), STATUS_OK);
    for (uint32_t i = 0; i < 3; i++)
        f->scene.index[i] = i;
    memcpy(f->scene.vertex, vertex, sizeof vertex);
    prepare(f);
    for (int side = -1; side <= 1; side += 2)
        for (int units = 0; units <= 64; units += 2) {
            float off = (float)(side * units) * 0x1p-53f;
            assert_int_equal(steps_from(f, off), side < 0 && units > 24 ? 1 : 0);
        }
    closed(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rounding_to_float32_and_back_is_not_left_out),
        cmocka_unit_test(what_is_met_from_an_exact_point_is_what_the_oracle_says),
        cmocka_unit_test(fates_are_told_apart),
        cmocka_unit_test(surfaces_at_the_point_itself_are_undecided),
        cmocka_unit_test(a_huge_offset_skips_surfaces),
        cmocka_unit_test(behind_is_what_is_certainly_behind),
    };
    return cmocka_run_group_tests_name("spawn_fate", tests, NULL, NULL) ? 1 : 0;
}
