/* Every shader that traces scenes has C's bits on the running driver, if that is IEEE: each module
 * has been compiled by itself, so what holds of one holds of no other. Rays of any bits take part:
 * what is out of contract shows how a comparison ends with NaN. Scales come by turns of layouts.
 * SHADER=trace_f32 plays one, SHADER=all plays all, with three times as many mixes, every scale,
 * and all storages. */
#include "ref/packed/packed_walk.h"
#include "ref/store.h"
#include "tests/gpu/vulkan_trace_fixture.h"

#include "ref/primitives/primitives.h"

#define KINDS   4
#define LIMITED 300

/* A soup times a scale, or on a lattice, where edges, planes and ends are met exactly. Of the
 * scales one makes halves subnormal, one is beyond them, and one makes determinants subnormal. */
static const struct {
    float scale;
    bool lattice;
} soups[] = {{1.0f, false}, {1.0f, true}, {0x1p-17f, false}, {0x1p36f, false}, {0x1p-74f, false}};

static float on_lattice(float value)
{
    return rintf(8.0f * value) * 0.125f;
}

/* The soup as it is and the lattice are for each layout; of the scales it has one. */
static bool has_its_turn(size_t l, size_t k)
{
    return k < 2 || k == 2 + l % (ARRAY_COUNT(soups) - 2) || getenv("SHADER");
}

/* Returns false if the layout cannot hold it. */
static bool soup_case(const struct layout *layout, size_t k, struct gpu_case *out)
{
    const struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    struct scene scene = soup(300);
    struct bvh bvh;
    struct packed packed;
    struct reason reason;
    for (uint32_t i = 0; i < 3 * scene.vertex_count; i++)
        scene.vertex[i] =
            soups[k].lattice ? on_lattice(scene.vertex[i]) : soups[k].scale * scene.vertex[i];
    gpu_must(builder_find("median")->build(&scene, &options, &bvh, &reason), &reason);
    const bool holds = packed_make(layout, &bvh, &scene, &packed, &reason) == STATUS_OK;
    if (holds) {
        packed_free(&packed);
        *out = pack(scene, bvh, layout->name, 1000);
    } else {
        bvh_free(&bvh);
        scene_free(&scene);
    }
    return holds;
}

/* Rays of a set, rays some of whose words are any bits, and rays from planes of boxes: along axes,
 * and so short that a quotient by their direction may be infinite. */
static void mix_rays(struct gpu_case *f, bool lattice)
{
    static const float component[] = {0.0f, -0.0f, 1.0f, -1.0f, 0x1p-61f, 0x1p-59f, -0x1p-60f};
    uint32_t word = 1;
    for (size_t i = 0; i < f->ray_count; i++)
        for (uint32_t k = 0; k < 8; k++) {
            float *value = (float *)&f->ray[i] + k;
            const struct box *bounds = &f->bvh.node[i % f->bvh.node_count].bounds;
            word = word * 1664525u + 1013904223u;
            if (lattice && i % KINDS == 0 && k != 7)
                *value = on_lattice(*value);
            if (i % KINDS == 1 && (word >> 8) % 3 == 0)
                *value = float_from_bits(word ^ word >> 15);
            if (i % KINDS >= 2 && k < 3)
                *value = i & 4 ? bounds->lo[k] : bounds->hi[(k + i) % 3];
            if (i % KINDS == 2 && k < 3 && i & 8) /* the planes of RTRS's box test */
                *value += i & 4 ? -0.000002f : 0.000002f;
            if (i % KINDS == 2 && k >= 4 && k < 7)
                *value = component[(word >> 16) % ARRAY_COUNT(component)];
            if (i % KINDS == 3 && k >= 4 && k < 7)
                *value *= 0x1p-130f;
            if (i % KINDS == 3 && k == 7)
                *value = HUGE_VALF;
        }
}

static bool wanted(const char *prefix, const char *name)
{
    const char *only = getenv("SHADER");
    char text[64];
    snprintf(text, sizeof text, "%s_%.40s", prefix, name);
    return shader_find(text) && (!only || strcmp(only, "all") == 0 || strcmp(only, text) == 0);
}

/* Whether no layout before this one has its shader. */
static bool first_of_shader(size_t l)
{
    for (size_t k = 0; k < l; k++)
        if (strcmp(layout_shader(layouts_all[k]), layout_shader(layouts_all[l])) == 0)
            return false;
    return !layouts_all[l]->outside;
}

/* Whether C and the shader take a reference beyond the nodes for the same nothing: of layouts that
 * have a record for each node, and no word of it that means something else there. What is beyond is
 * read, though it is not used: not where each access is watched. */
static bool may_be_limited(const struct layout *layout)
{
    if (gpu_options().watch)
        return false;
    static const char *const alike[] = {"f32", "rf16", "rtrs_direct"};
    for (size_t i = 0; i < ARRAY_COUNT(alike); i++)
        if (strcmp(layout->name, alike[i]) == 0)
            return true;
    return false;
}

/* A ray may visit as many nodes as there are: with fewer it is finished if C's is, and only then,
 * so that both enter the same boxes. */
static void limited_alike(struct tracer *tracer, struct gpu_case *f, const struct job *job)
{
    static const uint32_t limits[] = {10, 40};
    const uint32_t exhausted = ABI_FLAG_DONE | ABI_FLAG_EXHAUSTED | ABI_FLAG_VISITS;
    const uint32_t all = f->packed.ref_count;
    const size_t count = f->ray_count < LIMITED ? f->ray_count : LIMITED;
    uint32_t want[LIMITED], flag[LIMITED];
    struct hit hit[LIMITED];
    for (size_t k = 0; k < ARRAY_COUNT(limits); k++) {
        struct reason reason = {""};
        struct engine_task task = {
            .job = *job, .ray = f->ray, .ray_count = count, .hit = f->got, .flag = flag};
        f->packed.ref_count = limits[k] < all ? limits[k] : all;
        const enum status ended = trace_rays(job, f->ray, count, hit, want, NULL);
        assert_true(ended == STATUS_OK || ended == STATUS_LIMIT);
        gpu_must(tracer_trace_tasks(tracer, &task, 1, &reason), &reason);
        f->packed.ref_count = all;
        for (size_t i = 0; i < count; i++)
            if (flag[i] != (want[i] == ABI_FLAG_DONE ? ABI_FLAG_DONE : exhausted) ||
                (want[i] == ABI_FLAG_DONE && memcmp(&hit[i], &f->got[i], sizeof *hit) != 0))
                fail_msg("%s %s %s, ray %zu, at most %u nodes: flags %u, C has %u",
                         job->packed->layout->name, job->box->name, job->tri->name, i, limits[k],
                         flag[i], want[i]);
    }
}

/* Ranges that begin or end exactly at the hit. */
static void ends_alike(struct tracer *tracer, struct gpu_case *f, const struct job *job)
{
    struct ray *rays = calloc(f->ray_count, sizeof *rays);
    assert_non_null(rays);
    memcpy(rays, f->ray, f->ray_count * sizeof *rays);
    for (size_t i = 0; i < f->ray_count; i++)
        if (f->expected[i].prim != ABI_NO_PRIM)
            *(i % 2 ? &f->ray[i].tmin : &f->ray[i].tmax) = f->expected[i].t;
    (void)must_agree(tracer, f, job);
    memcpy(f->ray, rays, f->ray_count * sizeof *rays);
    free(rays);
}

/* Lists of all hits, of which there is room for two. */
static void lists_alike(struct tracer *tracer, struct gpu_case *f, const uint32_t *parent, size_t t)
{
    enum { ROOM = 2 };
    struct job job = job_of(f, "robust", tri_tests[t]->name, QUERY_ALL);
    struct hit *hit = calloc(ROOM * f->ray_count, sizeof *hit);
    uint32_t *count = calloc(f->ray_count, sizeof *count);
    struct reason reason = {""};
    assert_true(hit && count);
    job.parent = parent;
    gpu_must(tracer_prepare(tracer, &job, &reason), &reason);
    gpu_must(tracer_trace_all(tracer, f->ray, f->ray_count, ROOM, hit, count, &reason), &reason);
    job.parent = NULL;
    for (size_t i = 0; i < f->ray_count; i++) {
        struct hit want[ROOM];
        uint32_t found;
        assert_int_equal(trace_ray_all(&job, &f->ray[i], ROOM, want, &found, NULL), STATUS_OK);
        const size_t written = found < ROOM ? found : ROOM;
        if (count[i] != found || memcmp(hit + ROOM * i, want, written * sizeof *want) != 0)
            fail_msg("%s, list of ray %zu: %u hits, C has %u", job.packed->layout->name, i,
                     count[i], found);
    }
    free(hit);
    free(count);
}

/* Each triangle test with a box test, which come by turns, or with all three. */
static void all_mixes(struct tracer *tracer, struct gpu_case *f, const uint32_t *parent, size_t l)
{
    static const char *const box[] = {"watertight", "robust", "rtrs"};
    const size_t rounds = getenv("SHADER") ? 3 : 1;
    lists_alike(tracer, f, parent, l % 2);
    for (size_t t = 0; tri_tests[t]; t++)
        for (size_t round = 0; round < rounds; round++) {
            struct job job = job_of(f, box[(l + t + round) % 3], tri_tests[t]->name,
                                    (l + t / 3 + round) % 2 ? QUERY_ANY : QUERY_CLOSEST);
            job.parent = parent;
            (void)must_agree(tracer, f, &job);
            ends_alike(tracer, f, &job);
            if (!parent && may_be_limited(f->packed.layout))
                limited_alike(tracer, f, &job);
        }
}

/* A tree of 50 levels: each has a plate behind or before that of the one above. Rays begin in front
 * of any of them, on either side, and hit some of them. */
static struct gpu_case deep_case(const char *layout, enum trees_shape shape)
{
    enum { LEVELS = 50 };
    struct scene scene;
    struct reason reason = {""};
    gpu_must(scene_make(3 * LEVELS, LEVELS, &scene), &reason);
    for (uint32_t i = 0; i < 3 * LEVELS; i++) {
        const uint32_t corner = (i % 3 + i / 3 * 3 % 4) % 4; /* one of four is left out */
        const float v[3] = {corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f, (float)(i / 3)};
        memcpy(scene.vertex + 3 * i, v, sizeof v);
        scene.index[i] = i;
    }
    struct gpu_case f = pack(scene, trees_make(&scene, 1, shape), layout, 8 * LEVELS);
    for (uint32_t i = 0; i < f.ray_count; i++) {
        const float side = i & 4 ? 1.0f : -1.0f;
        f.ray[i] = (struct ray){
            {i & 1 ? 0.625f : -0.625f, i & 2 ? 0.75f : -0.75f, (float)(i / 8) - 0.5f * side},
            0,
            {0, 0, side},
            HUGE_VALF};
    }
    return f;
}

static void play_case(struct tracer *tracer, struct gpu_case *f, size_t l, bool trace,
                      bool stackless)
{
    uint32_t *parent;
    struct reason reason;
    if (trace)
        all_mixes(tracer, f, NULL, l);
    if (!stackless)
        return;
    gpu_must(packed_links(&f->packed, &parent, &reason), &reason);
    all_mixes(tracer, f, parent, l + 1);
    free(parent);
}

/* The triangles as each storage has them, if the layout leaves them to one. */
static void stored_alike(struct tracer *tracer, struct gpu_case *f, bool stackless)
{
    const struct packed indexed = f->packed;
    for (size_t k = 1; tri_stores[k]; k++) {
        struct reason reason;
        uint32_t *parent = NULL;
        if (packed_make_stored(indexed.layout, tri_stores[k], &f->bvh, &f->scene, &f->packed,
                               &reason) != STATUS_OK)
            continue;
        if (stackless)
            gpu_must(packed_links(&f->packed, &parent, &reason), &reason);
        for (size_t t = 0; tri_tests[t]; t++) {
            struct job job = job_of(f, "robust", tri_tests[t]->name, QUERY_CLOSEST);
            job.parent = parent;
            if (tri_store_answers(tri_stores[k], tri_tests[t]->id))
                (void)must_agree(tracer, f, &job);
        }
        free(parent);
        packed_free(&f->packed);
    }
    f->packed = indexed;
}

static void every_layouts_shaders_have_the_bits_of_c(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    const bool ieee = gpu_is_lavapipe(vk);
    gpu_close(vk);
    if (!ieee)
        skip();
    struct tracer *tracer = gpu_tracer(&options, 0);
    size_t turn = 0, had[ARRAY_COUNT(soups)] = {0};
    for (size_t l = 0; layouts_all[l]; l++) {
        const char *name = layout_shader(layouts_all[l]);
        const bool trace = wanted("trace", name), stackless = wanted("stackless", name);
        if (!first_of_shader(l) || !(trace || stackless))
            continue;
        for (size_t k = 0; k < ARRAY_COUNT(soups); k++) {
            struct gpu_case f;
            if (!has_its_turn(turn, k) || !soup_case(layouts_all[l], k, &f))
                continue;
            had[k]++;
            mix_rays(&f, soups[k].lattice);
            play_case(tracer, &f, l, trace, stackless);
            if (soups[k].lattice && getenv("SHADER") && trace)
                stored_alike(tracer, &f, false);
            if (soups[k].lattice && getenv("SHADER") && stackless)
                stored_alike(tracer, &f, true);
            release(&f);
        }
        turn++;
        if (layout_is_wide(layouts_all[l]))
            continue;
        for (int right = 0; right < 2; right++) {
            struct gpu_case deep =
                deep_case(layouts_all[l]->name, right ? TREES_RIGHT : TREES_LEFT);
            play_case(tracer, &deep, l, trace, stackless);
            release(&deep);
        }
    }
    gpu_close_tracer(tracer);
    for (size_t k = 0; k < ARRAY_COUNT(soups) && !getenv("SHADER"); k++)
        assert_true(had[k] >= (k < 2 ? turn : turn / 4)); /* some layouts cannot hold some */
}

static void trace_by(const char *engine, const struct gpu_case *f, const struct job *job,
                     struct hit *hit)
{
    const struct engine_options options = {.device = -1};
    struct reason reason = {""};
    struct trace_report report;
    void *self;
    gpu_must(engine_open(engine_find(engine), &options, &self, &reason), &reason);
    gpu_must(engine_find(engine)->prepare(self, job, &reason), &reason);
    gpu_must(engine_find(engine)->trace(self, f->ray, f->ray_count, hit, &report, &reason),
             &reason);
    engine_find(engine)->close(self);
}

static void brute_force_has_the_bits_of_c(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    const bool ieee = gpu_is_lavapipe(vk);
    gpu_close(vk);
    if (!ieee || !wanted("trace", "brute"))
        skip();
    for (size_t k = 0; k < ARRAY_COUNT(soups); k++) {
        struct gpu_case f;
        assert_true(soup_case(layouts[0], k, &f));
        mix_rays(&f, soups[k].lattice);
        for (size_t t = 0; tri_tests[t]; t++) {
            struct job job =
                job_of(&f, "robust", tri_tests[t]->name, t % 2 ? QUERY_ANY : QUERY_CLOSEST);
            trace_by("brute", &f, &job, f.expected);
            trace_by("vulkan_brute", &f, &job, f.got);
            for (size_t i = 0; i < f.ray_count; i++)
                if (memcmp(&f.got[i], &f.expected[i], sizeof f.got[i]) != 0)
                    fail_msg("%s, ray %zu: prim %u t %a, C has prim %u t %a", tri_tests[t]->name, i,
                             f.got[i].prim, (double)f.got[i].t, f.expected[i].prim,
                             (double)f.expected[i].t);
        }
        release(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layouts_shaders_have_the_bits_of_c),
        cmocka_unit_test(brute_force_has_the_bits_of_c),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
