/* Triangles behind others in a buffer, more than are gathered at a time: those of the scene, to the
 * bit, in its order, and not a byte beside them. The device is that of tests/gpu/fake_vulkan.h. */
#include "gpu/trace/gather.h"
#include "scenes/scenes.h"
#include "tests/gpu/fake_work.h"

#define MOST (1u << 15)

/* All that a buffer of `all` bytes holds, which was `filled` all over. */
static void behind_and_before(struct vk *vk, uint32_t count, uint64_t first, size_t behind)
{
    static char filled[36 * MOST], got[36 * MOST];
    const size_t tri_bytes = ABI_TRI_FLOATS * sizeof(float);
    const size_t bytes = gather_bytes(first + count + behind);
    struct reason reason = {""};
    struct vk_buffer *buffer = NULL;
    struct scene scene;
    char spec[40];
    (void)snprintf(spec, sizeof spec, "soup:n=%u", count);
    gpu_must(scene_open(spec, 5, &scene, &reason), &reason);
    assert_int_equal(scene.tri_count, count);
    assert_true(bytes <= sizeof filled);
    memset(filled, 0x5A, sizeof filled);
    gpu_must(vk_buffer_make(vk, bytes, &buffer, &reason), &reason);
    gpu_must(vk_buffer_write(vk, buffer, 0, filled, bytes, &reason), &reason);
    gpu_must(gather_write(vk, &scene, buffer, first, &reason), &reason);
    gpu_must(vk_buffer_read(vk, buffer, 0, got, bytes, &reason), &reason);
    for (uint32_t i = 0; i < count; i++) {
        float tri[3][3];
        scene_tri(&scene, i, tri);
        if (memcmp(got + tri_bytes * (first + i), tri, tri_bytes) != 0)
            fail_msg("%u behind %u: triangle %u is another", count, (unsigned)first, i);
    }
    assert_memory_equal(got, filled, tri_bytes * first);
    const size_t end = tri_bytes * (first + count);
    assert_memory_equal(got + end, filled + end, bytes - end);
    vk_buffer_free(vk, buffer);
    scene_free(&scene);
}

static void triangles_are_where_they_belong(void **state)
{
    (void)state;
    static const uint32_t counts[] = {0, 1, 8191, 8192, 8193, 16384, 20000};
    static const uint64_t firsts[] = {0, 1, 7, 8192, 9001};
    const struct vk_options options = fake_options();
    fake_reset();
    struct vk *vk = must_open(&options);
    for (size_t i = 0; i < ARRAY_COUNT(counts); i++)
        for (size_t k = 0; k < ARRAY_COUNT(firsts); k++)
            behind_and_before(vk, counts[i], firsts[k], i % 3);
    must_close(vk);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(triangles_are_where_they_belong)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
