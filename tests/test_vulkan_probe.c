/* The operator probe, on the running driver and on made-up results. */
#include "gpu/probe.h"

#include "tests/gpu.h"

static void run(struct probe_op op[PROBE_OPS], bool *ieee)
{
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    struct reason reason = {""};
    *ieee = gpu_is_lavapipe(vk);
    gpu_must(probe_run(vk, op, &reason), &reason);
    gpu_close(vk);
}

/* Vulkan's promises, in units of the last place: one neighbour for + - *, 2.5 for division. */
static void probe_finds_what_vulkan_promises(void **state)
{
    (void)state;
    struct probe_op op[PROBE_OPS];
    bool ieee;
    run(op, &ieee);
    for (uint32_t k = 0; k < PROBE_OPS; k++) {
        assert_true(op[k].ordinary > 10000 && op[k].special > 1000);
        if (strcmp(op[k].name, "a*b+c") == 0)
            continue; /* two roundings that cancellation can magnify */
        uint32_t most = strchr(op[k].name, '/') ? 3 : strchr(op[k].name, '?') ? 0 : 1;
        if (op[k].worst_ulp > most)
            fail_msg("%s is %u ulp off, %u are allowed", op[k].name, op[k].worst_ulp, most);
    }
}

static void probe_finds_lavapipe_exact(void **state)
{
    (void)state;
    struct probe_op op[PROBE_OPS];
    bool ieee;
    run(op, &ieee);
    if (!ieee) {
        print_message("SKIP this device is not lavapipe\n");
        skip();
    }
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        if (op[k].ordinary_differs || op[k].special_differs)
            fail_msg("%s: %u ordinary, %u special results differ", op[k].name,
                     op[k].ordinary_differs, op[k].special_differs);
}

static void probe_text_names_exact_and_other_operations(void **state)
{
    (void)state;
    struct probe_op op[PROBE_OPS];
    char text[1024];
    for (uint32_t k = 0; k < PROBE_OPS; k++)
        op[k] = (struct probe_op){.name = k ? "good" : "bad", .ordinary = 100, .special = 50};
    op[0].ordinary_differs = 7;
    op[0].worst_ulp = 3;
    probe_text(op, text, sizeof text);
    assert_non_null(strstr(text, "as in C to the bit: good good"));
    assert_non_null(strstr(text, "bad: 7 of 100 differ, at most 3 ulp; 0 of 50 "));
    char cut[30];
    probe_text(op, cut, sizeof cut);
    assert_memory_equal(cut, text, sizeof cut - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(probe_finds_what_vulkan_promises),
        cmocka_unit_test(probe_finds_lavapipe_exact),
        cmocka_unit_test(probe_text_names_exact_and_other_operations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
