/* Law of every storage of triangles: what is put into a leaf is read from it to the bit, in every
 * slot of leaves of 1 to 8, at every corner and axis: both zeros, subnormals, the ends of the
 * floats, and triangles' numbers and grids at the ends of the bits that they have. What holds no
 * vertices answers as the vertices do. */
#include "ref/base/rng.h"
#include "ref/primitives/primitives.h"
#include "ref/primitives/test_run.h"
#include "ref/scene/quantise.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SLOTS    8u
#define VERTICES 16u /* the most that a leaf shares */
#define RAYS     12u
#define ROW      10u         /* words of a storage of rows */
#define ROW_PRIM 0x3FFFFFFFu /* largest number that one has room for */

static const float ends[] = {0.0f,     -0.0f,    0x1p-149f, -0x1p-149f, 0x1.fffffcp-127f, FLT_MIN,
                             -FLT_MIN, 65504.0f, 1e30f,     -1e30f,     FLT_MAX,          -FLT_MAX};

/* `total` triangles; of those from `first` on 8 are a strip over 16 vertices, each with three of
 * its own numbers. */
static struct scene strip(uint32_t total, uint32_t first)
{
    struct scene scene;
    assert_int_equal(scene_make(VERTICES, total, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * VERTICES; i++)
        scene.vertex[i] = (float)(i * i % 37) - 11.25f;
    for (uint32_t i = 0; i < SLOTS && first + i < total; i++) {
        uint32_t *index = scene.index + 3 * (size_t)(first + i);
        index[0] = i;
        index[1] = i + 1;
        index[2] = i + 8;
    }
    return scene;
}

/* A leaf of `count` triangles from `first` on, the last first, behind another leaf and before a
 * third. */
static struct packed leaf_of(const struct tri_store *store, const struct scene *scene,
                             uint32_t first, uint32_t count, uint32_t *at)
{
    struct packed packed = {.layout = layouts[0], .store = store, .tri_count = scene->tri_count};
    struct reason reason = {""};
    uint32_t prim[SLOTS], other[1] = {0}, ignored;
    for (uint32_t i = 0; i < count; i++)
        prim[i] = first + count - 1 - i;
    if (store_put(scene, other, 1, &packed, &ignored, &reason) ||
        store_put(scene, prim, count, &packed, at, &reason) ||
        store_put(scene, other, 1, &packed, &ignored, &reason))
        fail_msg("%s: %s", store->name, reason.text);
    assert_in_range(*at, 1, ignored - 1);
    return packed;
}

static void expect_answers(const struct packed *packed, uint32_t at, uint32_t slot, float v[3][3])
{
    struct rng rng = rng_make(3, slot);
    for (uint32_t i = 0; i < RAYS; i++) {
        struct ray ray = {.org = {0, 0, 0}, .tmax = FLT_MAX};
        for (int k = 0; k < 3; k++) {
            ray.org[k] = rng_range(&rng, -20, 20);
            float to = 0.4f * v[0][k] + 0.3f * v[1][k] + 0.3f * v[2][k];
            ray.dir[k] = i % 3 == 2 ? (i / 3 % 3 == (uint32_t)k ? -1.0f : -0.0f) : to - ray.org[k];
        }
        const struct tri_ray r = tri_ray_make(&ray);
        for (size_t t = 0; tri_tests[t]; t++) {
            struct hit got = {.prim = 7}, want = {.prim = 7};
            uint32_t id = tri_tests[t]->id;
            if (!tri_store_answers(packed->store, id))
                continue;
            bool hits = packed->store->test(packed, at, slot, id, &r, &got);
            if (hits != tri_test_run(id, &r, v, &want) ||
                (hits && memcmp(&got, &want, sizeof got) != 0))
                fail_msg("%s: slot %u is answered otherwise by %s", packed->store->name, slot,
                         tri_tests[t]->name);
        }
    }
}

static void expect_leaf(const struct tri_store *store, const struct scene *scene, uint32_t first,
                        uint32_t count)
{
    uint32_t at;
    struct packed packed = leaf_of(store, scene, first, count, &at);
    for (uint32_t slot = 0; slot < count; slot++) {
        float own[3][3], stored[3][3];
        uint32_t prim = store->item(&packed, at, slot);
        if (prim != first + count - 1 - slot)
            fail_msg("%s: slot %u of %u is triangle %u of %u, not %u", store->name, slot, count,
                     prim, scene->tri_count, first + count - 1 - slot);
        scene_tri(scene, prim, own);
        if (store->tri) {
            assert_true(store->tri(&packed, at, slot, stored));
            if (memcmp(stored, own, sizeof own) != 0)
                fail_msg("%s: slot %u of %u has other vertices", store->name, slot, count);
        }
        if (store->test)
            expect_answers(&packed, at, slot, own);
    }
    free(packed.item);
}

static void every_slot_has_the_bits_of_its_vertices(void **state)
{
    (void)state;
    for (size_t s = 0; tri_stores[s]; s++)
        for (uint32_t count = 1; count <= SLOTS && !tri_stores[s]->head; count++)
            for (size_t e = 0; e < ARRAY_COUNT(ends); e++)
                for (uint32_t vertex = 0; vertex < count + 8; vertex++)
                    for (uint32_t axis = 0; axis < 3; axis++) {
                        struct scene scene = strip(SLOTS, 0);
                        scene.vertex[3 * vertex + axis] = ends[e];
                        expect_leaf(tri_stores[s], &scene, 0, count);
                        scene_free(&scene);
                    }
}

/* Vertices that differ in the sign of a zero are two, in the sign of zeros of any axis. */
static void zeros_of_both_signs_stay_apart(void **state)
{
    (void)state;
    for (size_t s = 0; tri_stores[s]; s++)
        for (uint32_t twin = 1; twin < VERTICES && !tri_stores[s]->head; twin++)
            for (uint32_t axis = 0; axis < 3; axis++) {
                struct scene scene = strip(SLOTS, 0);
                for (uint32_t k = 0; k < 3; k++)
                    scene.vertex[k] = scene.vertex[3 * twin + k] = k == axis ? 0.0f : 2.5f;
                scene.vertex[3 * twin + axis] = -0.0f;
                expect_leaf(tri_stores[s], &scene, 0, SLOTS);
                scene_free(&scene);
            }
}

/* Numbers of triangles at the ends of all widths that they can have here. */
static void numbers_of_triangles_are_whole(void **state)
{
    (void)state;
    for (size_t s = 0; tri_stores[s]; s++)
        for (uint32_t bits = 3; bits <= 18; bits++)
            for (uint32_t beside = 0; beside < 3; beside++) {
                uint32_t total = (1u << bits) + beside - 1;
                if (total < SLOTS)
                    continue;
                struct scene scene = strip(total, total - SLOTS);
                expect_leaf(tri_stores[s], &scene, total - SLOTS, 1 + bits % SLOTS);
                expect_leaf(tri_stores[s], &scene, total - SLOTS, SLOTS);
                scene_free(&scene);
            }
}

/* As many as the bits of a row have room for; no scene is that large here. */
static void the_most_triangles_are_the_rows_bits(void **state)
{
    (void)state;
    static const char *const rows[] = {"gathered", "edges", "baldwin_webber"};
    for (size_t s = 0; s < ARRAY_COUNT(rows); s++) {
        const struct tri_store *store = tri_store_find(rows[s]);
        struct packed packed = {.layout = layouts[0], .store = store};
        struct scene scene = {.tri_count = ROW_PRIM};
        struct reason reason = {""};
        uint64_t words;
        uint32_t prim = 0;
        assert_int_equal(store->measure(&packed, &scene, &prim, 5, &words, &reason), STATUS_OK);
        assert_int_equal(words, 5 * ROW);
        scene.tri_count++;
        assert_int_equal(store->measure(&packed, &scene, &prim, 5, &words, &reason), STATUS_LIMIT);
        assert_non_null(
            strstr(reason.text, "at most 1073741823 triangles, the scene has 1073741824"));
    }
}

/* A strip whose codes on an axis end at `most`, each of its 16 vertices with another one. */
static struct scene on_grid(const int32_t lo[3], const uint32_t width[3], const float step[3])
{
    struct scene scene = strip(SLOTS, 0);
    for (uint32_t i = 0; i < VERTICES; i++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t most = (1u << width[k]) - 1;
            uint32_t code = i == 0 ? 0 : i == 1 ? most : i * 2654435761u & most;
            scene.vertex[3 * i + k] = (float)(lo[k] + (int32_t)code) * step[k];
        }
    return scene;
}

static void grids_are_held_to_their_ends(void **state)
{
    (void)state;
    static const float step[] = {FLT_MIN, 0x1p-60f, 0.125f, 0x1p60f, 0x1p103f};
    const struct tri_store *store = tri_store_find("quantised");
    size_t held = 0;
    for (uint32_t bits = 0; bits <= QUANTISE_BITS_MOST; bits++)
        for (uint32_t end = 0; end < 3; end++)
            for (uint32_t axis = 0; axis < 3; axis++) {
                uint32_t width[3] = {5, 1, 13};
                float steps[3];
                int32_t lo[3];
                struct grid grid;
                width[axis] = bits;
                for (uint32_t k = 0; k < 3; k++) {
                    int32_t most = (1 << width[k]) - 1;
                    steps[k] = step[(bits + k + end) % ARRAY_COUNT(step)];
                    lo[k] = end == 0 ? -GRID_MOST : end == 1 ? GRID_MOST - most : -(most / 2);
                }
                struct scene scene = on_grid(lo, width, steps);
                assert_int_equal(grid_of_scene(&scene, &grid, NULL), STATUS_OK);
                held += grid.bits >= bits && (bits < 2 || grid.step[axis] == steps[axis]);
                for (uint32_t count = 1; count <= SLOTS; count++)
                    expect_leaf(store, &scene, 0, count);
                scene_free(&scene);
            }
    assert_true(held > 3 * 3 * QUANTISE_BITS_MOST * 2 / 3);
}

static uint32_t bits_in(uint64_t x)
{
    uint32_t bits = 0;
    for (; x; x /= 2)
        bits++;
    return bits;
}

/* The bits that ref/store/store_quantised.c gives a leaf of triangles from `first` on: sizes,
 * least codes, then each triangle and each vertex that differs from those before. */
static uint32_t quantised_bits(const struct scene *scene, const struct grid *grid, uint32_t first,
                               uint32_t count)
{
    const size_t bytes = 3 * sizeof *scene->vertex;
    uint32_t vertices = 0, widths = 0;
    bool used[VERTICES] = {false};
    double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 3 * first; i < 3 * (first + count); i++)
        used[scene->index[i]] = true;
    for (uint32_t v = 0; v < VERTICES; v++) {
        bool again = false;
        for (uint32_t w = 0; w < v && used[v]; w++)
            again |= used[w] && memcmp(scene->vertex + 3 * (size_t)w, scene->vertex + 3 * (size_t)v,
                                       bytes) == 0;
        vertices += used[v] && !again;
        for (int k = 0; k < 3 && used[v]; k++) {
            double at = (double)scene->vertex[3 * v + (uint32_t)k] / (double)grid->step[k];
            least[k] = fmin(least[k], at);
            most[k] = fmax(most[k], at);
        }
    }
    for (int k = 0; k < 3; k++)
        widths += bits_in((uint64_t)(most[k] - least[k]));
    return 22 + 3 * grid->bits + count * (12 + bits_in(scene->tri_count)) + vertices * widths;
}

/* A leaf has as many words as its bits need, of every number of bits in the last of them. */
static void leaves_on_a_grid_take_the_words_of_their_bits(void **state)
{
    (void)state;
    const struct tri_store *store = tri_store_find("quantised");
    bool seen[32] = {false};
    for (uint32_t n = 0; n < 400; n++) {
        const uint32_t width[3] = {n % 7, n / 7 % 8, n % (QUANTISE_BITS_MOST + 1)};
        const float step[3] = {0.5f, 4, 0x1p-20f};
        const int32_t lo[3] = {-3, 5, -40};
        struct scene scene = on_grid(lo, width, step);
        struct grid grid;
        assert_int_equal(grid_of_scene(&scene, &grid, NULL), STATUS_OK);
        const uint32_t first = n % 4;
        for (uint32_t count = 1; first + count <= SLOTS; count++) {
            uint32_t at, prim[SLOTS], bits = quantised_bits(&scene, &grid, first, count);
            uint64_t words;
            struct packed packed = leaf_of(store, &scene, first, count, &at);
            for (uint32_t i = 0; i < count; i++)
                prim[i] = first + i;
            assert_int_equal(store->measure(&packed, &scene, prim, count, &words, NULL), STATUS_OK);
            if (words != (bits + 31) / 32)
                fail_msg("%u triangles, %u bits: %u words", count, bits, (unsigned)words);
            seen[bits % 32] = true;
            free(packed.item);
        }
        scene_free(&scene);
    }
    for (int b = 0; b < 32; b++)
        assert_true(seen[b]);
}

/* Numbers of triangles have 31 bits. Only its count is read of this scene. */
static void a_grid_has_numbers_of_31_bits(void **state)
{
    (void)state;
    const struct tri_store *store = tri_store_find("quantised");
    const struct scene scene = {.tri_count = 1u << 31};
    struct reason reason = {""};
    uint32_t word[8] = {0};
    assert_int_equal(store->head(store, &scene, word, &reason), STATUS_LIMIT);
    assert_string_equal(reason.text,
                        "storage quantised: 2147483648 triangles; 2147483647 are possible");
}

/* Vertices are read of exactly the slots that name a triangle: none behind the leaf, of a leaf that
 * is cut off, or behind the words. */
static void vertices_are_of_items_alone(void **state)
{
    (void)state;
    for (size_t s = 0; tri_stores[s]; s++) {
        const struct tri_store *store = tri_stores[s];
        for (uint32_t count = 1; store->tri && count <= SLOTS; count++) {
            struct scene scene = strip(SLOTS, 0);
            uint32_t at, named = 0, none = 0;
            struct packed packed = leaf_of(store, &scene, 0, count, &at);
            /* The leaf, one triangle on both sides, what stands before: no words are idle. */
            assert_in_range(packed.item_count, 1, 8 + 16 * (count + 2));
            for (uint32_t words = packed.item_count; words >= at; words--) {
                const uint32_t whole = packed.item_count;
                const uint32_t slots[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 15, 16, 1u << 20, UINT32_MAX};
                packed.item_count = words;
                for (size_t k = 0; k < ARRAY_COUNT(slots); k++) {
                    float v[3][3];
                    bool is = store->item(&packed, at, slots[k]) != ABI_NO_PRIM;
                    assert_int_equal(store->tri(&packed, at, slots[k], v), is);
                    assert_int_equal(store->item(&packed, words, slots[k]), ABI_NO_PRIM);
                    assert_false(store->tri(&packed, words, slots[k], v));
                    assert_false(store->tri(&packed, UINT32_MAX, slots[k], v));
                    named += is;
                    none += !is;
                }
                packed.item_count = whole;
            }
            assert_true(named >= count && none > count);
            packed_free(&packed);
            scene_free(&scene);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_slot_has_the_bits_of_its_vertices),
        cmocka_unit_test(zeros_of_both_signs_stay_apart),
        cmocka_unit_test(numbers_of_triangles_are_whole),
        cmocka_unit_test(the_most_triangles_are_the_rows_bits),
        cmocka_unit_test(grids_are_held_to_their_ends),
        cmocka_unit_test(leaves_on_a_grid_take_the_words_of_their_bits),
        cmocka_unit_test(a_grid_has_numbers_of_31_bits),
        cmocka_unit_test(vertices_are_of_items_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
