/* Rays that start on a surface: the rules against numbers from paper, the bounds and the least
 * offset against exact answers. */
#include "tests/trace/spawned.h"

/* Of p over the hit's plane, on the side to leave. */
static double height_of(const struct field *f, const struct spawn_hit *hit, const float p[3])
{
    float v[3][3];
    double n[3], off = 0, square = 0, side = 0;
    scene_tri(&f->scene, hit->hit.prim, v);
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        n[k] = ((double)v[1][a] - (double)v[0][a]) * ((double)v[2][b] - (double)v[0][b]) -
               ((double)v[1][b] - (double)v[0][b]) * ((double)v[2][a] - (double)v[0][a]);
        off += n[k] * ((double)p[k] - (double)v[0][k]);
        square += n[k] * n[k];
        side += n[k] * (double)hit->normal[k];
    }
    return (side > 0 ? off : -off) / sqrt(square);
}

static const struct {
    const char *spec;
    float scale, offset;
    const char *rays;
} fields[] = {{"soup:n=60,size=0.7", 1, 0, "random"},
              {"soup:n=60,size=0.7", 1e-3f, 0, "random"},
              {"soup:n=60,size=0.7", 1e6f, 0, "random"},
              {"soup:n=60,size=0.7", 1, 1000, "random"},
              {"sphere:n=4", 1, 0, "random"},
              {"needles:n=200", 1, 0, "edges"}};

static void rules_move_by_what_their_sources_say(void **state)
{
    (void)state;
    const float p[3] = {1, -1, 0.01f}, n[3] = {1, 1, 1}, tilted[3] = {0.6f, 0, -0.8f};
    float out[3];
    spawn_constant(p, tilted, 0.25f, out);
    assert_true(out[0] == 1 + 0.25f * 0.6f && out[1] == -1 && out[2] == 0.01f - 0.25f * 0.8f);
    spawn_integer(p, n, out);
    assert_true(out[0] == 1 + 0x1p-15f);     /* 256 floats, each 2^-23 */
    assert_true(out[1] == -1 + 0x1p-16f);    /* 256 floats towards 0, each 2^-24 */
    assert_true(out[2] == 0.01f + 0x1p-16f); /* below 1/32: n / 65536 */
    spawn_integer(p, tilted, out);
    assert_true(out[0] == 1 + 153 * 0x1p-23f); /* (int) (256 * 0.6) */
    assert_true(out[1] == -1);
    const float error[3] = {0x1p-20f, 0x1p-21f, 0x1p-22f}, x[3] = {0, 1, 0}, zero[3] = {0, 0, 0};
    spawn_bound(p, error, x, out);
    assert_true(out[0] == 1 && out[2] == 0.01f);
    assert_true(out[1] == nextafterf(-1 + 0x1p-21f, 1));
    spawn_bound(p, zero, n, out);
    assert_memory_equal(out, p, sizeof p);
}

static void computed_points_keep_their_bounds(void **state)
{
    (void)state;
    for (size_t s = 0; s < ARRAY_COUNT(fields); s++) {
        struct field *f = opened(fields[s].spec, fields[s].scale, fields[s].offset);
        double largest[SPAWN_POINTS] = {0};
        shoot(f, fields[s].rays, s % 2 ? "woop" : "mt");
        for (size_t i = 0; i < f->count; i++) {
            const struct spawn_hit *hit = &f->hit[i];
            float p[3], error[3];
            spawn_point_make(hit, &f->scene, SPAWN_ALONG, p, error);
            for (int k = 0; k < 3; k++) {
                double off = fabs((double)p[k] - hit->at[k]);
                assert_true(off <= (double)error[k] + hit->fuzz);
                largest[SPAWN_ALONG] = fmax(largest[SPAWN_ALONG], off / (double)error[k]);
            }
            spawn_point_make(hit, &f->scene, SPAWN_BARYCENTRIC, p, error);
            double bound = 0;
            for (int k = 0; k < 3; k++)
                bound += fabs((double)hit->normal[k]) * (double)error[k];
            double off = fabs(height_of(f, hit, p));
            /* The float32 normal of a needle is tilted; the bound is for the exact one. */
            if (strcmp(fields[s].spec, "needles:n=200") != 0)
                assert_true(off <= bound * (1 + 1e-3));
            largest[SPAWN_BARYCENTRIC] = fmax(largest[SPAWN_BARYCENTRIC], off / bound);
        }
        /* Bounds that are never nearly reached would move rays for nothing. */
        assert_true(largest[SPAWN_ALONG] > 0.02 && largest[SPAWN_BARYCENTRIC] > 0.02);
        closed(f);
    }
}

/* The bound on a hit's coordinates is that of the worst of them, whichever it is. */
static void fuzz_is_of_every_coordinate(void **state)
{
    (void)state;
    size_t worst[3] = {0};
    for (size_t s = 0; s < ARRAY_COUNT(fields); s++) {
        struct field *f = opened(fields[s].spec, fields[s].scale, fields[s].offset);
        shoot(f, fields[s].rays, "mt");
        for (size_t i = 0; i < f->count; i++) {
            const struct spawn_hit *hit = &f->hit[i];
            double most = 0;
            int at = 0;
            for (int k = 0; k < 3; k++) {
                double org = (double)hit->primary.org[k], along = hit->at[k] - org;
                double one = 0x1p-39 * fabs(along) + 0x1p-51 * fabs(org);
                at = one > most ? k : at;
                most = fmax(most, one);
            }
            assert_true(hit->fuzz >= most * (1 - 1e-6) && hit->fuzz <= most * (1 + 1e-6));
            worst[at]++;
        }
        closed(f);
    }
    for (int k = 0; k < 3; k++)
        assert_true(worst[k] > 10);
}

static bool hits_own(const struct field *f, const struct spawn_hit *hit, const float org[3])
{
    struct oracle_pair pair;
    struct ray ray = spawn_ray(hit, org);
    oracle_pair(f->oracle, &ray, hit->hit.prim, &pair);
    return pair.class >= ORACLE_INSIDE && pair.class <= ORACLE_VERTEX &&
           pair.range != ORACLE_BELOW && pair.range != ORACLE_ABOVE;
}

static void offset_0_hits_its_own_triangle_and_the_bound_never_does(void **state)
{
    (void)state;
    for (size_t s = 0; s < ARRAY_COUNT(fields) - 1; s++) {
        struct field *f = opened(fields[s].spec, fields[s].scale, fields[s].offset);
        shoot(f, fields[s].rays, "mt");
        for (int point = 0; point < SPAWN_POINTS; point++) {
            size_t self = 0;
            for (size_t i = 0; i < f->count; i++) {
                float p[3], error[3], out[3];
                spawn_point_make(&f->hit[i], &f->scene, (enum spawn_point)point, p, error);
                self += hits_own(f, &f->hit[i], p);
                spawn_bound(p, error, f->hit[i].normal, out);
                assert_false(hits_own(f, &f->hit[i], out));
            }
            assert_true(self > f->count / 5);
        }
        closed(f);
    }
}

/* Every smaller number of steps leaves the ray hitting its triangle, or starting behind it. */
static void the_least_offset_is_the_least(void **state)
{
    (void)state;
    size_t moved = 0, many = 0;
    for (size_t s = 0; s < ARRAY_COUNT(fields); s++) {
        struct field *f = opened(fields[s].spec, fields[s].scale, fields[s].offset);
        shoot(f, fields[s].rays, "mt");
        for (size_t i = 0; i < f->count; i++) {
            const struct spawn_hit *hit = &f->hit[i];
            float p[3], error[3], out[3], before[3];
            spawn_point_make(hit, &f->scene, SPAWN_ALONG, p, error);
            uint32_t steps = spawn_least(f->oracle, &f->scene, hit, p, out);
            if (steps == SPAWN_NEVER)
                continue;
            assert_false(hits_own(f, hit, out));
            assert_true(spawn_offset(hit, out) <
                        (2 + (double)steps) * 0x1p-22 *
                                (fabs(hit->at[0]) + fabs(hit->at[1]) + fabs(hit->at[2])) +
                            spawn_offset(hit, p));
            float most = fmaxf(fmaxf(fabsf(p[0]), fabsf(p[1])), fabsf(p[2]));
            float step = nextafterf(most, INFINITY) - most;
            moved += steps > 0;
            many += steps > 64;
            if (steps == 0)
                continue;
            spawn_constant(p, hit->normal, (float)(steps - 1) * step, before);
            if (hits_own(f, hit, before))
                continue;
            assert_true(height_of(f, hit, before) < 0);
        }
        closed(f);
    }
    assert_true(moved > 500);
    assert_true(many > 0); /* the search beyond single steps was needed: needles */
}

/* Moved to the wrong side a ray never is free, but where it is at once; and the point stays. */
static void the_wrong_side_is_never_left(void **state)
{
    (void)state;
    size_t never = 0;
    struct field *f = opened(fields[0].spec, fields[0].scale, fields[0].offset);
    shoot(f, fields[0].rays, "mt");
    for (size_t i = 0; i < f->count && never < 200; i++) {
        struct spawn_hit hit = f->hit[i];
        float p[3], error[3], out[3] = {1e30f, 1e30f, 1e30f};
        for (int k = 0; k < 3; k++)
            hit.normal[k] = -hit.normal[k];
        spawn_point_make(&hit, &f->scene, SPAWN_ALONG, p, error);
        uint32_t steps = spawn_least(f->oracle, &f->scene, &hit, p, out);
        assert_true(steps == 0 || steps == SPAWN_NEVER);
        assert_memory_equal(out, p, sizeof p);
        never += steps == SPAWN_NEVER;
    }
    assert_true(never > 100);
    closed(f);
}

static void on_a_lattice_one_step_suffices(void **state)
{
    (void)state;
    struct field *f = opened("grid:height=0", 1, 0);
    shoot(f, "random", "woop");
    for (size_t i = 0; i < f->count; i++) {
        struct spawn_hit *hit = &f->hit[i];
        float p[3] = {hit->primary.org[0], hit->primary.org[1], 0}, out[3];
        float v[3][3];
        scene_tri(&f->scene, hit->hit.prim, v);
        for (int k = 0; k < 2;
             k++) /* a point of the plane z = 0 that is exact: a quarter's corner */
            p[k] = 0.5f * v[0][k] + 0.25f * (v[1][k] + v[2][k]);
        assert_int_equal(spawn_least(f->oracle, &f->scene, hit, p, out), 1);
        assert_true(out[2] != 0);
    }
    closed(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rules_move_by_what_their_sources_say),
        cmocka_unit_test(computed_points_keep_their_bounds),
        cmocka_unit_test(fuzz_is_of_every_coordinate),
        cmocka_unit_test(offset_0_hits_its_own_triangle_and_the_bound_never_does),
        cmocka_unit_test(the_least_offset_is_the_least),
        cmocka_unit_test(the_wrong_side_is_never_left),
        cmocka_unit_test(on_a_lattice_one_step_suffices),
    };
    return cmocka_run_group_tests_name("spawn", tests, NULL, NULL) ? 1 : 0;
}
