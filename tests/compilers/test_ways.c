/* Buffers that are bound as texels or by their addresses (struct vk_ways of gpu/vk/vk.h), on the
 * device of tests/gpu/fake_vulkan.h: what each binding of each dispatch reads, by value. */
#include "tests/gpu/fake_work.h"

enum { BYTES = 256, MOST = 8, BINDINGS = 3 };

/* A device whose shaders read bindings 0 and 2 otherwise, and three buffers of numbered words. */
struct ways {
    struct vk_compiler compiler;
    struct vk *vk;
    struct vk_buffer *buffer[BINDINGS];
    struct vk_pipeline *quads, *words; /* binding 2 has words in the second */
    struct vk_sets *sets;
};

static enum status as_it_is(void *user, struct vk_shader *shader, struct reason *reason)
{
    (void)user, (void)shader, (void)reason;
    return STATUS_OK;
}

static uint32_t number_of(uint32_t buffer, uint64_t byte)
{
    return 1000u * buffer + (uint32_t)byte;
}

static enum status make_pipelines(struct ways *w, struct reason *reason)
{
    const struct shader *shader = shader_find("probe_abi");
    struct vk_shader of = {.name = "probe_abi",
                           .word = shader->word,
                           .word_count = shader->word_count,
                           .binding_count = BINDINGS,
                           .ways = w->compiler.ways};
    enum status status = vk_pipeline_make(w->vk, &of, &w->quads, reason);
    of.words = 1u << 2;
    return status ? status : vk_pipeline_make(w->vk, &of, &w->words, reason);
}

static enum status open_ways(struct ways *w, struct vk_ways ways, struct reason *reason)
{
    struct vk_options options = fake_options();
    *w = (struct ways){.compiler = {as_it_is, NULL, ways}};
    options.compiler = &w->compiler;
    enum status status = vk_open(&options, &w->vk, reason);
    for (uint32_t b = 0; b < BINDINGS && !status; b++) {
        uint32_t word[BYTES / 4];
        for (uint32_t i = 0; i < BYTES / 4; i++)
            word[i] = number_of(b, 4 * i);
        status = vk_buffer_make_of(w->vk, word, BYTES, &w->buffer[b], reason);
    }
    if (!status)
        status = make_pipelines(w, reason);
    return status ? status : vk_sets_make(w->vk, BINDINGS, ways, false, MOST, &w->sets, reason);
}

static void close_ways(struct ways *w)
{
    if (w->vk) {
        vk_sets_free(w->vk, w->sets);
        vk_pipeline_free(w->vk, w->quads);
        vk_pipeline_free(w->vk, w->words);
        vk_buffers_free(w->vk, w->buffer, BINDINGS);
    }
    assert_int_equal(vk_close(w->vk, NULL), 0);
    assert_int_equal(fake.alive, 0);
    if (fake.wrong)
        fail_msg("%s", fake.wrong);
}

static void must_open_ways(struct ways *w, struct vk_ways ways)
{
    struct reason reason;
    if (open_ways(w, ways, &reason))
        fail_msg("%s", reason.text);
}

/* What the shader of a dispatch reads first in a binding. */
static const uint32_t *read_at(const struct fake_dispatch *dispatch, uint32_t binding,
                               struct vk_ways ways)
{
    const struct fake_part *part = &dispatch->part[binding];
    if (!(ways.references >> binding & 1))
        return (const uint32_t *)(const void *)(part->byte + part->offset);
    uint64_t address;
    memcpy(&address, part->byte + part->offset, sizeof address);
    return (const uint32_t *)(uintptr_t)address; /* that of the fake device is the host's */
}

static const struct vk_ways all_ways[] = {{0, 0}, {5, 0}, {0, 5}, {7, 0}, {0, 7}, {1, 4}, {4, 1}};
static struct vk_ways now;

/* Looked at while it runs: the table of addresses is that of the submission. */
static void look(const struct fake_dispatch *dispatch)
{
    for (uint32_t b = 0; b < BINDINGS; b++)
        if (*read_at(dispatch, b, now) != number_of(b, dispatch->push[b]))
            fail_msg("binding %u reads %u, not %u", b, *read_at(dispatch, b, now),
                     number_of(b, dispatch->push[b]));
}

static void every_dispatch_reads_its_own_parts(void **state)
{
    (void)state;
    for (size_t k = 0; k < ARRAY_COUNT(all_ways); k++) {
        struct ways w;
        struct reason reason;
        struct vk_work work[MOST];
        uint32_t push[MOST][BINDINGS];
        fake_reset();
        now = all_ways[k];
        must_open_ways(&w, now);
        for (uint32_t i = 0; i < MOST; i++) {
            work[i] = (struct vk_work){
                .pipeline = i % 2 ? w.words : w.quads, .push = push[i], .groups = 1};
            for (uint32_t b = 0; b < BINDINGS; b++) {
                push[i][b] = 16 * ((i + 3 * b) % 8);
                work[i].part[b].offset = push[i][b];
                work[i].part[b].bytes = 16 * (1 + i % 4);
            }
        }
        for (uint32_t count = 1; count <= MOST; count++) {
            const uint32_t before = fake.dispatches;
            assert_int_equal(vk_dispatch_many(w.vk, w.sets, w.buffer, work, count, &reason), 0);
            for (uint32_t i = 0; i < count; i++) {
                struct fake_dispatch *did = &fake.log[(before + i) % FAKE_LOG];
                memcpy(did->push, push[i], sizeof push[i]);
                look(did);
                for (uint32_t b = 0; b < BINDINGS; b++) {
                    const bool texels = now.texels >> b & 1, words = b == 2 && i % 2;
                    assert_int_equal(did->part[b].format, !texels ? 0
                                                          : words ? VK_FORMAT_R32_UINT
                                                                  : VK_FORMAT_R32G32B32A32_UINT);
                    if (!(now.references >> b & 1))
                        assert_int_equal(did->part[b].bytes, work[i].part[b].bytes);
                }
            }
        }
        close_ways(&w);
    }
}

/* Of sets of one size after those of another: the table of addresses has room for all of them. */
static void sets_of_any_size_come_after_any_other(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, MOST, 2, 1, 40, 3, MOST};
    static const uint32_t push[BINDINGS] = {0, 16, 32};
    for (size_t k = 0; k < ARRAY_COUNT(all_ways); k++) {
        struct ways w;
        struct reason reason = {""};
        fake_reset();
        now = all_ways[k];
        must_open_ways(&w, now);
        for (size_t s = 0; s < ARRAY_COUNT(sizes); s++) {
            struct vk_work work[40];
            struct vk_sets *sets = NULL;
            for (uint32_t i = 0; i < sizes[s]; i++) {
                work[i] = (struct vk_work){.pipeline = w.quads, .push = push, .groups = 1};
                for (uint32_t b = 0; b < BINDINGS; b++) {
                    work[i].part[b].offset = push[b];
                    work[i].part[b].bytes = 16;
                }
            }
            const uint32_t before = fake.dispatches;
            gpu_must(vk_sets_make(w.vk, BINDINGS, now, false, sizes[s], &sets, &reason), &reason);
            gpu_must(vk_dispatch_many(w.vk, sets, w.buffer, work, sizes[s], &reason), &reason);
            for (uint32_t i = 0; i < sizes[s]; i++) {
                struct fake_dispatch *did = &fake.log[(before + i) % FAKE_LOG];
                memcpy(did->push, push, sizeof push);
                look(did);
                for (uint32_t b = 0; b < BINDINGS; b++)
                    assert_true(did->part[b].bytes > 0);
            }
            vk_sets_free(w.vk, sets);
        }
        close_ways(&w);
    }
}

/* Of whole buffers, again and again: nothing is left of earlier dispatches. */
static void whole_buffers_are_bound_and_views_end(void **state)
{
    (void)state;
    for (size_t k = 0; k < ARRAY_COUNT(all_ways); k++) {
        struct ways w;
        struct reason reason;
        struct vk_time time;
        long alive = 0;
        fake_reset();
        now = all_ways[k];
        must_open_ways(&w, now);
        for (int round = 0; round < 20; round++) {
            const uint32_t before = fake.dispatches;
            assert_int_equal(
                vk_dispatch(w.vk, round % 2 ? w.words : w.quads, w.buffer, NULL, 1, &time, &reason),
                0);
            struct fake_dispatch *did = &fake.log[before % FAKE_LOG];
            memset(did->push, 0, sizeof did->push);
            look(did);
            if (round == 1)
                alive = fake.alive;
            assert_true(round < 1 || fake.alive == alive);
        }
        close_ways(&w);
    }
}

static void texel_buffers_have_a_most(void **state)
{
    (void)state;
    struct ways w;
    struct reason reason;
    struct vk_work work = {.groups = 1};
    fake_reset();
    fake.device[0].base.limits.maxTexelBufferElements = 4;
    must_open_ways(&w, (struct vk_ways){5, 0});
    assert_int_equal(vk_quad_bytes(w.vk), 64);
    for (int words = 0; words < 2; words++)
        for (uint32_t at = 0; at < BINDINGS; at++)
            for (uint64_t over = 0; over < 2; over++) {
                const uint64_t most = words && at == 2 ? 16 : 64;
                work.pipeline = words ? w.words : w.quads;
                for (uint32_t b = 0; b < BINDINGS; b++)
                    work.part[b].bytes = 16;
                work.part[at].bytes = most + 16 * over;
                const enum status wanted = over && at != 1 ? STATUS_LIMIT : STATUS_OK;
                assert_int_equal(vk_work_check(w.vk, w.sets, &work, &reason), wanted);
                assert_int_equal(vk_dispatch_many(w.vk, w.sets, w.buffer, &work, 1, &reason),
                                 wanted);
            }
    struct vk_time time;
    assert_int_equal(vk_dispatch(w.vk, w.quads, w.buffer, NULL, 1, &time, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "texel buffers of 4 elements, 16 are needed"));
    close_ways(&w);
    fake_reset();
    fake.device[0].base.limits.maxTexelBufferElements = 4;
    must_open_ways(&w, (struct vk_ways){0, 5});
    assert_int_equal(vk_quad_bytes(w.vk), 1u << 26); /* what is no texel buffer has no such most */
    close_ways(&w);
}

/* The last quad of a buffer is whole. */
static void buffers_of_texels_end_with_a_whole_element(void **state)
{
    (void)state;
    for (uint64_t bytes = 1; bytes < 70; bytes++) {
        struct ways w;
        struct reason reason;
        struct vk_time time;
        fake_reset();
        must_open_ways(&w, (struct vk_ways){7, 0});
        vk_buffer_free(w.vk, w.buffer[0]);
        assert_int_equal(vk_buffer_make(w.vk, bytes, &w.buffer[0], &reason), 0);
        assert_int_equal(vk_buffer_bytes(w.buffer[0]), bytes < 16 ? 16 : bytes);
        const uint32_t before = fake.dispatches;
        assert_int_equal(vk_dispatch(w.vk, w.quads, w.buffer, NULL, 1, &time, &reason), 0);
        assert_int_equal(fake.log[before % FAKE_LOG].part[0].bytes, (bytes + 15) / 16 * 16);
        close_ways(&w);
    }
}

static void devices_without_addresses_are_told(void **state)
{
    (void)state;
    for (int old = 0; old < 2; old++) {
        struct ways w;
        struct reason reason;
        fake_reset();
        if (old)
            fake.device[0].base.apiVersion = VK_API_VERSION_1_1;
        else
            fake.device[0].has_address = false;
        assert_int_equal(open_ways(&w, (struct vk_ways){0, 1}, &reason), STATUS_UNSUPPORTED);
        assert_non_null(strstr(reason.text, "no device with Vulkan 1.2 buffer addresses"));
        close_ways(&w);
        must_open_ways(&w, (struct vk_ways){1, 0}); /* texels need nothing */
        close_ways(&w);
    }
}

/* Each call that can fail fails once, while all of it is made and used. */
static void nothing_is_lost_where_a_call_fails(void **state)
{
    (void)state;
    for (size_t k = 1; k < 3; k++) {
        bool failed = true;
        for (uint32_t at = 1; failed; at++) {
            struct ways w;
            struct reason reason;
            struct vk_time time;
            fake_reset();
            fake.fail_at = at;
            fake.result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
            enum status status = open_ways(&w, all_ways[k], &reason);
            for (int i = 0; i < 2 && !status; i++)
                status = vk_dispatch(w.vk, w.quads, w.buffer, NULL, 1, &time, &reason);
            failed = fake.failed != NULL;
            assert_true(failed || !status);
            close_ways(&w);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_dispatch_reads_its_own_parts),
        cmocka_unit_test(sets_of_any_size_come_after_any_other),
        cmocka_unit_test(whole_buffers_are_bound_and_views_end),
        cmocka_unit_test(texel_buffers_have_a_most),
        cmocka_unit_test(buffers_of_texels_end_with_a_whole_element),
        cmocka_unit_test(devices_without_addresses_are_told),
        cmocka_unit_test(nothing_is_lost_where_a_call_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
