/* Laws that hold for every ray set. */
#include "tests/support/ray_fixture.h"

#include <string.h>

static void table_starts_with_the_mix(void **state)
{
    (void)state;
    assert_string_equal(ray_sets[0]->name, "mixed");
    for (size_t i = 0; ray_sets[i]; i++) {
        assert_ptr_equal(ray_set_find(ray_sets[i]->name), ray_sets[i]);
        assert_true(strlen(ray_sets[i]->summary) > 10);
    }
    assert_null(ray_set_find("nosuch"));
}

/* Scenes at the borders of what scene_check lets through. */
static struct scene hard_scene(size_t which)
{
    static const float hard[][3] = {
        /* factor, of z, offset */
        {1, 1, 0},         {1e-44f, 1, 0},     {1e-38f, 1, 0}, {1e-20f, 1, 0}, {1e-3f, 1, 1e6f},
        {1e10f, 1, 0},     {1e13f, 1, 0},      {1e20f, 1, 0},  {3e38f, 1, 0},  {1, 1, 1e12f},
        {1e-3f, 1, 1e30f}, {1e6f, 1, -1e20f},  {0, 1, 0},      {0, 1, 5},      {1, 1e-25f, 0},
        {1, 1e-18f, 0},    {1e15f, 1e-25f, 0},
    };
    if (which == ARRAY_COUNT(hard))
        return make_scene("soup", 0);
    if (which > ARRAY_COUNT(hard))
        return (struct scene){.vertex_count = 0, .tri_count = 1}; /* the end */
    struct scene scene = make_scene("soup", 50);
    for (size_t k = 0; k < 3 * (size_t)scene.vertex_count; k++)
        scene.vertex[k] =
            scene.vertex[k] * hard[which][0] * (k % 3 == 2 ? hard[which][1] : 1) + hard[which][2];
    assert_int_equal(scene_check(&scene, NULL), STATUS_OK);
    return scene;
}

static void every_ray_keeps_the_contract(void **state)
{
    (void)state;
    static struct ray ray[COUNT];
    for (size_t which = 0;; which++) {
        struct scene scene = hard_scene(which);
        if (scene.tri_count > 0 && scene.vertex_count == 0)
            break;
        for (size_t s = 0; ray_sets[s]; s++) {
            struct reason reason = {""};
            enum status status = ray_set_make(ray_sets[s], &scene, 7, COUNT, ray, &reason);
            if (status) { /* only bounces may refuse, and only where nothing can be hit */
                assert_string_equal(ray_sets[s]->name, "bounce");
                assert_int_equal(status, STATUS_INPUT);
                assert_non_null(strstr(reason.text, "bounce"));
                continue;
            }
            for (size_t i = 0; i < COUNT; i++)
                if (!ray_in_contract(&ray[i]))
                    fail_msg("hard scene %zu, %s, ray %zu: o=(%a, %a, %a) d=(%a, %a, %a) t=%a..%a",
                             which, ray_sets[s]->name, i, (double)ray[i].org[0],
                             (double)ray[i].org[1], (double)ray[i].org[2], (double)ray[i].dir[0],
                             (double)ray[i].dir[1], (double)ray[i].dir[2], (double)ray[i].tmin,
                             (double)ray[i].tmax);
        }
        scene_free(&scene);
    }
}

static void every_set_works_on_every_scene(void **state)
{
    (void)state;
    static struct ray ray[COUNT];
    for (size_t g = 0; generators[g]; g++) {
        struct scene scene = default_scene(generators[g]->name);
        for (size_t s = 0; ray_sets[s]; s++) {
            bool cut = strcmp(ray_sets[s]->name, "ranges") == 0 || s == 0;
            make_rays(ray_sets[s]->name, &scene, 3, COUNT, ray);
            for (size_t i = 0; i < COUNT; i++) {
                assert_true(ray_in_contract(&ray[i]));
                assert_true(cut || (ray[i].tmin == 0 && ray[i].tmax == RAY_TMAX));
            }
        }
        scene_free(&scene);
    }
}

static void any_count_is_fine_and_writes_no_more(void **state)
{
    (void)state;
    struct scene scene = default_scene("grid");
    static const size_t counts[] = {0, 1, 2, 7, 8, 9, 63, 100};
    for (size_t s = 0; ray_sets[s]; s++)
        for (size_t c = 0; c < ARRAY_COUNT(counts); c++) {
            struct ray ray[101], clean[2];
            memset(ray, 0xAB, sizeof ray);
            memset(clean, 0xAB, sizeof clean);
            make_rays(ray_sets[s]->name, &scene, 3, counts[c], ray);
            assert_memory_equal(&ray[counts[c]], clean, sizeof *ray);
            assert_true(counts[c] == 0 || memcmp(&ray[counts[c] - 1], clean, sizeof *ray) != 0);
        }
    scene_free(&scene);
}

static void the_seed_decides(void **state)
{
    (void)state;
    struct scene scene = default_scene("terrain");
    static struct ray a[COUNT], again[COUNT], b[COUNT];
    for (size_t s = 0; ray_sets[s]; s++) {
        make_rays(ray_sets[s]->name, &scene, 11, COUNT, a);
        make_rays(ray_sets[s]->name, &scene, 11, COUNT, again);
        make_rays(ray_sets[s]->name, &scene, 12, COUNT, b);
        assert_memory_equal(a, again, sizeof a);
        size_t same = 0, limit = 0;
        if (strcmp(ray_sets[s]->name, "primary") == 0)
            limit = COUNT;
        else if (s == 0)
            limit = COUNT / 8;
        else if (strcmp(ray_sets[s]->name, "axis") == 0)
            limit = COUNT / 20; /* few choices: some rays are born twice */
        for (size_t i = 0; i < COUNT; i++)
            same += memcmp(&a[i], &b[i], sizeof *a) == 0;
        if (same > limit)
            fail_msg("%s: %zu rays are the same for both seeds", ray_sets[s]->name, same);
    }
    scene_free(&scene);
}

/* The plain generator gives seed + 1 the numbers of seed, one place later. */
static void neighbouring_seeds_share_no_numbers(void **state)
{
    (void)state;
    struct scene empty = make_scene("soup", 0); /* a cube: no axis has a scale of its own */
    static struct ray a[COUNT], b[COUNT];
    size_t shared = 0;
    make_rays("random", &empty, 11, COUNT, a);
    make_rays("random", &empty, 12, COUNT, b);
    for (size_t i = 0; i < COUNT; i++)
        shared += a[i].org[1] == b[i].org[0];
    assert_true(shared < 3);
    scene_free(&empty);
}

static void the_mix_takes_sets_by_turns(void **state)
{
    (void)state;
    struct scene scene = default_scene("sphere");
    static struct ray mixed[COUNT], part[COUNT];
    size_t sets = 0;
    while (ray_sets[sets + 1])
        sets++;
    const size_t count = 1003; /* not a multiple of the sets */
    make_rays("mixed", &scene, 5, count, mixed);
    for (size_t s = 0; s < sets; s++) {
        size_t part_count = count / sets + (s < count % sets);
        make_rays(ray_sets[s + 1]->name, &scene, 5, part_count, part);
        for (size_t i = 0; i < part_count; i++)
            assert_memory_equal(&mixed[i * sets + s], &part[i], sizeof *part);
    }
    scene_free(&scene);
}

static void rays_have_the_same_bytes_everywhere(void **state)
{
    (void)state;
    /* FNV-1a of 1200 rays of seed 1. Bounces depend on which of two tied triangles a tree finds. */
    static const struct {
        const char *name;
        uint64_t hash;
    } golden[] = {
        {"primary", 0x67B544A574BC643Bu},  {"random", 0x93048B2CB56E6EA4u},
        {"vertices", 0xB502B8EE04AECE18u}, {"edges", 0x05C74CA6CFD78913u},
        {"corners", 0x16804551B683010Au},  {"axis", 0x47E97B63C24C2E76u},
        {"ranges", 0x4D6C8DBCFB12AE92u},
    };
    static struct ray ray[COUNT];
    struct scene scene = default_scene("terrain");
    bool same = true;
    for (size_t s = 0; s < ARRAY_COUNT(golden); s++) {
        uint64_t hash = 0xCBF29CE484222325u;
        make_rays(golden[s].name, &scene, 1, COUNT, ray);
        for (size_t i = 0; i < sizeof ray; i++)
            hash = (hash ^ ((const unsigned char *)ray)[i]) * 0x100000001B3u;
        if (hash != golden[s].hash)
            print_error("%s: 0x%016llXu\n", golden[s].name, (unsigned long long)hash);
        same = same && hash == golden[s].hash;
    }
    assert_true(same);
    scene_free(&scene);
}

/* No set may be vacuous: percent of rays that hit at least. */
static void every_set_hits(void **state)
{
    (void)state;
    static const char *const scenes[] = {"sphere", "flake", "grid", "soup", "cornell"};
    static const struct {
        const char *set;
        size_t floor[5];
    } expect[] = {
        {"mixed", {55, 70, 60, 38, 80}},  {"primary", {28, 60, 25, 18, 95}},
        {"random", {22, 42, 15, 11, 38}}, {"vertices", {90, 98, 93, 60, 90}},
        {"edges", {95, 97, 95, 70, 95}},  {"corners", {80, 95, 88, 45, 90}},
        {"axis", {40, 95, 85, 30, 90}},   {"bounce", {20, 22, 55, 38, 75}},
        {"ranges", {60, 75, 75, 48, 75}},
    };
    enum { RAYS = 600 };
    static struct ray ray[RAYS];
    for (size_t c = 0; c < ARRAY_COUNT(scenes); c++) {
        struct scene scene = default_scene(scenes[c]);
        for (size_t s = 0; ray_sets[s]; s++) {
            size_t hits = 0;
            assert_string_equal(expect[s].set, ray_sets[s]->name);
            make_rays(expect[s].set, &scene, 1, RAYS, ray);
            for (size_t i = 0; i < RAYS; i++)
                hits += brute(&scene, &ray[i]).prim != ABI_NO_PRIM;
            if (100 * hits < expect[s].floor[c] * RAYS)
                fail_msg("%s %s: only %zu of %d rays hit", scenes[c], expect[s].set, hits, RAYS);
        }
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_starts_with_the_mix),
        cmocka_unit_test(every_ray_keeps_the_contract),
        cmocka_unit_test(every_set_works_on_every_scene),
        cmocka_unit_test(any_count_is_fine_and_writes_no_more),
        cmocka_unit_test(the_seed_decides),
        cmocka_unit_test(neighbouring_seeds_share_no_numbers),
        cmocka_unit_test(the_mix_takes_sets_by_turns),
        cmocka_unit_test(rays_have_the_same_bytes_everywhere),
        cmocka_unit_test(every_set_hits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
