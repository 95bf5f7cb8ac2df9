/* Law of every engine's three queries, on rays whose hits are known by hand: the list of all hits
 * is the sorted list, with triangles that are there twice and at equal distances, more hits than
 * room, and more rays than a call takes; the closest hit is its first, any hit one of it, and the
 * closest hit behind the last one found the next, to the end. Layers of triangles at whole
 * distances, so that every operation is exact. */
#include "tests/support/all_hits_fixture.h"

#include <math.h>

#define LAYERS 12
#define RAYS   (ALL_HITS_RAYS + 3000u)
#define FEW    700u /* rays of what is slow */
#define MOST   64u  /* hits of a ray */

struct exact_stand {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct ray ray[RAYS];
    struct hit want[RAYS][MOST]; /* of each ray, sorted; u and v are not known */
    uint32_t count[RAYS];
};

static struct exact_stand stand;

/* Triangle `shape` of a layer: two that overlap. Each is there several times. */
static uint32_t copies_of(uint32_t layer, uint32_t shape)
{
    return 1 + layer % (3 - shape);
}

static bool is_inside(float x, float y, uint32_t shape)
{
    float from = shape ? 4 : 0;
    assert_true(x != from && y != from && x + y != 16 + 2 * from);
    return x > from && y > from && x + y < 16 + 2 * from;
}

static struct scene layers(void)
{
    struct scene scene;
    uint32_t total = 0, next = 0;
    for (uint32_t layer = 1; layer <= LAYERS; layer++)
        total += copies_of(layer, 0) + copies_of(layer, 1);
    assert_int_equal(scene_make(6 * LAYERS, total, &scene), STATUS_OK);
    assert_true(total % 17 != 0 && total <= MOST);
    for (uint32_t layer = 1; layer <= LAYERS; layer++)
        for (uint32_t shape = 0; shape < 2; shape++) {
            uint32_t vertex = 6 * (layer - 1) + 3 * shape;
            for (uint32_t c = 0; c < 3; c++) {
                float *p = scene.vertex + 3 * (size_t)(vertex + c), from = shape ? 4 : 0;
                p[0] = from + (c == 1 ? 16 : 0);
                p[1] = from + (c == 2 ? 16 : 0);
                p[2] = (float)layer;
            }
            for (uint32_t i = 0; i < copies_of(layer, shape); i++, next++)
                for (uint32_t c = 0; c < 3; c++) /* in an order that is not that of the layers */
                    scene.index[3 * (size_t)(next * 17 % total) + c] = vertex + c;
        }
    return scene;
}

/* Straight or slanted, from either side, of any length, some with a piece of the range alone. */
static struct ray ray_at(uint32_t i)
{
    float side = i % 2 ? -1 : 1, scale = i % 3 ? 1.0f : 0.5f;
    struct ray ray = {.org = {(float)(i / 2 % 23) - 1.71875f, (float)(i / 46 % 22) - 0.84375f, 0},
                      .dir = {0, 0, side * scale},
                      .tmax = INFINITY};
    ray.org[2] = side < 0 ? LAYERS + 1 : 0;
    if (i % 5 < 2) {
        ray.dir[0] = 0.25f * scale;
        ray.dir[1] = (i % 5 ? 0.125f : -0.25f) * scale;
    }
    if (i % 7 == 3) {
        ray.tmin = 2.25f / scale;
        ray.tmax = 8.5f / scale;
    }
    return ray;
}

static void find_hits(uint32_t i)
{
    const struct ray *ray = &stand.ray[i];
    for (uint32_t prim = 0; prim < stand.scene.tri_count; prim++) {
        uint32_t vertex = stand.scene.index[3 * (size_t)prim];
        float t = (stand.scene.vertex[3 * (size_t)vertex + 2] - ray->org[2]) / ray->dir[2];
        float x = ray->org[0] + t * ray->dir[0], y = ray->org[1] + t * ray->dir[1];
        if (is_inside(x, y, vertex % 6 / 3) && t >= ray->tmin && t <= ray->tmax)
            stand.want[i][stand.count[i]++] = (struct hit){.t = t, .prim = prim};
    }
    all_hits_sort(stand.want[i], stand.count[i]);
}

static int make_stand(void **state)
{
    (void)state;
    size_t hits = 0, beyond = 0;
    stand.scene = layers();
    for (uint32_t i = 0; i < RAYS; i++) {
        stand.ray[i] = ray_at(i);
        find_hits(i);
        hits += stand.count[i];
        beyond += stand.count[i] > 20;
    }
    return hits > 5 * RAYS && beyond > 1000 ? 0 : 1;
}

static int drop_stand(void **state)
{
    (void)state;
    scene_free(&stand.scene);
    return 0;
}

/* --- what an engine answers ------------------------------------------------------------------- */

/* Embree's own test rounds otherwise. */
static bool is_at(const struct engine *engine, float t, float want)
{
    return engine->library ? fabsf(t - want) <= 1e-4f * want : t == want;
}

static void expect_list(const struct engine *engine, uint32_t i, struct hit *hit, size_t count)
{
    for (size_t k = 0; k < count && engine->library; k++)
        hit[k].t = roundf(2 * hit[k].t) / 2; /* of equal ones the order is by triangle */
    all_hits_sort(hit, count);
    if (count != stand.count[i])
        fail_msg("%s: ray %u has %zu hits, not %u", engine->name, i, count, stand.count[i]);
    for (size_t k = 0; k < count; k++)
        if (hit[k].prim != stand.want[i][k].prim || !is_at(engine, hit[k].t, stand.want[i][k].t))
            fail_msg("%s: ray %u: hit %zu is triangle %u at %a, not %u at %a", engine->name, i, k,
                     hit[k].prim, (double)hit[k].t, stand.want[i][k].prim,
                     (double)stand.want[i][k].t);
}

static void expect_lists(const struct engine *engine, void *self, uint32_t rays, bool split)
{
    struct all_hits all = {.once = split};
    struct reason reason = {""};
    for (uint32_t at = 0; at < rays; at += (uint32_t)all.done) {
        stand_must(all_hits_next(engine, self, stand.ray + at, rays - at, &all, &reason), &reason);
        for (uint32_t i = 0; i < all.done; i++)
            expect_list(engine, at + i, all.hit + all.first[i], all.first[i + 1] - all.first[i]);
    }
    assert_true(all.again > rays / 10);
    all_hits_free(&all);
}

static const struct hit *one_of(const struct engine *engine, uint32_t i, const struct hit *hit)
{
    for (uint32_t k = 0; k < stand.count[i]; k++)
        if (stand.want[i][k].prim == hit->prim && is_at(engine, hit->t, stand.want[i][k].t))
            return &stand.want[i][k];
    return NULL;
}

/* Too little room for some, just enough, and too much: counts are whole, what is listed is hit,
 * each once. */
static void expect_rooms(const struct engine *engine, void *self)
{
    static const uint32_t rooms[] = {1, 2, 3, 7, 20, 33, MOST};
    static struct hit hit[FEW * MOST];
    static uint32_t count[FEW];
    struct reason reason = {""};
    for (size_t r = 0; r < ARRAY_COUNT(rooms); r++) {
        stand_must(engine->trace_all(self, stand.ray, FEW, rooms[r], hit, count, &reason), &reason);
        for (uint32_t i = 0; i < FEW; i++) {
            bool seen[MOST] = {false};
            if (count[i] != stand.count[i])
                fail_msg("%s: ray %u has %u hits in a room of %u, not %u", engine->name, i,
                         count[i], rooms[r], stand.count[i]);
            for (uint32_t k = 0; k < count[i] && k < rooms[r]; k++) {
                const struct hit *known = one_of(engine, i, &hit[(size_t)i * rooms[r] + k]);
                if (!known || seen[known - stand.want[i]])
                    fail_msg("%s: ray %u: hit %u in a room of %u is none, or twice", engine->name,
                             i, k, rooms[r]);
                seen[known - stand.want[i]] = true;
            }
        }
    }
}

/* The closest hit is the first of the list; with `any`, one of it, whichever. */
static void expect_singles(const struct engine *engine, void *self, uint32_t rays, bool any)
{
    static struct hit hit[RAYS];
    struct trace_report report;
    struct reason reason = {""};
    stand_must(engine->trace(self, stand.ray, rays, hit, &report, &reason), &reason);
    for (uint32_t i = 0; i < rays; i++) {
        bool hits = hit[i].prim != ABI_NO_PRIM;
        const struct hit *known =
            hits && !(any && engine->library) ? one_of(engine, i, &hit[i]) : stand.want[i];
        if (hits != (stand.count[i] > 0) || !known || (!any && known->t != stand.want[i][0].t))
            fail_msg("%s: ray %u of %u is answered by triangle %d at %a", engine->name, i, rays,
                     (int)hit[i].prim, (double)hit[i].t);
    }
}

/* Rays that begin behind the hit that they had: all distances of the list, one after the other. */
static void expect_next(const struct engine *engine, void *self)
{
    static struct ray ray[FEW];
    static struct hit hit[FEW];
    static uint32_t at[FEW];
    struct trace_report report;
    struct reason reason = {""};
    memcpy(ray, stand.ray, sizeof ray);
    memset(at, 0, sizeof at);
    for (int round = 0; round <= LAYERS; round++) {
        stand_must(engine->trace(self, ray, FEW, hit, &report, &reason), &reason);
        for (uint32_t i = 0; i < FEW; i++) {
            bool more = at[i] < stand.count[i];
            float t = more ? stand.want[i][at[i]].t : 0;
            if ((hit[i].prim != ABI_NO_PRIM) != more || (more && !is_at(engine, hit[i].t, t)))
                fail_msg("%s: ray %u, hit %d: triangle %d at %a, not at %a", engine->name, i, round,
                         (int)hit[i].prim, (double)hit[i].t, (double)t);
            ray[i].tmin = more ? t + 0.25f : ray[i].tmin;
            while (at[i] < stand.count[i] && stand.want[i][at[i]].t == t)
                at[i]++;
        }
    }
}

/* --- who answers ------------------------------------------------------------------------------ */

static bool play(const struct engine *engine, const char *box, uint32_t rays)
{
    struct engine_options options = {.threads = 2, .device = -1};
    struct reason reason = {""};
    void *self = NULL;
    enum status status = engine_open(engine, &options, &self, &reason);
    for (enum query query = 0; query < QUERY_COUNT && !status; query++) {
        struct job job = {.scene = &stand.scene,
                          .packed = &stand.packed,
                          .box = box_test_find(box),
                          .tri = tri_test_find("mt"),
                          .query = query};
        if (query == QUERY_ALL && !engine->trace_all)
            continue;
        status = engine->prepare(self, &job, &reason);
        if (status)
            break;
        if (query == QUERY_ALL) {
            expect_lists(engine, self, rays, engine->needs_packed && stand.packed.split);
            if (!engine->needs_packed || !stand.packed.split)
                expect_rooms(engine, self);
        } else {
            expect_singles(engine, self, rays, query == QUERY_ANY);
        }
        if (query == QUERY_CLOSEST)
            expect_next(engine, self);
    }
    engine->close(self);
    if (status == STATUS_UNSUPPORTED)
        print_message("not played: %s\n", reason.text);
    else
        stand_must(status, &reason);
    return !status;
}

/* Both halves of a tree twice, cut at x = 8, which all triangles lie across. */
static void split_tree(struct bvh *bvh)
{
    const uint32_t nodes = bvh->node_count, prims = bvh->prim_count;
    struct bvh whole = *bvh;
    bvh->node = calloc(2 * (size_t)nodes + 1, sizeof *bvh->node);
    bvh->prim = calloc(2 * (size_t)prims, sizeof *bvh->prim);
    assert_true(bvh->node && bvh->prim);
    bvh->node_count = 2 * nodes + 1;
    bvh->prim_count = 2 * prims;
    bvh->node[0] = (struct bvh_node){.bounds = whole.node[0].bounds, .fst = 1, .snd = 1 + nodes};
    for (uint32_t half = 0; half < 2; half++) {
        for (uint32_t i = 0; i < nodes; i++) {
            struct bvh_node *node = &bvh->node[1 + half * nodes + i];
            *node = whole.node[i];
            *(half ? &node->bounds.lo[0] : &node->bounds.hi[0]) = 8;
            node->item_first += half * prims;
            node->fst += node->item_count ? 0 : 1 + half * nodes;
            node->snd += node->item_count ? 0 : 1 + half * nodes;
        }
        memcpy(bvh->prim + half * prims, whole.prim, prims * sizeof *whole.prim);
    }
    bvh_free(&whole);
}

static void make_tree(bool split, const char *layout, uint32_t leaf)
{
    struct reason reason = {""};
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    stand_must(builder_find("median")->build(&stand.scene, &options, &stand.bvh, &reason), &reason);
    if (split)
        split_tree(&stand.bvh);
    stand_must(bvh_check(&stand.bvh, &stand.scene, &reason), &reason);
    stand_must(packed_make(layout_find(layout), &stand.bvh, &stand.scene, &stand.packed, &reason),
               &reason);
    assert_int_equal(stand.packed.split, split);
}

static void drop_tree(void)
{
    packed_free(&stand.packed);
    bvh_free(&stand.bvh);
}

static void every_engine_lists_what_is_there(void **state)
{
    (void)state;
    size_t played = 0;
    make_tree(false, "f32", 4);
    for (size_t e = 0; engines[e]; e++)
        played += play(engines[e], "robust", RAYS);
    drop_tree();
    assert_true(played >= 4);
}

static void trees_of_all_kinds_list_what_is_there(void **state)
{
    (void)state;
    static const struct {
        const char *layout, *engine;
        bool split;
    } kinds[] = {
        {"rf16", "cpu", false},       {"cwbvh80", "cpu", false},    {"bvh8_u8_node", "cpu", false},
        {"tiny8_l14", "fast", false}, {"cwbvh80", "vulkan", false}, {"half4", "vulkan", false},
        {"f32", "cpu", true},         {"half4", "cpu", true},       {"f32", "cpu_stackless", true},
        {"f32", "fast", true},        {"f32", "vulkan", true},      {"f32", "fast_small", true}};
    for (size_t k = 0; k < ARRAY_COUNT(kinds); k++) {
        make_tree(kinds[k].split, kinds[k].layout, k % 2 ? 1 : 3);
        (void)play(engine_find(kinds[k].engine), k % 3 ? "robust" : "watertight", FEW);
        drop_tree();
    }
}

/* As many triangles between the first half of them and the second as make more than one dispatch,
 * which no ray comes near. */
static void push_apart(uint32_t by, uint32_t rays)
{
    struct scene *small = &stand.scene, large;
    uint32_t count = small->tri_count, half = count / 2;
    assert_int_equal(scene_make(small->vertex_count + 3, count + by, &large), STATUS_OK);
    memcpy(large.vertex, small->vertex, 12 * (size_t)small->vertex_count);
    for (uint32_t i = 0; i < 9; i++)
        large.vertex[3 * (size_t)small->vertex_count + i] = 1000 + (float)(i * i);
    for (uint32_t i = 0; i < 3 * (count + by); i++) {
        bool between = i >= 3 * half && i < 3 * (half + by);
        uint32_t own = i < 3 * half ? i : i - 3 * by;
        large.index[i] = between ? small->vertex_count + i % 3 : small->index[own];
    }
    for (uint32_t i = 0; i < rays; i++)
        for (uint32_t k = 0; k < stand.count[i]; k++)
            stand.want[i][k].prim += stand.want[i][k].prim >= half ? by : 0;
    scene_free(small);
    *small = large;
}

/* Parts of the triangles, and of the rays, too: 2^24 tests are a batch, 2^14 triangles a part. */
static void brute_force_in_parts_lists_what_is_there(void **state)
{
    (void)state;
    const struct engine *engine = engine_find("vulkan_brute");
    const uint32_t rays = 1040;
    struct reason reason = {""};
    void *self = stand_open(engine);
    push_apart(16400, rays);
    for (enum query query = 0; query < QUERY_COUNT; query++) {
        struct job job = {
            .scene = &stand.scene, .box = box_tests[0], .tri = tri_test_find("mt"), .query = query};
        stand_must(engine->prepare(self, &job, &reason), &reason);
        if (query == QUERY_ALL)
            expect_lists(engine, self, rays, false);
        else
            expect_singles(engine, self, rays, query == QUERY_ANY);
    }
    engine->close(self);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_engine_lists_what_is_there),
        cmocka_unit_test(trees_of_all_kinds_list_what_is_there),
        cmocka_unit_test(brute_force_in_parts_lists_what_is_there), /* last: another scene */
    };
    return cmocka_run_group_tests(tests, make_stand, drop_stand);
}
