/* Accesses of shaders to memory, watched by the validation layer on every driver that is here: a
 * sound dispatch passes without a word, one whose buffer is too short is named. */
#include "tests/support/drivers.h"

#include "ref/abi.h"

#define BINDINGS 6
#define BYTES    256 /* enough for what probe_abi writes into each */

/* Runs probe_abi with the last buffer of `last_bytes` and returns the number of messages. */
static uint32_t messages_of(const struct vk_options *options, uint64_t last_bytes,
                            struct reason *reason)
{
    const struct shader *shader = shader_find("probe_abi");
    struct vk *vk = gpu_open(options);
    struct vk_shader make = {.name = "probe_abi",
                             .word = shader->word,
                             .word_count = shader->word_count,
                             .binding_count = BINDINGS,
                             .push_bytes = sizeof(struct push),
                             .constant = (const uint32_t[]){32},
                             .constant_count = 1};
    struct push push = {0};
    struct vk_buffer *buffer[BINDINGS];
    struct vk_pipeline *pipeline;
    struct vk_time time;
    gpu_must(vk_pipeline_make(vk, &make, &pipeline, reason), reason);
    for (uint32_t i = 0; i < BINDINGS; i++)
        gpu_must(vk_buffer_make(vk, i + 1 < BINDINGS ? BYTES : last_bytes, &buffer[i], reason),
                 reason);
    gpu_must(vk_dispatch(vk, pipeline, buffer, &push, 1, &time, reason), reason);
    uint32_t before = vk_messages(vk, reason);
    for (uint32_t i = 0; i < BINDINGS; i++)
        vk_buffer_free(vk, buffer[i]);
    vk_pipeline_free(vk, pipeline);
    assert_int_equal(vk_close(vk, NULL), before);
    return before;
}

static bool is_here(const struct vk_options *options)
{
    struct reason reason = {""};
    struct vk *vk;
    enum status status = vk_open(options, &vk, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        return false;
    }
    gpu_must(status, &reason);
    gpu_close(vk);
    return true;
}

static void watching_names_an_access_out_of_bounds(void **state)
{
    (void)state;
    size_t drivers = 0;
    for (size_t i = 0; i < ARRAY_COUNT(cpu_drivers); i++) {
        const struct vk_options options = {.driver = cpu_drivers[i], .device = -1, .watch = true};
        struct reason reason = {""};
        if (!is_here(&options))
            continue;
        if (messages_of(&options, BYTES, &reason) != 0)
            fail_msg("%s: %s", cpu_drivers[i], reason.text);
        if (messages_of(&options, sizeof(uint32_t), &reason) == 0)
            fail_msg("%s: nothing was seen", cpu_drivers[i]);
        if (!strstr(reason.text, "access out of bounds"))
            fail_msg("%s: %s", cpu_drivers[i], reason.text);
        drivers++;
    }
    if (drivers == 0)
        skip();
}

/* Else the other suites' broken trees could not run under plain validation. */
static void plain_validation_sees_no_accesses(void **state)
{
    (void)state;
    const struct vk_options options = {.device = -1, .validate = true};
    struct reason reason = {""};
    if (!is_here(&options))
        skip();
    assert_int_equal(messages_of(&options, sizeof(uint32_t), &reason), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(watching_names_an_access_out_of_bounds),
        cmocka_unit_test(plain_validation_sees_no_accesses),
    };
    return cmocka_run_group_tests_name("vulkan_watched", tests, NULL, NULL) ? 1 : 0;
}
