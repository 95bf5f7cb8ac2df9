/* The Vulkan host: opening, choosing, limits, copies, hangs, validation. */
#define _POSIX_C_SOURCE 200809L
#include "tests/support/gpu.h"

#define NOWHERE "libnowhere-vulkan.so.1"

static void vulkan_without_a_loader_is_unsupported(void **state)
{
    (void)state;
    struct vk_options options = {.library = NOWHERE, .device = -1};
    struct reason reason = {""};
    struct vk *vk = (struct vk *)&options;
    char text[512] = "";
    assert_int_equal(vk_open(&options, &vk, &reason), STATUS_UNSUPPORTED);
    assert_null(vk);
    assert_non_null(strstr(reason.text, NOWHERE));
    vk_describe(&options, text, sizeof text);
    assert_non_null(strstr(text, NOWHERE));
}

static void vulkan_engine_without_a_loader_is_unsupported(void **state)
{
    (void)state;
    const struct engine *engine = engine_find("vulkan");
    struct engine_options options = {.device = -1};
    struct reason reason = {""};
    char text[512] = "";
    void *self = text;
    assert_non_null(engine);
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", NOWHERE, 1), 0);
    enum status status = engine->open(&options, &self, &reason);
    engine->describe(&options, text, sizeof text);
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    assert_int_equal(status, STATUS_UNSUPPORTED);
    assert_null(self);
    assert_non_null(strstr(reason.text, "no loader"));
    assert_non_null(strstr(text, "no loader"));
    engine->close(NULL);
}

static void vulkan_library_that_is_no_loader_is_unsupported(void **state)
{
    (void)state;
    struct vk_options options = {.library = "libm.so.6", .device = -1};
    struct reason reason = {""};
    struct vk *vk;
    assert_int_equal(vk_open(&options, &vk, &reason), STATUS_UNSUPPORTED);
    assert_null(vk);
    assert_non_null(strstr(reason.text, "vkGetInstanceProcAddr"));
}

static void vulkan_choice_without_match_says_what_there_is(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    char device[VK_NAME_BYTES];
    (void)snprintf(device, sizeof device, "%.60s", vk_limits(vk)->device);
    gpu_close(vk);
    struct reason reason = {""};
    options.driver = "no such driver";
    assert_int_equal(vk_open(&options, &vk, &reason), STATUS_UNSUPPORTED);
    assert_null(vk);
    if (!strstr(reason.text, "no such driver") || !strstr(reason.text, device))
        fail_msg("'%s' does not name '%s'", reason.text, device);
    options.driver = NULL;
    options.device = 99;
    assert_int_equal(vk_open(&options, &vk, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "99"));
}

static void vulkan_choice_takes_part_of_a_name_in_any_case(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    char part[5] = "";
    for (int i = 0; i < 4; i++)
        part[i] = (char)(vk_limits(vk)->device[i] ^ (vk_limits(vk)->device[i] >= 'A' ? 32 : 0));
    gpu_close(vk);
    options.driver = part;
    options.device = 0;
    vk = gpu_open(&options);
    gpu_close(vk);
}

static void vulkan_refuses_buffers_over_the_limit(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    struct reason reason = {""};
    struct vk_buffer *buffer = (struct vk_buffer *)&options;
    uint64_t limit = vk_limits(vk)->buffer_bytes;
    char number[32];
    (void)snprintf(number, sizeof number, "%llu", (unsigned long long)limit);
    assert_int_equal(vk_buffer_make(vk, limit + 1, &buffer, &reason), STATUS_LIMIT);
    assert_null(buffer);
    assert_non_null(strstr(reason.text, number));
    gpu_close(vk);
}

/* 40 MiB and a bit: more than two fillings of the staging buffer. */
static void copies_survive(bool staging)
{
    struct vk_options options = gpu_options();
    options.staging = staging;
    struct vk *vk = gpu_open(&options);
    struct reason reason = {""};
    struct vk_buffer *buffer;
    const size_t count = (10u << 20) + 3;
    uint32_t *data = malloc(4 * count), *back = calloc(count, 4);
    assert_true(data && back);
    if (staging)
        assert_false(vk_limits(vk)->shared_memory);
    for (size_t i = 0; i < count; i++)
        data[i] = (uint32_t)i * 2654435761u;
    gpu_must(vk_buffer_make(vk, 4 * count, &buffer, &reason), &reason);
    gpu_must(vk_buffer_write(vk, buffer, 0, data, 4 * count, &reason), &reason);
    gpu_must(vk_buffer_write(vk, buffer, 8, data, 4, &reason), &reason);
    data[2] = data[0];
    gpu_must(vk_buffer_read(vk, buffer, 4, back, 4 * (count - 1), &reason), &reason);
    assert_memory_equal(data + 1, back, 4 * (count - 1));
    vk_buffer_free(vk, buffer);
    gpu_close(vk);
    free(data);
    free(back);
}

static void vulkan_copies_through_a_map(void **state)
{
    (void)state;
    copies_survive(false);
}

static void vulkan_copies_through_staging(void **state)
{
    (void)state;
    copies_survive(true);
}

static enum status dispatch_probe(struct vk *vk, uint32_t push_bytes, struct reason *reason)
{
    const struct shader *shader = shader_find("probe_abi");
    struct vk_shader make = {.name = "probe_abi",
                             .word = shader->word,
                             .word_count = shader->word_count,
                             .binding_count = 6,
                             .push_bytes = push_bytes,
                             .constant = (const uint32_t[]){32},
                             .constant_count = 1};
    struct push push = {0};
    struct vk_buffer *buffer[6] = {0};
    struct vk_pipeline *pipeline = NULL;
    struct vk_time time;
    enum status status = vk_pipeline_make(vk, &make, &pipeline, reason);
    for (int i = 0; i < 6 && !status; i++)
        status = vk_buffer_make(vk, 256, &buffer[i], reason);
    if (!status)
        status = vk_dispatch(vk, pipeline, buffer, &push, 1, &time, reason);
    for (int i = 0; i < 6; i++)
        vk_buffer_free(vk, buffer[i]);
    vk_pipeline_free(vk, pipeline);
    return status;
}

/* One nanosecond is too short for any device: the first dispatch counts as hung, the device is
 * given up, and closing still leaves nothing behind. */
static void vulkan_reports_a_hang_and_gives_the_device_up(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    if (options.watch) { /* the layer waits after each submission, to read what was seen */
        print_message("SKIP hangs: the watching layer waits longer than any limit\n");
        skip();
    }
    options.wait_ns = 1;
    struct vk *vk = gpu_open(&options);
    struct reason reason = {""};
    enum status status = STATUS_OK; /* we may be kept from looking until it is done */
    for (int i = 0; i < 100 && !status; i++)
        status = dispatch_probe(vk, sizeof(struct push), &reason);
    assert_int_equal(status, STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "hangs"));
    assert_int_equal(dispatch_probe(vk, sizeof(struct push), &reason), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "lost or hung before"));
    gpu_close(vk);
}

static void vulkan_refuses_workgroups_over_the_limit(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    uint32_t most = vk_limits(vk)->group_size;
    gpu_close(vk);
    struct tracer *tracer = (struct tracer *)&options;
    struct reason reason = {""};
    assert_int_equal(tracer_open(&options, most + 1, &tracer, &reason), STATUS_UNSUPPORTED);
    assert_null(tracer);
    assert_non_null(strstr(reason.text, "workgroups"));
}

static struct vk *open_validated(void)
{
    struct vk_options options = gpu_options();
    options.validate = true;
    return gpu_open(&options);
}

static void vulkan_under_validation_says_nothing(void **state)
{
    (void)state;
    struct vk *vk = open_validated();
    struct reason reason = {""};
    gpu_must(dispatch_probe(vk, sizeof(struct push), &reason), &reason);
    assert_int_equal(vk_messages(vk, &reason), 0);
    gpu_close(vk);
}

/* 6 bytes of push constants: no multiple of 4, and not the 20 that the shader reads. */
static void vulkan_counts_validation_messages(void **state)
{
    (void)state;
    struct vk *vk = open_validated();
    struct reason reason = {""};
    (void)dispatch_probe(vk, 6, &reason);
    reason.text[0] = '\0';
    assert_true(vk_messages(vk, &reason) > 0);
    assert_non_null(strstr(reason.text, "vulkan validation: "));
    assert_true(vk_close(vk, &reason) > 0);
}

static void vulkan_counts_leaks_when_closing(void **state)
{
    (void)state;
    struct vk *vk = open_validated();
    struct reason reason = {""};
    struct vk_buffer *lost;
    gpu_must(vk_buffer_make(vk, 64, &lost, &reason), &reason);
    assert_int_equal(vk_messages(vk, NULL), 0);
    assert_true(vk_close(vk, &reason) > 0);
    assert_non_null(strstr(reason.text, "vulkan validation: "));
    free(lost);
}

static void vulkan_describes_its_devices(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    char text[4096] = "", cut[24] = "";
    vk_describe(&options, text, sizeof text);
    assert_non_null(strstr(text, vk_limits(vk)->device));
    assert_non_null(strstr(text, "workgroups to"));
    vk_describe(&options, cut, sizeof cut);
    assert_memory_equal(cut, text, sizeof cut - 1);
    gpu_close(vk);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vulkan_without_a_loader_is_unsupported),
        cmocka_unit_test(vulkan_engine_without_a_loader_is_unsupported),
        cmocka_unit_test(vulkan_library_that_is_no_loader_is_unsupported),
        cmocka_unit_test(vulkan_choice_without_match_says_what_there_is),
        cmocka_unit_test(vulkan_choice_takes_part_of_a_name_in_any_case),
        cmocka_unit_test(vulkan_refuses_buffers_over_the_limit),
        cmocka_unit_test(vulkan_copies_through_a_map),
        cmocka_unit_test(vulkan_copies_through_staging),
        cmocka_unit_test(vulkan_reports_a_hang_and_gives_the_device_up),
        cmocka_unit_test(vulkan_refuses_workgroups_over_the_limit),
        cmocka_unit_test(vulkan_under_validation_says_nothing),
        cmocka_unit_test(vulkan_counts_validation_messages),
        cmocka_unit_test(vulkan_counts_leaks_when_closing),
        cmocka_unit_test(vulkan_describes_its_devices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
