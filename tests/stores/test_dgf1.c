/* Storage `dgf1`: a block, with its unused bytes put back, is one of the dense geometry format as
 * published (VK_AMDX_dense_geometry_format); a decoder of its own reads it, byte by byte. */
#include "ref/base/rng.h"
#include "ref/scene/quantise.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TRIS  64u
#define BYTES 128u

/* A block as published, and what it holds. */
struct dgf_block {
    uint8_t byte[BYTES];
    uint32_t tris, vertices, words, number, restarts, reuse; /* bits of the reuse buffer */
    float corner[TRIS][3][3];                                /* in the strip's order */
};

static uint32_t field(const uint8_t *byte, uint32_t at, uint32_t count)
{
    uint32_t value = 0;
    for (uint32_t i = 0; i < count; i++)
        value |= (uint32_t)(byte[(at + i) / 8] >> (at + i) % 8 & 1) << i;
    return value;
}

static int32_t with_sign(uint32_t x)
{
    return x & 0x800000u ? (int32_t)x - 0x1000000 : (int32_t)x;
}

/* Where the parts of a block end, from the front and from the end. */
static void find_parts(struct dgf_block *p, uint32_t *front, uint32_t *bits_per_vertex)
{
    const uint8_t *b = p->byte;
    assert_int_equal(field(b, 0, 8), 6);
    p->vertices = field(b, 10, 6) + 1;
    p->tris = field(b, 16, 6) + 1;
    assert_int_equal(field(b, 22, 10), 1); /* geometry 0, opaque */
    assert_in_range(field(b, 32, 8), 1, 232);
    *bits_per_vertex = field(b, 64, 4) + field(b, 68, 4) + field(b, 96, 4) + 3;
    assert_int_equal(*bits_per_vertex % 4, 0);
    assert_int_equal(field(b, 100, 4), 0); /* no micromaps, one geometry */
    assert_int_equal(field(b, 128, 29), 0);
    assert_int_equal(field(b, 157, 3), 1); /* user data, and two unused bits */
    *front = 24 + (p->vertices * *bits_per_vertex + 7) / 8;
    assert_true(*front - 24 <= 96);
    assert_int_equal(field(b, 192 + p->vertices * *bits_per_vertex,
                           8 * *front - 192 - p->vertices * *bits_per_vertex),
                     0);
}

static void vertex_at(const struct dgf_block *p, uint32_t v, float out[3])
{
    const uint8_t *b = p->byte;
    const uint32_t width[3] = {field(b, 64, 4) + 1, field(b, 68, 4) + 1, field(b, 96, 4) + 1};
    uint32_t at = 192 + v * (width[0] + width[1] + width[2]);
    for (uint32_t k = 0; k < 3; at += width[k], k++) {
        int32_t anchor = with_sign(field(b, 40 + 32 * k, 24));
        out[k] =
            ldexpf((float)(anchor + (int32_t)field(b, at, width[k])), (int)field(b, 32, 8) - 127);
    }
}

/* Reads the topology from the last bit of the block down. */
static void read_strip(struct dgf_block *p, uint32_t front)
{
    uint32_t control_end = 8 * BYTES, first_end = control_end - 2 * (p->tris - 1);
    uint32_t order[3] = {0}, before[3] = {0}, last = 0, counter = 0, reused = 0, index = 0;
    const uint32_t width = field(p->byte, 8, 2) + 3;
    for (uint32_t i = 0; i < p->tris; i++) {
        uint32_t control = i == 0 ? 0 : field(p->byte, control_end - 2 * i, 2), three[3];
        uint32_t fresh = control == 0 ? 3 : 1;
        p->restarts += control == 0;
        if (control == 3) /* not after a restart or another one */
            assert_true(last == 1 || last == 2);
        if (control == 1)
            three[0] = order[2], three[1] = order[1];
        if (control == 2)
            three[0] = order[0], three[1] = order[2];
        if (control == 3 && last == 1)
            three[0] = before[0], three[1] = before[2];
        if (control == 3 && last == 2)
            three[0] = before[2], three[1] = before[1];
        for (uint32_t n = 3 - fresh; n < 3; n++, index++) {
            bool is_first = index < 3 || field(p->byte, first_end - (index - 2), 1);
            three[n] = is_first ? counter++ : field(p->byte, 8 * front + width * reused++, width);
            assert_true(three[n] < p->vertices);
        }
        memcpy(before, order, sizeof order);
        memcpy(order, three, sizeof order);
        last = control;
        for (uint32_t n = 0; n < 3; n++)
            vertex_at(p, three[n], p->corner[i][n]);
    }
    assert_int_equal(counter, p->vertices);
    p->reuse = width * reused;
    assert_true(p->reuse <= 8 * 24);
    /* Nothing but zeros between the parts. */
    uint32_t at = 8 * front + width * reused, end = first_end - (index - 3);
    assert_true(at <= end);
    for (; at < end; at++)
        assert_int_equal(field(p->byte, at, 1), 0);
}

/* Puts the bytes back that the storage leaves out: before the topology. */
static void publish(const uint32_t *word, struct dgf_block *p)
{
    memset(p, 0, sizeof *p);
    p->words = (word[5] & 31u) + 1;
    p->number = (word[5] >> 5 & 31u) + 1;
    assert_int_equal(word[5] >> 10, 0);
    uint8_t *b = p->byte;
    memcpy(b, word, 4 * p->words);
    uint32_t front, bits;
    find_parts(p, &front, &bits);
    /* All words but the header, the vertices and the reuse buffer move; the latter's length shows
     * when the strip is read, so bits move from the end as long as they are of the topology. */
    memset(b + front, 0, BYTES - front);
    const uint8_t *from = (const uint8_t *)word;
    uint32_t tris = p->tris, indices = tris + 2, taken = 2 * (tris - 1), end = 32 * p->words;
    for (uint32_t i = 1; i < tris; i++)
        indices += field(from, end - 2 * i, 2) == 0 ? 2 : 0;
    taken += indices - 3;
    uint32_t reuse = indices - p->vertices;
    for (uint32_t i = 0; i < reuse * (field(b, 8, 2) + 3); i++)
        b[(8 * front + i) / 8] |= (uint8_t)(field(from, 8 * front + i, 1) << (8 * front + i) % 8);
    for (uint32_t i = 1; i <= taken; i++)
        b[(8 * BYTES - i) / 8] |= (uint8_t)(field(from, end - i, 1) << (8 * BYTES - i) % 8);
    read_strip(p, front);
}

static struct packed store(const struct scene *scene, uint32_t count, uint32_t *at)
{
    struct packed packed = {.layout = layouts[0], .store = tri_store_find("dgf1")};
    struct reason reason = {""};
    uint32_t prim[TRIS];
    for (uint32_t i = 0; i < count; i++)
        prim[i] = i * 7919u % scene->tri_count;
    for (uint32_t i = 0; i < count && scene->tri_count == count; i++)
        prim[i] = i;
    if (store_put(scene, prim, count, &packed, at, &reason))
        fail_msg("%s", reason.text);
    for (uint32_t i = 0; i < count; i++)
        assert_int_equal(packed.store->item(&packed, *at, i), prim[i]);
    return packed;
}

/* The block has the scene's triangles: as published up to which vertex is the first, and that, too,
 * as the storage reads them. Returns how often the strip begins anew. */
static uint32_t expect_block(const struct scene *scene, uint32_t count)
{
    uint32_t at;
    struct dgf_block p;
    struct packed packed = store(scene, count, &at);
    publish(packed.item + at, &p);
    assert_int_equal(p.tris, count);
    assert_true(p.words <= 32);
    for (uint32_t i = 0; i < count; i++) {
        float own[3][3], read[3][3];
        bool same = false;
        scene_tri(scene, packed.store->item(&packed, at, i), own);
        assert_true(packed.store->tri(&packed, at, i, read));
        assert_memory_equal(read, own, sizeof own);
        for (uint32_t turn = 0; turn < 3; turn++) {
            bool all = true;
            for (uint32_t n = 0; n < 3; n++)
                all = all && memcmp(p.corner[i][n], own[(n + turn) % 3], sizeof own[0]) == 0;
            same = same || all;
        }
        assert_true(same);
    }
    free(packed.item);
    return p.restarts;
}

/* A strip or fan of `count` triangles whose vertices lie on the grid, turned at random; every
 * `flip`-th is wound the other way (0: none). */
static struct scene ribbon(struct rng *rng, uint32_t count, bool fan, uint32_t flip)
{
    struct scene scene;
    assert_int_equal(scene_make(count + 2, count, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * (count + 2); i++)
        scene.vertex[i] = (float)(i % 3 ? rng_below(rng, 16) : i / 3);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t v[3] = {fan ? 0 : i, i + 1, i + 2}, turn = rng_below(rng, 3);
        if (!fan && i % 2) {
            v[0] = i + 1;
            v[1] = i;
        }
        if (flip && i % flip == 0) {
            uint32_t swap = v[0];
            v[0] = v[1];
            v[1] = swap;
        }
        for (uint32_t n = 0; n < 3; n++)
            scene.index[3 * i + n] = v[(n + turn) % 3];
    }
    return scene;
}

static void blocks_are_as_published(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 2);
    for (uint32_t count = 1; count <= 40; count++)
        for (uint32_t kind = 0; kind < (count <= 16 ? 8 : 2); kind++) {
            struct scene scene = ribbon(&rng, count, kind % 2, kind < 2 ? 0 : kind);
            uint32_t restarts = expect_block(&scene, count);
            if (kind < 2) /* each triangle shares an edge with the one before it */
                assert_int_equal(restarts, 1);
            scene_free(&scene);
        }
}

/* A row of triangles on both sides of a strip: every third goes back to the one before the last. */
static void strips_go_back(void **state)
{
    (void)state;
    struct scene scene;
    /* As the published picture: 0 1 2, 2 1 3, 3 1 4, then 2 3 5. */
    static const uint32_t index[] = {0, 1, 2, 2, 1, 3, 3, 1, 4, 2, 3, 5};
    for (uint32_t turn = 0; turn < 81; turn++) {
        assert_int_equal(scene_make(6, 4, &scene), STATUS_OK);
        for (uint32_t i = 0; i < 18; i++)
            scene.vertex[i] = (float)(i * i % 29) - 7;
        for (uint32_t i = 0, power = 1; i < 4; i++, power *= 3)
            for (uint32_t n = 0; n < 3; n++)
                scene.index[3 * i + n] = index[3 * i + (n + turn / power) % 3];
        assert_int_equal(expect_block(&scene, 4), 1);
        scene_free(&scene);
    }
}

/* Vertices that triangles name twice or three times, and triangles that are the same. */
static void triangles_may_fold_and_repeat(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 4);
    for (uint32_t round = 0; round < 3000; round++) {
        struct scene scene;
        uint32_t count = 1 + rng_below(&rng, 12), vertices = 1 + rng_below(&rng, 6);
        assert_int_equal(scene_make(vertices, count, &scene), STATUS_OK);
        for (uint32_t i = 0; i < 3 * vertices; i++)
            scene.vertex[i] = (float)rng_below(&rng, 3) - 1;
        for (uint32_t i = 0; i < 3 * count; i++)
            scene.index[i] = rng_below(&rng, vertices);
        (void)expect_block(&scene, count);
        scene_free(&scene);
    }
}

/* Every width of every axis, anchors at both ends, the least and the largest exponents. */
static void grids_are_held_to_their_ends(void **state)
{
    (void)state;
    static const float step[] = {0x1p-126f, 0x1p-60f, 0.5f, 0x1p60f, 0x1p104f, 0x1p105f};
    for (size_t e = 0; e < ARRAY_COUNT(step); e++)
        for (uint32_t axis = 0; axis < 3; axis++)
            for (uint32_t width = 0; width <= 16; width++)
                for (uint32_t end = 0; end < 3; end++) {
                    struct scene scene;
                    int32_t most = (1 << width) - 1;
                    int32_t lo = end == 0 ? -EVEN_MOST : end == 1 ? EVEN_MOST - most : -(most / 2);
                    assert_int_equal(scene_make(4, 2, &scene), STATUS_OK);
                    for (uint32_t i = 0; i < 12; i++)
                        scene.vertex[i] = (float)(i % 3 != axis ? 1 - 2 * (int)(i % 2)
                                                  : i < 3       ? lo
                                                  : i < 6       ? lo + most
                                                                : lo + most / 2) *
                                          step[e];
                    for (uint32_t i = 0; i < 6; i++)
                        scene.index[i] = i < 3 ? i : i - 2;
                    (void)expect_block(&scene, 2);
                    scene_free(&scene);
                }
}

/* As many words as the sum of its parts: nothing is left to chance. */
static void leaves_take_the_words_of_their_parts(void **state)
{
    (void)state;
    struct rng rng = rng_make(5, 6);
    for (uint32_t count = 1; count <= 40; count++) {
        uint32_t at, front, bits;
        struct dgf_block p = {.tris = 0};
        struct scene scene = ribbon(&rng, count, false, 0);
        struct packed packed = store(&scene, count, &at);
        publish(packed.item + at, &p);
        find_parts(&p, &front, &bits);
        /* A ribbon: three indices, then one each, none again; number: as large as the largest. */
        uint32_t block = 8 * front + (count - 1) * 3, number = 1;
        while ((count - 1) >> number)
            number++;
        assert_int_equal(p.words, (block + 31) / 32);
        assert_int_equal(p.number, number);
        assert_int_equal(packed.item_count - at, p.words + (count * (number + 2) + 31) / 32);
        free(packed.item);
        scene_free(&scene);
    }
}

static void expect_refused(struct scene *scene, uint32_t count, const char *text)
{
    struct packed packed = {.layout = layouts[0], .store = tri_store_find("dgf1")};
    struct reason reason = {""};
    uint32_t at, prim[TRIS + 1];
    for (uint32_t i = 0; i < count; i++)
        prim[i] = i;
    assert_int_equal(store_put(scene, prim, count, &packed, &at, &reason), STATUS_LIMIT);
    if (!strstr(reason.text, text))
        fail_msg("'%s' has no '%s'", reason.text, text);
    free(packed.item);
    scene_free(scene);
}

static void what_does_not_fit_is_refused(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 8);
    struct scene scene = ribbon(&rng, TRIS + 1, true, 0);
    expect_refused(&scene, TRIS + 1, "the leaf of triangle 0 and the 64 beside it");
    scene = ribbon(&rng, 1, true, 0);
    scene.vertex[4] = scene.vertex[1] + 65536; /* 65535 steps are taken above */
    expect_refused(&scene, 1, "does not fit in a block of 128 bytes and 65536 steps");
    scene = ribbon(&rng, 1, true, 0);
    scene.vertex[4] = 0x1p-149f;
    expect_refused(&scene, 1, "storage dgf1: the scene's coordinates lie on no grid of one step");
    scene = ribbon(&rng, 1, true, 0);
    scene.vertex[4] = -0.0f;
    expect_refused(&scene, 1, "lie on no grid");
    scene = ribbon(&rng, 1, true, 0);
    scene.vertex[0] = 0x1.000002p23f + 1;
    scene.vertex[3] = 1;
    expect_refused(&scene, 1, "lie on no grid");
}

/* Of random triangles as many as fit: some leaf has a reuse buffer that is just full. */
static void a_reuse_buffer_may_be_full(void **state)
{
    (void)state;
    struct rng rng = rng_make(9, 10);
    uint32_t full = 0, prim[TRIS];
    for (uint32_t round = 0; round < 60; round++) {
        struct scene scene;
        struct dgf_block p = {.tris = 0};
        const uint32_t vertices = 5 + round % 12;
        assert_int_equal(scene_make(vertices, TRIS, &scene), STATUS_OK);
        for (uint32_t i = 0; i < 3 * vertices; i++)
            scene.vertex[i] = (float)(i % 3 ? rng_below(&rng, 4) : i / 3);
        for (uint32_t i = 0; i < 3 * TRIS; i++)
            scene.index[i] = rng_below(&rng, vertices), prim[i / 3] = i / 3;
        for (uint32_t count = TRIS, at; p.tris == 0; count--) {
            struct packed packed = {.layout = layouts[0], .store = tri_store_find("dgf1")};
            if (store_put(&scene, prim, count, &packed, &at, NULL) == STATUS_OK)
                publish(packed.item + at, &p);
            free(packed.item);
        }
        full += p.reuse == 8 * 24;
        scene_free(&scene);
    }
    assert_true(full > 0);
}

/* Five triangles without a common vertex always fit, whatever the widths. */
static void five_triangles_fit(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(scene_make(15, 5, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 45; i++)
        scene.vertex[i] = (float)(i < 3 ? 0 : i < 6 ? 65535 : i * 1361 % 65536);
    for (uint32_t i = 0; i < 15; i++)
        scene.index[i] = i;
    assert_int_equal(expect_block(&scene, 5), 5);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_as_published),
        cmocka_unit_test(strips_go_back),
        cmocka_unit_test(triangles_may_fold_and_repeat),
        cmocka_unit_test(grids_are_held_to_their_ends),
        cmocka_unit_test(leaves_take_the_words_of_their_parts),
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(a_reuse_buffer_may_be_full),
        cmocka_unit_test(five_triangles_fit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
