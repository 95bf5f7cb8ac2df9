/* Rays that are traced together (ref/fast/kernel/fast_packet.h) have the answers that each has
 * alone, whatever rays are beside them. */
#include "tests/fast/fast_fixture.h"

#define GROUP  16u
#define GROUPS 132u
#define ALL    (GROUP * GROUPS + 7u) /* the last ones fill no group */

enum company {
    PINHOLE,    /* one origin */
    PARALLEL,   /* one direction */
    WIDE,       /* any directions of one octant and main axis */
    OTHER_SIGN, /* one ray of another octant */
    NO_RAY,     /* one out of contract */
    RANGES,     /* ranges that begin and end anywhere */
    ZEROS,      /* directions in a plane, with zeros of both signs */
    AWAY,       /* all miss */
    DIAGONAL,   /* two axes are the main one */
    MIXED,      /* four of them are any rays */
    VERTICES,   /* from one place to vertices, where boxes end */
    COMPANIES
};

static float spread_of_group(enum company company)
{
    return company == PARALLEL ? 0.0f : company == WIDE ? 0.9f : 0.05f;
}

static struct ray any_ray(struct rng *rng)
{
    struct ray ray = {.tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        ray.org[k] = rng_range(rng, -2, 2);
        ray.dir[k] = rng_range(rng, -1, 1);
    }
    return ray;
}

/* The rays of a group go from outside of the scene, which is around 0, to it. */
static void make_group(struct rng *rng, enum company company, struct ray ray[GROUP])
{
    const int main = (int)rng_below(rng, 3), other = (main + 1) % 3;
    const float spread = spread_of_group(company), side = rng_below(rng, 2) ? 1.0f : -1.0f;
    const struct ray first = any_ray(rng);
    const uint32_t odd = rng_below(rng, GROUP);
    for (uint32_t i = 0; i < GROUP; i++) {
        ray[i] = first;
        for (int k = 0; k < 3; k++) { /* towards a point of the scene */
            ray[i].org[k] = 0.3f * first.org[k] - first.dir[k];
            if (company == PARALLEL)
                ray[i].org[k] += rng_range(rng, -0.2f, 0.2f);
            ray[i].dir[k] = copysignf(0.05f + fabsf(first.dir[k]) / 2, first.dir[k]) +
                            copysignf(rng_range(rng, 0, spread), first.dir[k]);
        }
        ray[i].dir[main] = side * 2;
        ray[i].org[main] = -side * (company == AWAY ? -8.0f : 4.0f);
        if (company == RANGES) {
            ray[i].tmin = rng_range(rng, 0, 3);
            ray[i].tmax = ray[i].tmin + rng_range(rng, 0, 1);
        }
        if (company == ZEROS)
            ray[i].dir[other] = rng_below(rng, 2) ? 0.0f : -0.0f;
        if (company == DIAGONAL)
            ray[i].dir[other] = rng_below(rng, 4) ? 2.0f : nextafterf(2, 3);
        if (company == MIXED && i % 4 == odd % 4)
            ray[i] = any_ray(rng);
    }
    if (company == OTHER_SIGN)
        ray[odd].dir[other] *= -1;
    if (company == NO_RAY)
        ray[odd].dir[other] = rng_below(rng, 2) ? NAN : INFINITY;
}

/* From a corner, so that all go the same way; one in two along an axis to a vertex. */
static void aim_at_vertices(struct rng *rng, const struct scene *scene, struct ray ray[GROUP])
{
    const bool parallel = rng_below(rng, 2);
    const float from[3] = {-3, -4, 7};
    for (uint32_t i = 0; i < GROUP; i++) {
        const float *vertex = scene->vertex + 3 * (size_t)rng_below(rng, scene->vertex_count);
        ray[i] = (struct ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            ray[i].org[k] = parallel ? vertex[k] + (k == 2 ? from[k] : 0.0f) : from[k];
            ray[i].dir[k] = vertex[k] - ray[i].org[k];
        }
    }
}

static void make_groups(uint64_t seed, const struct scene *scene, struct ray ray[ALL])
{
    struct rng rng = rng_make(seed, 1);
    struct ray last[GROUP];
    for (uint32_t g = 0; g < GROUPS; g++)
        if (g % COMPANIES == VERTICES)
            aim_at_vertices(&rng, scene, &ray[g * GROUP]);
        else
            make_group(&rng, (enum company)(g % COMPANIES), &ray[g * GROUP]);
    make_group(&rng, PINHOLE, last);
    memcpy(&ray[GROUPS * GROUP], last, (ALL - GROUPS * GROUP) * sizeof *ray);
}

static struct scene open_scene(const char *spec)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, 1, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

/* Ranges that begin or end at a hit exactly. */
static void end_at_hits(const struct scene *scene, struct ray ray[ALL])
{
    struct hit hit;
    for (size_t i = 0; i < ALL; i++) {
        if (!isfinite(ray[i].dir[0] + ray[i].dir[1] + ray[i].dir[2]))
            continue;
        trace_brute(scene, woop(), QUERY_CLOSEST, &ray[i], &hit);
        if (hit.prim != ABI_NO_PRIM)
            *(i % 3 ? &ray[i].tmin : &ray[i].tmax) = hit.t;
    }
}

/* Also beside a ray that no kernel traces, which has the careful way's answer. */
static void rays_together_answer_as_alone(void **state)
{
    (void)state;
    static const char *const scenes[] = {"soup:n=400",  "sphere:n=9", "needles:n=200", "soup:n=1",
                                         "terrain:k=4", "grid:n=12",  "platonic"};
    static struct ray ray[ALL];
    static struct hit truth[ALL];
    size_t hits = 0, misses = 0;
    for (size_t s = 0; s < ARRAY_COUNT(scenes); s++) {
        struct scene scene = open_scene(scenes[s]);
        struct fast_tree tree = make_tree(&scene, 1);
        make_groups(s, &scene, ray);
        if (s % 2)
            end_at_hits(&scene, ray);
        for (size_t i = 0; i < ALL; i++) {
            if (isfinite(ray[i].dir[0] + ray[i].dir[1] + ray[i].dir[2]))
                trace_brute(&scene, woop(), QUERY_CLOSEST, &ray[i], &truth[i]);
            else
                fast_careful(&tree, &ray[i], false, &truth[i]);
            *(truth[i].prim == ABI_NO_PRIM ? &misses : &hits) += 1;
        }
        for (size_t k = 0; kernels()[k]; k++)
            for (int way = 2; way < TREE_WAYS && kernels()[k]->runs(); way++) {
                set_way(&tree, way);
                check_kernel(kernels()[k], &tree, &scene, ray, ALL, truth);
            }
        fast_free(&tree);
        scene_free(&scene);
    }
    assert_true(hits > ALL / 2 && misses > ALL / 2);
}

/* The same rays in any order, and one by one, have the same answers. */
static void the_order_of_rays_changes_nothing(void **state)
{
    (void)state;
    static struct ray ray[ALL], other[ALL];
    static struct hit hit[ALL], again[ALL];
    static size_t place[ALL];
    struct scene scene = open_scene("sphere:n=12");
    struct fast_tree tree = make_tree(&scene, 1);
    struct rng rng = rng_make(9, 1);
    make_groups(7, &scene, ray);
    for (size_t i = 0; i < ALL; i++)
        place[i] = i;
    for (size_t i = ALL - 1; i > 0; i--) {
        const size_t k = rng_below(&rng, (uint32_t)i + 1), kept = place[i];
        place[i] = place[k];
        place[k] = kept;
    }
    for (size_t i = 0; i < ALL; i++)
        other[i] = ray[place[i]];
    for (size_t k = 0; kernels()[k]; k++) {
        if (!kernels()[k]->runs())
            continue;
        kernels()[k]->closest(&tree, ray, ALL, hit);
        kernels()[k]->closest(&tree, other, ALL, again);
        for (size_t i = 0; i < ALL; i++)
            assert_true(same(&hit[place[i]], &again[i]));
        for (size_t i = 0; i < ALL; i++)
            kernels()[k]->closest(&tree, &ray[i], 1, &again[i]);
        for (size_t i = 0; i < ALL; i++)
            assert_true(same(&hit[i], &again[i]));
    }
    fast_free(&tree);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_together_answer_as_alone),
        cmocka_unit_test(the_order_of_rays_changes_nothing),
    };
    int failed = 0;
    for (size_t i = 0; i < ARRAY_COUNT(fast_forms); i++) {
        tested = &fast_forms[i];
        failed += cmocka_run_group_tests_name(tested->name, tests, NULL, NULL);
    }
    return failed;
}
