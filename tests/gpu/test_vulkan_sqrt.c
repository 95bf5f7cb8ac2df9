/* The square root of the rendering shaders is C's on every driver, to the bit: all floats with
 * exponents 126 and 127, which have every mantissa with both parities, and the ends of the range.
 */
#include "tests/support/probe_must.h"

#include <math.h>

#define GROUP  256u
#define GROUPS 2048u
#define COUNT  (GROUP * GROUPS)

static uint32_t bits_of(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static float float_of(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* COUNT floats from code `first` on, every stride-th. */
static void compare(struct vk *vk, const char *driver, uint32_t *root, uint32_t first,
                    uint32_t stride, int32_t worse)
{
    const uint32_t push[3] = {first, stride, (uint32_t)worse}, unread[4] = {0};
    probe_must(vk, "probe_sqrt",
               (struct probe_job){
                   .group = GROUP,
                   .groups = GROUPS,
                   .push = push,
                   .push_bytes = sizeof push,
                   .in = unread,
                   .in_bytes = sizeof unread,
                   .out = root,
                   .out_bytes = COUNT * sizeof *root,
               });
    for (uint32_t i = 0; i < COUNT; i++) {
        const float x = float_of(first + i * stride), right = sqrtf(x);
        if (isnan(right) ? !isnan(float_of(root[i])) : root[i] != bits_of(right))
            fail_msg("%s, %d ulp worse: root of %a is %a, not %a", driver, (int)worse, (double)x,
                     (double)float_of(root[i]), (double)right);
    }
}

static void compare_all(struct vk *vk, const char *driver, void *of)
{
    uint32_t *root = of;
    /* Subnormals and the least normals; the greatest, infinities and NaN; -0; all sorts. */
    compare(vk, driver, root, 0, 1, 0);
    compare(vk, driver, root, 0x00800000u - COUNT / 2, 1, 0);
    compare(vk, driver, root, 0x7F800000u - COUNT / 2, 1, 0);
    compare(vk, driver, root, 0x80000000u - COUNT / 2, 1, 0);
    compare(vk, driver, root, 0, 8191, 0);
    for (uint32_t at = 0; at < 1u << 24; at += COUNT)
        compare(vk, driver, root, (126u << 23) + at, 1, 0);
    /* Drivers here are right of themselves: what others may do is made up for, too. */
    static const int32_t worse[] = {-62, -3, -1, 1, 2, 62};
    for (size_t k = 0; k < ARRAY_COUNT(worse); k++) {
        compare(vk, driver, root, (127u << 23) - COUNT / 2, 1, worse[k]);
        compare(vk, driver, root, (128u << 23) - COUNT / 2, 1, worse[k]);
        compare(vk, driver, root, 0x00400000u, 8191, worse[k]);
    }
}

static void roots_are_rounded_to_nearest(void **state)
{
    (void)state;
    uint32_t *root = calloc(COUNT, sizeof *root);
    assert_non_null(root);
    bool any = gpu_on_cpu_drivers(compare_all, root);
    free(root);
    if (!any)
        skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(roots_are_rounded_to_nearest),
    };
    return cmocka_run_group_tests_name("vulkan_sqrt", tests, NULL, NULL) ? 1 : 0;
}
