/* Changes of the shrinker's passes over the whole scene: maps of points, so that a ray's point at t
 * goes where the map takes it; and plainer rays that are aimed at features. */
#include "tests/worlds/trial_numbers.h"

/* A map of points p[k] -> by[k] p[k] - less[k]; directions by[k] / t, so that t is multiplied. */
struct frame_map {
    double by[3], less[3], t;
};

static void apply(struct fuzz_trial *trial, const struct frame_map *map)
{
    struct number of[NUMBERS];
    uint32_t n = numbers_of(trial, of);
    for (uint32_t i = 0; i < n; i++) {
        double x = (double)*of[i].x, by = map->by[of[i].axis];
        if (of[i].role <= ORG)
            *of[i].x = (float)(by * x - map->less[of[i].axis]);
        else if (of[i].role == DIR)
            *of[i].x = (float)(by * x / map->t);
        else if (of[i].role != TRANSFORM)
            *of[i].x = (float)(map->t * x);
    }
}

/* What a change of the frame that begins at a number is; false: there is none. */
static bool mapped_by_hand(struct fuzz_trial *want, uint32_t first, uint32_t variant)
{
    struct number of[NUMBERS];
    struct frame_map map = {{1, 1, 1}, {0, 0, 0}, 1};
    numbers_of(want, of);
    const struct number it = of[first];
    const double x = (double)*it.x;
    if (it.role > DIR || x == 0)
        return false;
    const double by = ldexp(1, -ilogb(x));
    for (int k = 0; k < 3 && (variant < 2 || variant == 3); k++)
        map.by[k] = variant == 3 ? 1 : by; /* 0: all, 1: places alone, 3: directions alone */
    if (variant == 1 || variant == 3)
        map.t = variant == 1 ? by : 1 / by;
    if (variant == 2 || variant == 6)
        map.by[it.axis] = variant == 2 ? by : -1;
    if (variant == 4)
        map.less[it.axis] = x;
    if (variant == 5 && it.role != ORG)
        return false;
    if (variant == 5) {
        struct ray *ray = &want->ray[(first - 3 * VERTICES) / 8];
        const double t = x / (double)ray->dir[it.axis];
        for (int k = 0; k < 3; k++)
            ray->org[k] = (float)((double)ray->org[k] - t * (double)ray->dir[k]);
        return isfinite(t);
    }
    apply(want, &map);
    return variant == 3   ? it.role == DIR
           : variant == 4 ? it.role <= ORG
                          : variant != 6 || first < 3;
}

static void the_frame_is_mapped_as_a_whole(void **state)
{
    (void)state;
    const struct shrink_pass *pass = pass_of("frame");
    assert_int_equal(pass->variants, 7);
    for (uint64_t index = 0; index < TRIALS; index++) {
        struct fuzz_trial was = draw(index, RAYS_MOST);
        for (uint32_t first = 0; first < pass->things(&was); first++)
            for (uint32_t variant = 0; variant < 7; variant++) {
                struct fuzz_trial is = copy_of(&was), want = copy_of(&was);
                bool changes = mapped_by_hand(&want, first, variant);
                assert_int_equal(pass->change(&is, first, 1, variant), changes);
                if (changes)
                    compare(&is, &want, variant == 5 ? 1e-4 : 0, "frame", first, variant);
                fuzz_trial_free(&is);
                fuzz_trial_free(&want);
            }
        fuzz_trial_free(&was);
    }
}

/* --- aim -------------------------------------------------------------------------------------- */

/* The feature's point of a placed triangle: on a corner, an edge, near a corner, or inside. */
static void feature_of(const struct fuzz_trial *trial, uint32_t thing, uint32_t feature,
                       double out[3])
{
    static const double share[] = {0, 0.5, 0.0625, 0.0078125, 0.00048828125, 0.25};
    const double side = share[feature / 3];
    const double weight[3] = {feature / 3 == 1 ? 0.5 : 1 - 2 * side, side,
                              feature / 3 == 1 ? 0 : side};
    const struct instance *one = &trial->world.instance[thing / TRIANGLES];
    const uint32_t *index = trial->scene.index + 3 * (size_t)(thing % TRIANGLES);
    for (int k = 0; k < 3; k++) {
        out[k] = (double)one->m[k][3];
        for (uint32_t c = 0; c < 3; c++)
            for (int j = 0; j < 3; j++)
                out[k] += weight[(c + 3 - feature % 3) % 3] * (double)one->m[k][j] *
                          (double)trial->scene.vertex[3 * (size_t)index[c] + (size_t)j];
    }
}

/* The ray comes along an axis, with length 1 or that of before, or as before, or as powers of two;
 * it begins before the point, in its whole range. */
static void a_ray_is_aimed_at_features_of_what_is_placed(void **state)
{
    (void)state;
    const struct shrink_pass *pass = pass_of("aim");
    assert_int_equal(pass->variants, 16 * 14);
    for (uint64_t index = 0; index < TRIALS; index++) {
        struct fuzz_trial was = draw(index, 1);
        assert_int_equal(pass->things(&was), TRIANGLES * INSTANCES);
        for (uint32_t thing = 0; thing < TRIANGLES * INSTANCES; thing++)
            for (uint32_t variant = 0; variant < pass->variants; variant++) {
                struct fuzz_trial is = copy_of(&was), want = copy_of(&was);
                uint32_t way = variant % 14;
                double point[3], most = 0, length;
                struct ray *ray = &want.ray[0];
                for (int k = 0; k < 3; k++)
                    most = fmax(most, fabs((double)ray->dir[k]));
                length = way >= 6 && way < 12 ? ldexp(1, ilogb(most)) : 1;
                feature_of(&was, thing, variant / 14, point);
                for (uint32_t k = 0; k < 3; k++) {
                    double d = (double)ray->dir[k];
                    if (way < 12)
                        d = way % 6 / 2 == k ? (way % 2 ? -length : length) : 0;
                    else if (way == 13 && d != 0)
                        d = copysign(ldexp(1, ilogb(d)), d);
                    ray->dir[k] = (float)d;
                    ray->org[k] = (float)(point[k] - d / length);
                }
                ray->tmin = 0;
                ray->tmax = INFINITY;
                assert_true(pass->change(&is, thing, 1, variant));
                compare(&is, &want, 1e-4, "aim", thing, variant);
                fuzz_trial_free(&is);
                fuzz_trial_free(&want);
            }
        fuzz_trial_free(&was);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_frame_is_mapped_as_a_whole),
        cmocka_unit_test(a_ray_is_aimed_at_features_of_what_is_placed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
