/* Changes of the shrinker's passes over transforms, by value (fuzz/shrink/shrink_places.c). All
 * numbers are small and whole or halves, so that nothing is rounded. */
#include "fuzz/shrink/shrink_inner.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include <math.h>

#define INSTANCES 3
#define VERTICES  7
#define RAYS      2
#define PLACES    21 /* changes of one place, then the same with rays that go along */

static const struct shrink_pass *pass_of(const char *name)
{
    for (size_t i = 0; shrink_passes[i]; i++)
        if (strcmp(shrink_passes[i]->name, name) == 0)
            return shrink_passes[i];
    fail_msg("no pass %s", name);
    return NULL;
}

/* Mesh 0 is triangle 0, mesh 1 triangle 1; vertex 6 is of no triangle. */
static struct fuzz_trial trial_of_places(void)
{
    static const float place[INSTANCES][12] = {{1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, -3},
                                               {2, 1, 0, 3, 0, -4, 0, 0, 0, 2, 0.5f, -6},
                                               {0, 8, 0, 1, 3, 0, 0, 2, 0, 0, -1, 4}};
    struct fuzz_trial trial;
    assert_int_equal(fuzz_trial_make(VERTICES, 2, RAYS, &trial, NULL), STATUS_OK);
    assert_int_equal(trial_world_make(2, 2, INSTANCES, RAYS, &trial.world, NULL), STATUS_OK);
    for (uint32_t i = 0; i < 3 * VERTICES; i++)
        trial.scene.vertex[i] = (float)((int)(i * 5) % 13 - 7);
    for (uint32_t i = 0; i < 6; i++)
        trial.scene.index[i] = i;
    for (uint32_t g = 0; g < 2; g++)
        trial.world.geometry[g] = (struct trial_geometry){g, 1, true};
    for (uint32_t i = 0; i < INSTANCES; i++) {
        memcpy(trial.world.instance[i].m, place[i], sizeof place[i]);
        trial.world.instance[i].mesh = i == 0 ? 1 : i - 1;
    }
    for (uint32_t r = 0; r < RAYS; r++)
        trial.ray[r] = (struct ray){{(float)r, 2, -16}, 0, {8, -4, 2 + 8 * (float)r}, INFINITY};
    return trial;
}

/* One of m's rows at a time: the linear part is a diagonal. */
static void put(struct instance *one, float x, float y, float z, const float t[3])
{
    const float diagonal[3] = {x, y, z};
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j < 3; j++)
            one->m[k][j] = j == k ? diagonal[k] : 0;
        one->m[k][3] = t[k];
    }
}

static float below(float x)
{
    return x == 0 ? 0 : copysignf(ldexpf(1, ilogbf(x)), x);
}

/* Its mesh where it was placed; false: it has none. */
static bool baked_by_hand(struct scene *scene, const struct instance *old)
{
    for (uint32_t v = 3 * old->mesh; v < 3 * old->mesh + 3 && old->mesh != WORLD_NO_MESH; v++) {
        float p[3];
        memcpy(p, scene->vertex + 3 * v, sizeof p);
        for (int k = 0; k < 3; k++)
            scene->vertex[3 * v + (uint32_t)k] =
                old->m[k][0] * p[0] + old->m[k][1] * p[1] + old->m[k][2] * p[2] + old->m[k][3];
    }
    return old->mesh != WORLD_NO_MESH;
}

/* What a change makes of instance `at`, from the names of the changes; false: there is none. */
static bool placed_by_hand(struct fuzz_trial *trial, uint32_t at, uint32_t how)
{
    static const float none[3] = {0, 0, 0};
    struct instance *one = &trial->world.instance[at];
    const struct instance old = *one;
    const float t[3] = {old.m[0][3], old.m[1][3], old.m[2][3]};
    const float x = old.m[0][0], y = old.m[1][1], z = old.m[2][2];
    float on[3] = {0, 0, 0}, mirror[3] = {1, 1, 1};
    switch (how) {
    case 0: /* the identity */
        put(one, 1, 1, 1, none);
        return true;
    case 1: /* of all */
        for (uint32_t i = 0; i < INSTANCES; i++)
            put(&trial->world.instance[i], 1, 1, 1, none);
        return true;
    case 2: /* the mesh where it was placed */
        put(one, 1, 1, 1, none);
        return baked_by_hand(&trial->scene, &old);
    case 3: /* translated only */
        put(one, 1, 1, 1, t);
        return true;
    case 4: /* not translated */
        for (int k = 0; k < 3; k++)
            one->m[k][3] = 0;
        return true;
    case 5: /* powers of two */
        put(one, below(x), below(y), below(z), t);
        return true;
    case 6: /* the diagonal */
        put(one, x, y, z, t);
        return true;
    case 7: /* without its signs */
        put(one, fabsf(x), fabsf(y), fabsf(z), t);
        return true;
    case 8: /* as the first */
        memcpy(one->m, trial->world.instance[0].m, sizeof one->m);
        return at > 0;
    case 9: /* as the one before */
        if (at > 0)
            memcpy(one->m, trial->world.instance[at - 1].m, sizeof one->m);
        return at > 0;
    case 10: /* change places */
        if (at > 0) {
            *one = trial->world.instance[at - 1];
            trial->world.instance[at - 1] = old;
        }
        return at > 0;
    default:
        if (how < 17) /* by 1 along an axis, or by 8: coordinates are at most 7 */
            on[(how - 11) % 3] = how < 14 ? 1 : 8;
        if (how > 17)
            mirror[how - 18] = -1;
        put(one, how == 17 ? 2 : mirror[0], how == 17 ? 2 : mirror[1], how == 17 ? 2 : mirror[2],
            on);
        return true;
    }
}

/* The point or direction p in the space of a mesh: W (p - T), W by Cramer's rule. */
static void into(const struct instance *one, const float p[3], bool moves, double out[3])
{
    double m[3][3], x[3], det = 0;
    for (int k = 0; k < 3; k++) {
        x[k] = (double)p[k] - (moves ? (double)one->m[k][3] : 0);
        for (int j = 0; j < 3; j++)
            m[k][j] = (double)one->m[k][j];
    }
    for (int j = 0; j < 3; j++)
        det += m[0][j] *
               (m[1][(j + 1) % 3] * m[2][(j + 2) % 3] - m[1][(j + 2) % 3] * m[2][(j + 1) % 3]);
    for (int j = 0; j < 3; j++) {
        int a = (j + 1) % 3, b = (j + 2) % 3;
        double sum = 0;
        for (int k = 0; k < 3; k++) {
            int c = (k + 1) % 3, d = (k + 2) % 3;
            sum += (m[c][a] * m[d][b] - m[c][b] * m[d][a]) * x[k];
        }
        out[j] = sum / det;
    }
}

static void same_trials(const struct fuzz_trial *is, const struct fuzz_trial *want,
                        uint32_t variant)
{
    for (uint32_t i = 0; i < 3 * VERTICES; i++)
        if (is->scene.vertex[i] != want->scene.vertex[i])
            fail_msg("variant %u: coordinate %u", variant, i);
    for (uint32_t i = 0; i < INSTANCES; i++) {
        assert_int_equal(is->world.instance[i].mesh, want->world.instance[i].mesh);
        for (int k = 0; k < 12; k++)
            if (is->world.instance[i].m[k / 4][k % 4] != want->world.instance[i].m[k / 4][k % 4])
                fail_msg("variant %u: instance %u, number %d", variant, i, k);
    }
}

/* Rays are as near in float32 as two transforms of whole numbers allow. */
static void rays_went_along(const struct fuzz_trial *is, const struct fuzz_trial *was,
                            const struct instance *from, const struct instance *to)
{
    for (uint32_t r = 0; r < RAYS; r++)
        for (int what = 0; what < 2; what++) {
            const float *old = what ? was->ray[r].dir : was->ray[r].org;
            const float *new = what ? is->ray[r].dir : is->ray[r].org;
            double inside[3];
            into(from, old, !what, inside);
            for (int k = 0; k < 3; k++) {
                double want = what ? 0 : (double)to->m[k][3];
                for (int j = 0; j < 3; j++)
                    want += (double)to->m[k][j] * inside[j];
                assert_true(fabs((double)new[k] - want) <= 1e-4);
            }
        }
}

static void every_change_of_a_place_is_what_its_name_tells(void **state)
{
    (void)state;
    const struct shrink_pass *pass = pass_of("places");
    assert_int_equal(pass->variants, 2 * PLACES);
    for (uint32_t at = 0; at < INSTANCES; at++)
        for (uint32_t none = 0; none < 2; none++)
            for (uint32_t variant = 0; variant < pass->variants; variant++) {
                struct fuzz_trial was = trial_of_places(), is = trial_of_places(),
                                  want = trial_of_places();
                uint32_t how = variant % PLACES;
                if (none)
                    was.world.instance[at].mesh = is.world.instance[at].mesh =
                        want.world.instance[at].mesh = WORLD_NO_MESH;
                assert_int_equal(pass->things(&is), INSTANCES);
                bool changes = placed_by_hand(&want, at, how);
                assert_int_equal(pass->change(&is, at, 1, variant), changes);
                if (changes)
                    same_trials(&is, &want, variant);
                if (changes && variant >= PLACES)
                    rays_went_along(&is, &was, &was.world.instance[at], &want.world.instance[at]);
                else
                    assert_memory_equal(is.ray, was.ray, RAYS * sizeof *is.ray);
                fuzz_trial_free(&was);
                fuzz_trial_free(&is);
                fuzz_trial_free(&want);
            }
}

/* A transform whose inverse is beyond float32 takes no ray along. */
static void rays_stay_without_an_inverse(void **state)
{
    (void)state;
    const struct shrink_pass *pass = pass_of("places");
    struct fuzz_trial trial = trial_of_places();
    for (int k = 0; k < 3; k++)
        trial.world.instance[0].m[k][k] = 0x1p-140f;
    assert_false(pass->change(&trial, 0, 1, PLACES));
    fuzz_trial_free(&trial);
}

/* Thing 3 i + k of the pass over the world: instance i, axis k. Variants: the translation along the
 * axis goes, alone or with the rays; the diagonal's number there gets exponent 0. */
static void the_world_moves_as_a_whole(void **state)
{
    (void)state;
    const struct shrink_pass *pass = pass_of("world");
    assert_int_equal(pass->variants, 3);
    for (uint32_t thing = 0; thing < 3 * INSTANCES; thing++)
        for (uint32_t variant = 0; variant < 3; variant++) {
            struct fuzz_trial is = trial_of_places(), want = trial_of_places();
            const struct instance *one = &want.world.instance[thing / 3];
            uint32_t axis = thing % 3;
            const float by = one->m[axis][3], size = one->m[axis][axis];
            const float scale = size == 0 ? 1 : 1 / fabsf(below(size));
            assert_int_equal(pass->things(&is), 3 * INSTANCES);
            for (uint32_t i = 0; i < INSTANCES; i++)
                for (uint32_t k = 0; k < 12; k++) {
                    float *x = &want.world.instance[i].m[k / 4][k % 4];
                    *x = variant == 2 ? *x * scale : k == 4 * axis + 3 ? *x - by : *x;
                }
            for (uint32_t r = 0; r < RAYS; r++)
                for (uint32_t k = 0; k < 3; k++) {
                    if (variant == 2)
                        want.ray[r].dir[k] *= scale;
                    want.ray[r].org[k] = variant == 2                ? want.ray[r].org[k] * scale
                                         : variant == 1 && k == axis ? want.ray[r].org[k] - by
                                                                     : want.ray[r].org[k];
                }
            bool changes = variant == 2 ? scale != 1 : by != 0;
            assert_int_equal(pass->change(&is, thing, 1, variant), changes);
            if (changes) {
                same_trials(&is, &want, variant);
                for (uint32_t r = 0; r < RAYS; r++)
                    for (uint32_t k = 0; k < 3; k++)
                        assert_true(is.ray[r].org[k] == want.ray[r].org[k] &&
                                    is.ray[r].dir[k] == want.ray[r].dir[k]);
            }
            fuzz_trial_free(&is);
            fuzz_trial_free(&want);
        }
}

static enum status shows_flag(void *user, const struct fuzz_trial *candidate, size_t count,
                              size_t *first, struct reason *reason)
{
    (void)reason;
    for (*first = 0; *first < count; ++*first)
        for (uint32_t i = 0; i < candidate[*first].world.instance_count; i++)
            if (candidate[*first].world.instance[i].flags & *(const uint32_t *)user)
                return STATUS_OK;
    return STATUS_OK;
}

/* Of all flags beside it none is left, whichever is needed. */
static void a_flag_that_is_needed_stays_alone(void **state)
{
    (void)state;
    const uint32_t force[] = {ABI_INSTANCE_FORCE_OPAQUE, ABI_INSTANCE_FORCE_NO_OPAQUE};
    for (uint32_t needed = 1; needed < 16; needed *= 2)
        for (int which = 0; which < 2; which++) {
            const struct shrink_options options = {0};
            struct fuzz_trial trial = trial_of_places(), out;
            struct shrink_stats stats;
            struct reason reason = {""};
            for (uint32_t i = 0; i < INSTANCES; i++)
                trial.world.instance[i].flags = needed == force[!which] ? needed | 3u
                                                                        : 15u & ~force[!which];
            if (fuzz_shrink_trial(&trial, shows_flag, &needed, &options, &out, &stats, &reason))
                fail_msg("%s", reason.text);
            assert_int_equal(stats.end, SHRINK_FIXPOINT);
            assert_int_equal(out.world.instance_count, 1);
            assert_int_equal(out.world.instance[0].flags, needed);
            fuzz_trial_free(&out);
            fuzz_trial_free(&trial);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_change_of_a_place_is_what_its_name_tells),
        cmocka_unit_test(rays_stay_without_an_inverse),
        cmocka_unit_test(the_world_moves_as_a_whole),
        cmocka_unit_test(a_flag_that_is_needed_stays_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
