/* Laws of the node formats that ship elsewhere: their words, and that no box of theirs is too small
 * whatever the scene. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "ref/packed/packed_file.h"
#include "ref/base/rng.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/layouts/any_words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* `largest`: bounds up to it are taken, twice that is refused; 0: all that are finite. */
static const struct shipped {
    const char *name;
    float largest;
} shipped[] = {
    {"cwbvh80", 0x1p100f},   {"half4", 65504},    {"tiny8", 0x1p100f}, {"tiny8_l8", 0x1p100f},
    {"tiny8_l14", 0x1p100f}, {"amd64", 0},        {"amd64_f32", 0},    {"amd64_f16", 65504},
    {"amd64_g1", 65504},     {"gfx12", 0x1p100f}, {"hpb64", 0x1p126f}, {"obb8", 0x1p96f},
};

static struct packed pack(const char *layout, const struct bvh *bvh, const struct scene *scene)
{
    struct packed packed;
    struct reason reason = {""};
    if (packed_make(layout_find(layout), bvh, scene, &packed, &reason))
        fail_msg("%s", reason.text);
    return packed;
}

static void check(const struct packed *packed, const struct scene *scene, const char *what)
{
    struct reason reason = {""};
    if (packed_check(packed, scene, NULL, &reason))
        fail_msg("%s: %s", what, reason.text);
}

/* Triangles about `centre`, up to `size` away, with `side` long sides; an axis can be flat. */
static struct scene cloud(struct rng *rng, uint32_t count, float centre, float size, float side,
                          int flat)
{
    struct scene scene = trees_grid(count);
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            float at = centre + rng_range(rng, -size, size);
            for (uint32_t c = 0; c < 3; c++)
                scene.vertex[9 * (size_t)i + 3 * c + (size_t)k] =
                    k == flat ? centre : at + rng_range(rng, -side, side);
        }
    return scene;
}

static void check_in_all(const struct scene *scene, uint32_t leaf, const char *what)
{
    struct bvh bvh = trees_make(scene, leaf, TREES_BALANCED);
    for (size_t l = 0; l < ARRAY_COUNT(shipped); l++) {
        struct packed packed;
        struct reason reason = {""};
        const struct layout *layout = layout_find(shipped[l].name);
        enum status status = packed_make(layout, &bvh, scene, &packed, &reason);
        if (!status)
            check(&packed, scene, what);
        else if (status != STATUS_LIMIT || shipped[l].largest > 1e9f)
            fail_msg("%s: %s", what, reason.text);
        packed_free(&packed);
    }
    bvh_free(&bvh);
}

static void no_box_is_too_small(void **state)
{
    (void)state;
    struct rng rng = rng_make(81, 0);
    for (int round = 0; round < 400; round++) {
        float size = ldexpf(1, (int)rng_below(&rng, 60) - 40);
        float centre = rng_below(&rng, 2) ? rng_range(&rng, -1e6f, 1e6f) : 0;
        float side = size * (rng_below(&rng, 2) ? 0.1f : 1e-5f);
        int kind = (int)rng_below(&rng, 6);
        uint32_t count = 1 + rng_below(&rng, 60);
        struct scene scene = cloud(&rng, count, centre, size, side, kind);
        char what[80];
        snprintf(what, sizeof what, "round %d, centre %a, size %a", round, (double)centre,
                 (double)size);
        check_in_all(&scene, 1 + rng_below(&rng, 12), what);
        scene_free(&scene);
    }
}

/* Bounds a hair beside a plane of the node's frame, whose distance from the origin of the frame a
 * double rounds to that of the plane. */
static void no_hair_is_lost_beside_a_plane(void **state)
{
    (void)state;
    for (int hair = -100; hair <= -20; hair++)
        for (int sign = -1; sign <= 1; sign += 2) {
            struct scene scene = trees_grid(40);
            float beside = (float)sign * ldexpf(1, hair);
            for (uint32_t i = 0; i < 9 * 40; i++) /* the origin at -1, a child on each side of 0 */
                scene.vertex[i] = i < 9 * 20 ? (i % 2 ? -1.0f : beside) : (i % 2 ? 0.75f : -beside);
            check_in_all(&scene, 20, "a hair beside a plane");
            scene_free(&scene);
        }
}

/* Of cwbvh80, as Ylitie, Karras and Laine have it: a child that is a node has 1 in the upper three
 * bits of its byte and 24 + its slot in the lower five; a leaf has as many ones as items, and where
 * they begin; a free slot has 0. */
static void bytes_of_children_are_as_published(void **state)
{
    (void)state;
    struct rng rng = rng_make(87, 0);
    struct scene scene = cloud(&rng, 200, 0, 10, 1, -1);
    struct bvh bvh = trees_make(&scene, 3, TREES_BALANCED);
    struct packed packed = pack("cwbvh80", &bvh, &scene);
    uint32_t nodes = 0, leaves = 0, free_slots = 0;
    for (uint32_t r = 0; r < packed.node_count; r++) {
        const uint32_t *word = packed.word + 20 * (size_t)r;
        uint32_t items = 0;
        for (uint32_t s = 0; s < 8; s++) {
            uint32_t meta = word[6 + s / 4] >> s % 4 * 8 & 0xFF, upper = meta >> 5;
            if (word[3] >> (24 + s) & 1) {
                assert_int_equal(meta, 1u << 5 | (24 + s));
                nodes++;
            } else if (meta) {
                assert_int_equal(meta & 31, items);
                assert_true(upper == 1 || upper == 3 || upper == 7);
                items += upper == 7 ? 3 : upper == 3 ? 2 : 1;
                leaves++;
            } else {
                free_slots++;
            }
        }
    }
    assert_true(nodes > 5 && leaves > 20 && free_slots > 0);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Said before anything is looked at: there is no tree. */
static void too_many_items_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *layout;
        uint32_t most;
    } full[] = {{"half4", 1u << 28}, {"amd64", 1u << 29}, {"hpb64", 1u << 22}};
    for (size_t i = 0; i < ARRAY_COUNT(full); i++) {
        const struct layout *layout = layout_find(full[i].layout);
        const struct bvh bvh = {.prim_count = full[i].most + 1};
        const struct scene scene = {.tri_count = full[i].most + 1};
        struct packed packed = {.layout = layout};
        struct reason reason = {""};
        char said[40];
        snprintf(said, sizeof said, "items, this tree has %u", full[i].most + 1);
        assert_int_equal(layout->pack(layout, &bvh, &scene, &packed, &reason), STATUS_LIMIT);
        assert_non_null(strstr(reason.text, said));
    }
}

static void the_range_of_floats_is_held_or_refused(void **state)
{
    (void)state;
    struct rng rng = rng_make(82, 0);
    for (size_t l = 0; l < ARRAY_COUNT(shipped); l++)
        for (int bits = -150; bits < 128; bits += 1) {
            float size = ldexpf(0.75f, bits);
            struct scene scene = cloud(&rng, 30, 0, size / 2, size / 2, -1);
            struct bvh bvh = trees_make(&scene, 4, TREES_BALANCED);
            struct packed packed;
            struct reason reason = {""};
            enum status status =
                packed_make(layout_find(shipped[l].name), &bvh, &scene, &packed, &reason);
            bool fits = shipped[l].largest == 0 || size <= shipped[l].largest;
            if (!status && size / 2 > shipped[l].largest && shipped[l].largest > 0)
                fail_msg("%s holds bounds of %a", shipped[l].name, (double)size);
            if (!status)
                check(&packed, &scene, shipped[l].name);
            else if (fits || status != STATUS_LIMIT || !strstr(reason.text, shipped[l].name))
                fail_msg("%s, %a: %s", shipped[l].name, (double)size, reason.text);
            packed_free(&packed);
            bvh_free(&bvh);
            scene_free(&scene);
        }
}

/* Of the first `triangles` of the grid, the last one `farther` along x; a leaf each in one node. */
static void expect_words(const char *layout, uint32_t triangles, float farther,
                         const uint32_t *word, uint32_t count)
{
    struct scene scene = trees_grid(triangles);
    for (uint32_t c = 0; c < 3; c++)
        scene.vertex[9 * (triangles - 1) + 3 * c] += farther;
    struct bvh bvh = trees_make(&scene, 1, TREES_BALANCED);
    struct packed packed = pack(layout, &bvh, &scene);
    for (uint32_t i = 0; i < packed.word_count && i < count; i++)
        if (packed.word[i] != word[i])
            fail_msg("%s word %u: %08X, not %08X", layout, i, packed.word[i], word[i]);
    assert_int_equal(packed.word_count, count);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void words_are_as_published(void **state)
{
    (void)state;
    /* x 0 to 127.625: 255 steps of 1/2 do not reach that, so of 1; y 0 to 1/8: 128 of 2^-10; z 0:
     * 2^-100. Five leaves of one item. */
    static const uint32_t cwbvh80[] = {
        0,          0,    0,          0x001B757F, /* origin, exponents */
        0,          0,    0x23222120, 0x24,       /* no node, items from 0 on; leaves of one */
        0,          0x7F, 0,          0,          /* lo x, lo y */
        0,          0,    0x01010101, 0x80,       /* lo z, hi x */
        0x80808080, 0x80, 0,          0,          /* hi y, hi z */
    };
    expect_words("cwbvh80", 5, 126.5f, cwbvh80, ARRAY_COUNT(cwbvh80));
    /* Two triangles: x 0 to 1/8 and 1/4 to 3/8, y 0 to 1/8, z 0. */
    static const uint32_t half4[] = {
        0x34000000, 0x7BFF7BFF, 0,          0x7BFF7BFF, /* min x, min y: of no child 65504 */
        0,          0x7BFF7BFF, 0x36003000, 0xFBFFFBFF, /* min z, max x */
        0x30003000, 0xFBFFFBFF, 0,          0xFBFFFBFF, /* max y, max z */
        0x10000000, 0x10000001, 0,          0,          /* one triangle each */
    };
    expect_words("half4", 2, 0, half4, ARRAY_COUNT(half4));
    static const uint32_t tiny8[] = {
        0,          0, 0,    0x001B7778, /* steps of 2^-7: 48 to 3/8, 2^-8: 32 to 1/8, 2^-100 */
        0,          0, 0x11, 0x20400000, /* leaves of one; x 0 to 16, y 0 to 32 */
        0x20C00020, 0, 0,    0,          0, 0, 0, 0, /* x 32 to 48 */
    };
    expect_words("tiny8", 2, 0, tiny8, ARRAY_COUNT(tiny8));
    static const uint32_t amd64[32] = {
        0x00,       0x08, 0xFFFFFFFF, 0xFFFFFFFF,                /* leaves of one: items 0 and 1 */
        0,          0,    0,          0x3E000000, 0x3E000000, 0, /* the root is of float32 */
        0x3E800000, 0,    0,          0x3EC00000, 0x3E000000, 0,
    };
    expect_words("amd64", 2, 0, amd64, ARRAY_COUNT(amd64));
    /* Extents 1/2, 1/8 and 2^-88, 4096 steps each. */
    static const uint32_t gfx12[32] = {
        0,     0,          0,          0,          0,          0,          0x10277C7E, 0x7F,
        0,     0xFF3FF000, 0x10000FFF, 0x00000800, 0xFFBFF000, 0x10000FFF, 0xFFFFFFFF, 0xFFF,
        0,     0xFFFFFFFF, 0xFFF,      0,          0xFFFFFFFF, 0xFFF,      0,          0xFFFFFFFF,
        0xFFF, 0,          0xFFFFFFFF, 0xFFF,      0,          0xFFFFFFFF, 0xFFF,      0,
    };
    expect_words("gfx12", 2, 0, gfx12, ARRAY_COUNT(gfx12));
}

/* The nearest half of 1/3 lies below it, so that a maximum there is lost without growth; of -1/3,
 * above it. Growth by n moves n halves on, over the ends of a binade too. */
static void growth_is_counted_in_halves(void **state)
{
    (void)state;
    const float third = 0x1.555556p-2f, nearest = 0x1.554p-2f;
    static const char *const member[] = {"amd64_g0", "amd64_g1"};
    static const int step[] = {0, 1};
    for (size_t m = 0; m < ARRAY_COUNT(member); m++) {
        /* 32 triangles: the root's children are nodes of float16. */
        struct scene scene = trees_grid(32);
        for (uint32_t i = 0; i < 9 * 32; i++)
            scene.vertex[i] = i / 9 % 2 ? third : -third;
        struct bvh bvh = trees_make(&scene, 1, TREES_BALANCED);
        struct packed packed = pack(member[m], &bvh, &scene);
        struct packed_faults faults;
        enum status status = packed_check(&packed, &scene, &faults, NULL);
        assert_int_equal(status, step[m] ? STATUS_OK : STATUS_INPUT);
        assert_true(step[m] || faults.loose_boxes > 0);
        struct wide root, node;
        packed.layout->load(&packed, packed.root, &root);
        assert_int_equal(root.box[0].hi[0] == third || root.box[0].hi[0] == -third, !step[m]);
        uint32_t inner = 0;
        while (root.child[inner] >= 2 * packed.node_count)
            inner++;
        packed.layout->load(&packed, root.child[inner], &node);
        for (uint32_t c = 0; c < node.child_count; c++) {
            float hi = node.box[c].hi[0];
            float from = hi > 0 ? nearest : -nearest;
            assert_true(hi == from + (float)step[m] * 0x1p-12f);
        }
        packed_free(&packed);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* Far from the origin float16 inflates boxes: then nodes are of float32. Near it they are not. */
static void nodes_are_mixed_by_what_they_lose(void **state)
{
    (void)state;
    static const struct {
        float centre;
        bool f32;
    } mixed[] = {{0, false}, {2000, true}};
    struct rng rng = rng_make(83, 0);
    for (size_t i = 0; i < ARRAY_COUNT(mixed); i++) {
        struct scene scene = cloud(&rng, 64, mixed[i].centre, 1, 0.05f, -1);
        struct bvh bvh = trees_make(&scene, 2, TREES_BALANCED);
        struct packed f16 = pack("amd64_f16", &bvh, &scene), f32 = pack("amd64_f32", &bvh, &scene);
        struct packed any = pack("amd64", &bvh, &scene);
        assert_int_equal(any.node_count, mixed[i].f32 ? f32.node_count : f16.node_count);
        assert_int_equal(f32.node_count, 2 * (f16.node_count - 1));
        packed_free(&any);
        packed_free(&f32);
        packed_free(&f16);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* Whatever the words hold, nothing outside is read and references stay in range. */
static void words_from_outside_are_safe(void **state)
{
    (void)state;
    struct scene scene = trees_grid(64);
    struct bvh bvh = trees_make(&scene, 4, TREES_BALANCED);
    for (size_t l = 0; l < ARRAY_COUNT(shipped); l++)
        any_words_are_safe(layout_find(shipped[l].name), &bvh, &scene);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void files_are_read_back(void **state)
{
    (void)state;
    struct scene scene = trees_grid(500);
    struct bvh bvh = trees_make(&scene, 5, TREES_BALANCED);
    for (size_t l = 0; l < ARRAY_COUNT(shipped); l++) {
        struct packed packed = pack(shipped[l].name, &bvh, &scene), back;
        char *bytes = NULL;
        size_t size = 0;
        FILE *stream = open_memstream(&bytes, &size);
        assert_non_null(stream);
        packed_file_write(&packed, stream);
        fclose(stream);
        struct reason reason = {""};
        if (packed_file_read("it", bytes, size, &scene, &back, NULL, &reason))
            fail_msg("%s", reason.text);
        assert_string_equal(reason.text, "");
        assert_int_equal(back.ref_count, packed.ref_count);
        assert_memory_equal(back.word, packed.word, packed_node_bytes(&packed));
        packed_free(&back);
        packed_free(&packed);
        free(bytes);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_box_is_too_small),
        cmocka_unit_test(no_hair_is_lost_beside_a_plane),
        cmocka_unit_test(bytes_of_children_are_as_published),
        cmocka_unit_test(too_many_items_are_refused),
        cmocka_unit_test(the_range_of_floats_is_held_or_refused),
        cmocka_unit_test(words_are_as_published),
        cmocka_unit_test(growth_is_counted_in_halves),
        cmocka_unit_test(nodes_are_mixed_by_what_they_lose),
        cmocka_unit_test(words_from_outside_are_safe),
        cmocka_unit_test(files_are_read_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
