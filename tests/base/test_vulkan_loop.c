/* The loops of shaders/probes/probe_loop.comp, which measure drivers that end loops early, take the
 * steps that C takes, to the state in which they end. */
#include "tests/support/probe_must.h"

static uint32_t advanced(uint32_t state)
{
    return (state * 1664525u + 1013904223u) >> 1;
}

/* Two loops one after the other, or `nested` steps in each step: steps of the first, of the second,
 * and the state in which they end. */
static void by_c(uint32_t kind, uint32_t steps, uint32_t nested, uint32_t state, uint32_t want[3])
{
    const uint32_t first = kind == 2 ? steps / nested : steps;
    const uint32_t second = kind == 0 ? 0 : kind == 1 ? steps : first * nested;
    want[0] = first;
    want[1] = second;
    for (uint32_t i = 0; i < (kind == 2 ? second : first + second); i++)
        state = advanced(state);
    want[2] = state;
}

static void loops_take_the_steps_that_they_are_told(void **state)
{
    (void)state;
    static const uint32_t steps[] = {0, 1, 2, 15, 16, 17, 1000}, nested[] = {1, 2, 7, 16};
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    if (!gpu_is_lavapipe(vk)) {
        print_message("SKIP this device is not lavapipe\n");
        gpu_close(vk);
        skip();
    }
    for (uint32_t s = 0; s < ARRAY_COUNT(steps); s++)
        for (uint32_t n = 0; n < ARRAY_COUNT(nested); n++) {
            const uint32_t push[2] = {steps[s], nested[n]}, seed[4] = {12345 + 77 * s + n};
            uint32_t got[16], want[3];
            probe_must(vk, "probe_loop",
                       (struct probe_job){
                           .group = 4,
                           .groups = 1,
                           .push = push,
                           .push_bytes = sizeof push,
                           .in = seed,
                           .in_bytes = sizeof seed,
                           .out = got,
                           .out_bytes = sizeof got,
                       });
            for (uint32_t kind = 0; kind < 3; kind++) {
                by_c(kind, steps[s], nested[n], seed[0], want);
                assert_memory_equal(&got[3 * kind], want, sizeof want);
            }
        }
    gpu_close(vk);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loops_take_the_steps_that_they_are_told),
    };
    return cmocka_run_group_tests_name("vulkan_loop", tests, NULL, NULL) ? 1 : 0;
}
