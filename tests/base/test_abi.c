/* The bytes of ref/abi.h's structs on the running driver: shaders/probes/probe_abi.comp names every
 * field, C looks for the names where its own structs have the fields. */
#include "ref/abi_frame.h"

#include "tests/support/gpu.h"

/* What the probe wrote; the structs' own offsets decide where C looks. It writes two elements. */
struct abi_seen {
    struct ray ray[3];
    struct hit hit[3];
    struct node_f32 f32[3];
    struct node_rf rf[3];
    struct node_rtrs_direct direct[3];
    struct push push[3];
};

static const struct push told = {.ray_count = 60000,
                                 .root = 60100,
                                 .node_count = 60200,
                                 .item_count = 60300,
                                 .tri_count = 60400,
                                 .capacity = 60500};

static struct abi_seen *seen_on_device(void)
{
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    struct abi_seen *seen = calloc(1, sizeof *seen);
    assert_non_null(seen);
    gpu_run(vk, "probe_abi", (const uint32_t[]){32}, 1, &told, sizeof told, 1, 6,
            (const uint64_t[]){sizeof seen->ray, sizeof seen->hit, sizeof seen->f32,
                               sizeof seen->rf, sizeof seen->direct, sizeof seen->push},
            (void *const[]){seen->ray, seen->hit, seen->f32, seen->rf, seen->direct, seen->push});
    gpu_close(vk);
    return seen;
}

static void is(float value, uint32_t name)
{
    assert_int_equal(float_bits(value), float_bits((float)name));
}

static void abi_ray_and_hit_lie_where_c_has_them(void **state)
{
    (void)state;
    struct abi_seen *seen = seen_on_device();
    for (uint32_t e = 0; e < 2; e++) {
        for (uint32_t k = 0; k < 3; k++) {
            is(seen->ray[e].org[k], 10000 + 100 * e + k);
            is(seen->ray[e].dir[k], 10004 + 100 * e + k);
        }
        is(seen->ray[e].tmin, 10003 + 100 * e);
        is(seen->ray[e].tmax, 10007 + 100 * e);
        is(seen->hit[e].t, 20000 + 100 * e);
        is(seen->hit[e].u, 20001 + 100 * e);
        is(seen->hit[e].v, 20002 + 100 * e);
        assert_int_equal(seen->hit[e].prim, 20003 + 100 * e);
    }
    free(seen);
}

static void abi_nodes_lie_where_c_has_them(void **state)
{
    (void)state;
    struct abi_seen *seen = seen_on_device();
    for (uint32_t e = 0; e < 2; e++) {
        for (uint32_t k = 0; k < 3; k++) {
            is(seen->f32[e].lo[k], 30000 + 100 * e + k);
            is(seen->f32[e].hi[k], 30004 + 100 * e + k);
            assert_int_equal(seen->rf[e].bounds[k], 40000 + 100 * e + k);
            is(seen->direct[e].lo[k], 50004 + 100 * e + k);
            is(seen->direct[e].hi[k], 50008 + 100 * e + k);
        }
        assert_int_equal(seen->f32[e].first, 30003 + 100 * e);
        assert_int_equal(seen->f32[e].count, 30007 + 100 * e);
        assert_int_equal(seen->rf[e].tag, 40003 + 100 * e);
        assert_int_equal(seen->direct[e].fst, 50000 + 100 * e);
        assert_int_equal(seen->direct[e].snd, 50001 + 100 * e);
        assert_int_equal(seen->direct[e].item_first, 50002 + 100 * e);
        assert_int_equal(seen->direct[e].item_count, 50003 + 100 * e);
        assert_int_equal(seen->direct[e].pad0, 50007 + 100 * e);
        assert_int_equal(seen->direct[e].pad1, 50011 + 100 * e);
    }
    free(seen);
}

static void abi_push_constants_arrive_in_order(void **state)
{
    (void)state;
    struct abi_seen *seen = seen_on_device();
    for (uint32_t e = 0; e < 2; e++) {
        assert_int_equal(seen->push[e].ray_count, told.ray_count + e);
        assert_int_equal(seen->push[e].root, told.root + e);
        assert_int_equal(seen->push[e].node_count, told.node_count + e);
        assert_int_equal(seen->push[e].item_count, told.item_count + e);
        assert_int_equal(seen->push[e].tri_count, told.tri_count + e);
        assert_int_equal(seen->push[e].capacity, told.capacity + e);
    }
    free(seen);
}

static void nothing_is_written_behind_the_last(void **state)
{
    (void)state;
    static const struct abi_seen none;
    struct abi_seen *seen = seen_on_device();
    assert_memory_equal(&seen->ray[2], &none.ray[2], sizeof none.ray[2]);
    assert_memory_equal(&seen->hit[2], &none.hit[2], sizeof none.hit[2]);
    assert_memory_equal(&seen->f32[2], &none.f32[2], sizeof none.f32[2]);
    assert_memory_equal(&seen->rf[2], &none.rf[2], sizeof none.rf[2]);
    assert_memory_equal(&seen->direct[2], &none.direct[2], sizeof none.direct[2]);
    assert_memory_equal(&seen->push[2], &none.push[2], sizeof none.push[2]);
    free(seen);
}

/* --- frames ----------------------------------------------------------------------------------- */

struct frame_seen {
    struct shade_tri tri[2];
    struct shade_material material[2];
    struct shade_light light[2];
    struct segment segment[2];
    uint32_t word[32];
};

static struct frame_seen *frame_seen_on_device(const struct frame_push *push)
{
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    struct frame_seen *seen = calloc(1, sizeof *seen);
    assert_non_null(seen);
    gpu_run(vk, "probe_abi_frame", (const uint32_t[]){32}, 1, push, sizeof *push, 1, 5,
            (const uint64_t[]){sizeof seen->tri, sizeof seen->material, sizeof seen->light,
                               sizeof seen->segment, sizeof seen->word},
            (void *const[]){seen->tri, seen->material, seen->light, seen->segment, seen->word});
    gpu_close(vk);
    return seen;
}

static void abi_of_frames_lies_where_c_has_it(void **state)
{
    (void)state;
    const struct frame_push none = {0};
    struct frame_seen *seen = frame_seen_on_device(&none);
    for (uint32_t e = 0; e < 2; e++) {
        const uint32_t name = 100 * e;
        for (uint32_t k = 0; k < 3; k++) {
            is(seen->tri[e].na[k], name + k);
            is(seen->tri[e].nb[k], name + 4 + k);
            is(seen->tri[e].nc[k], name + 8 + k);
            is(seen->tri[e].plane[k], name + 12 + k);
            is(seen->material[e].color[k], name + k);
            is(seen->light[e].pos[k], name + k);
        }
        assert_int_equal(seen->tri[e].material, name + 3);
        assert_int_equal(seen->tri[e].pad0, name + 7);
        assert_int_equal(seen->tri[e].pad1, name + 11);
        assert_int_equal(seen->tri[e].pad2, name + 15);
        is(seen->material[e].spec, name + 3);
        is(seen->material[e].diffuse, name + 4);
        is(seen->material[e].specular, name + 5);
        is(seen->material[e].reflective, name + 6);
        assert_int_equal(seen->material[e].pad, name + 7);
        is(seen->light[e].strength, name + 3);
        is(seen->segment[e].t, name);
        assert_int_equal(seen->segment[e].prim, name + 1);
        assert_int_equal(seen->segment[e].asked, name + 2);
        assert_int_equal(seen->segment[e].shadowed, name + 3);
    }
    free(seen);
}

static void abi_push_constants_of_frames_arrive_in_order(void **state)
{
    (void)state;
    uint32_t word[sizeof(struct frame_push) / 4];
    struct frame_push push;
    for (uint32_t k = 0; k < ARRAY_COUNT(word); k++)
        word[k] = 0x3F800000u + k; /* as a float near 1, too */
    memcpy(&push, word, sizeof push);
    struct frame_seen *seen = frame_seen_on_device(&push);
    assert_memory_equal(word, seen->word, sizeof word);
    free(seen);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(abi_ray_and_hit_lie_where_c_has_them),
        cmocka_unit_test(abi_nodes_lie_where_c_has_them),
        cmocka_unit_test(abi_push_constants_arrive_in_order),
        cmocka_unit_test(nothing_is_written_behind_the_last),
        cmocka_unit_test(abi_of_frames_lies_where_c_has_it),
        cmocka_unit_test(abi_push_constants_of_frames_arrive_in_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
