/* The conditions without branches of shaders (shaders/pick.glsl) under every condition: of
 * conjunctions all operands count, in any order. */
#include "tests/support/probe_must.h"

#define CASES   8u
#define RESULTS 13u

static void conditions_choose_as_in_c(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    const uint32_t unread[4] = {0};
    float got[CASES * RESULTS];
    probe_must(vk, "probe_pick",
               (struct probe_job){
                   .group = CASES,
                   .groups = 1,
                   .push = unread,
                   .push_bytes = sizeof unread,
                   .in = unread,
                   .in_bytes = sizeof unread,
                   .out = got,
                   .out_bytes = sizeof got,
               });
    gpu_close(vk);
    for (uint32_t i = 0; i < CASES; i++) {
        const bool a = i & 1, b = i & 2, c = i & 4;
        assert_true(got[i * RESULTS] == (a && b));
        assert_true(got[i * RESULTS + 1] == (a && b && c));
        for (uint32_t k = 2; k < RESULTS; k++) /* values k; those of the other side are 10 more */
            assert_true(got[i * RESULTS + k] == (float)(a ? k : k + 10));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(conditions_choose_as_in_c),
    };
    return cmocka_run_group_tests_name("vulkan_pick", tests, NULL, NULL) ? 1 : 0;
}
