/* Limits of dispatches and pipelines, clocks, messages of the layer, and the engines on a device
 * that fails: by value (tests/gpu/fake_vulkan.h). */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include "tests/gpu/fake_engines.h"

/* Of limits the number itself is allowed, one more is not. */
static void limits_of_pipelines_are_exact(void **state)
{
    (void)state;
    static const struct {
        uint32_t group, bindings;
        enum status want;
    } cases[] = {{1, 2, STATUS_OK},          {64, 2, STATUS_OK}, {65, 2, STATUS_UNSUPPORTED},
                 {0, 2, STATUS_UNSUPPORTED}, {8, 4, STATUS_OK},  {8, 5, STATUS_UNSUPPORTED}};
    const struct shader *shader = shader_find("probe_abi");
    struct vk_options options = fake_options();
    struct reason reason = {""};
    struct vk *vk;
    fake_reset();
    fake.device[0].base.limits.maxComputeWorkGroupSize[0] = 64;
    fake.device[0].base.limits.maxPerStageDescriptorStorageBuffers = 4;
    gpu_must(vk_open(&options, &vk, &reason), &reason);
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        const struct vk_shader of = {.name = "probe_abi",
                                     .word = shader->word,
                                     .word_count = shader->word_count,
                                     .binding_count = cases[i].bindings,
                                     .constant = &cases[i].group,
                                     .constant_count = 1};
        struct vk_pipeline *pipeline;
        assert_int_equal(vk_pipeline_make(vk, &of, &pipeline, &reason), cases[i].want);
        assert_int_equal(pipeline != NULL, cases[i].want == STATUS_OK);
        vk_pipeline_free(vk, pipeline);
    }
    assert_int_equal(vk_close(vk, NULL), 0);
    must_be_clean("pipelines");
}

/* The last of several dispatches has `groups` workgroups, of which 6 are allowed. */
static void dispatch_groups(uint32_t groups, enum status want)
{
    static const uint32_t push[2] = {1, 2};
    struct vk_options options = fake_options();
    struct fake_work w = {0};
    struct reason reason = {""};
    struct vk_time time = {1, true};
    fake_reset();
    fake.device[0].base.limits.maxComputeWorkGroupCount[0] = 6;
    gpu_must(work_make(&w, &options, &reason), &reason);
    const struct vk_step step[] = {{.pipeline = w.pipeline, .push = push, .groups = 6},
                                   {.pipeline = w.pipeline, .push = push, .groups = groups}};
    const struct vk_work work[] = {
        {.pipeline = w.pipeline, .part = {{0, 16}, {0, 16}}, .push = push, .groups = 6},
        {.pipeline = w.pipeline, .part = {{0, 16}, {0, 16}}, .push = push, .groups = groups}};
    assert_int_equal(vk_dispatch(w.vk, w.pipeline, w.buffer, push, groups, &time, &reason), want);
    assert_int_equal(time.ns, want ? 0 : 4000);
    assert_int_equal(vk_dispatch_series(w.vk, w.buffer, step, 2, &time, &reason), want);
    assert_int_equal(vk_dispatch_many(w.vk, w.sets, w.buffer, work, 2, &reason), want);
    assert_int_equal(fake.dispatches, want ? 0 : 5);
    vk_sets_free(w.vk, w.sets);
    vk_pipeline_free(w.vk, w.pipeline);
    vk_buffers_free(w.vk, w.buffer, 3);
    assert_int_equal(vk_close(w.vk, NULL), 0);
    must_be_clean("groups");
}

static void limits_of_dispatches_are_exact(void **state)
{
    (void)state;
    dispatch_groups(6, STATUS_OK);
    dispatch_groups(7, STATUS_LIMIT);
}

/* 64 bytes for each of 40 triangles, and for the one instance; the allocation may be as large. */
static void limits_of_acceleration_structures_are_exact(void **state)
{
    (void)state;
    struct vk_options options = fake_options();
    options.ray_query = true;
    for (int i = 0; i < 4; i++) {
        struct vk_buffer *buffer = NULL;
        struct vk_accel *accel = NULL;
        struct reason reason = {""};
        fake_reset();
        fake.device[0].most_triangles = i == 1 ? 39 : 40;
        fake.device[0].allocation = i == 3 ? 40 * FAKE_ACCEL_BYTES - 1 : 40 * FAKE_ACCEL_BYTES;
        fake.device[0].scratch_alignment = i == 2 ? 1024 : 256;
        struct vk *vk = must_open(&options);
        gpu_must(vk_buffer_make(vk, 64, &buffer, &reason), &reason);
        enum status status = vk_accel_make(vk, buffer, 3, buffer, 40, &accel, &reason);
        assert_int_equal(status, i % 2 ? STATUS_LIMIT : STATUS_OK);
        assert_int_equal(vk_accel_bytes(accel), i % 2 ? 0 : 41 * FAKE_ACCEL_BYTES);
        if (!status) {
            assert_int_equal(fake.built[0], 40);
            assert_int_equal(fake.built[1], 1);
        }
        vk_accel_free(vk, accel);
        vk_buffer_free(vk, buffer);
        must_close(vk);
    }
}

/* A world at each limit of the device, and one over it. */
static void limits_of_worlds_are_exact(void **state)
{
    (void)state;
    static const char *const over[] = {NULL, "allows 19 triangles", "allows 2 geometries",
                                       "allows 4 instances"};
    struct vk_options options = fake_options();
    options.ray_query = true;
    for (size_t i = 0; i < ARRAY_COUNT(over); i++) {
        static const struct vk_accel_geometry few[] = {{0, 1, true, NULL}};
        static const struct vk_accel_geometry three[] = {
            {0, 7, true, NULL}, {7, 0, false, NULL}, {7, 13, true, NULL}};
        struct vk_buffer *buffer = NULL;
        struct vk_accel *accel = NULL;
        struct reason reason = {""};
        fake_reset();
        fake.device[0].most_triangles = i == 1 ? 19 : 20;
        fake.device[0].most_geometries = i == 2 ? 2 : 3;
        fake.device[0].most_instances = i == 3 ? 4 : 5;
        struct vk *vk = must_open(&options);
        gpu_must(vk_buffer_make(vk, 64, &buffer, &reason), &reason);
        const struct vk_accel_mesh mesh[] = {{buffer, buffer, 3, few, 1, NULL, NULL},
                                             {buffer, buffer, 3, three, 3, NULL, NULL}};
        struct vk_accel_instance instance[5] = {{.mesh = 1}, {.mesh = VK_ACCEL_NO_MESH}};
        const struct vk_accel_world world = {
            .mesh = mesh, .instance = instance, .mesh_count = 2, .instance_count = 5};
        enum status status = vk_accel_make_world(vk, &world, &accel, &reason);
        assert_int_equal(status, i ? STATUS_LIMIT : STATUS_OK);
        assert_int_equal(vk_accel_bytes(accel), i ? 0 : (1 + 20 + 5) * FAKE_ACCEL_BYTES);
        if (over[i])
            assert_non_null(strstr(reason.text, over[i]));
        assert_int_equal(fake.builds, i ? 0 : 3);
        if (!i) {
            assert_int_equal(fake.built[0], 1);
            assert_int_equal(fake.built[1], 20);
            assert_int_equal(fake.built[2], 5);
        }
        vk_accel_free(vk, accel);
        vk_buffer_free(vk, buffer);
        must_close(vk);
    }
}

/* Ticks of two nanoseconds, of as many bits as the device has. */
static void time_is_that_of_the_devices_clock(void **state)
{
    (void)state;
    static const struct {
        uint32_t bits;
        uint64_t begin, end, want; /* want 0: the host's clock */
        bool unread;
    } cases[] = {
        {64, 10, 35, 50, false},
        {64, UINT64_MAX, 4, 10, false},
        {8, 250, 4, 20, false},
        {8, 0x1F0, 0x2FF, 30, false},
        {63, 1ull << 62, 5, 0, true},
        {1, 1, 2, 2, false},
        {36, (1ull << 36) - 1, 9, 20, false},
        {0, 10, 35, 0, false},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct vk_options options = fake_options();
        struct fake_work w = {0};
        struct reason reason = {""};
        struct vk_time time;
        static const uint32_t push[2] = {1, 2};
        fake_reset();
        fake.device[0].family[0].timestampValidBits = cases[i].bits;
        fake.ticks[0] = cases[i].begin;
        fake.ticks[1] = cases[i].end;
        fake.no_ticks = cases[i].unread;
        gpu_must(work_make(&w, &options, &reason), &reason);
        gpu_must(vk_dispatch(w.vk, w.pipeline, w.buffer, push, 1, &time, &reason), &reason);
        assert_int_equal(time.device_clock, cases[i].want > 0);
        if (cases[i].want)
            assert_int_equal(time.ns, cases[i].want);
        vk_sets_free(w.vk, w.sets);
        vk_pipeline_free(w.vk, w.pipeline);
        vk_buffers_free(w.vk, w.buffer, 3);
        assert_int_equal(vk_close(w.vk, NULL), 0);
        must_be_clean("clocks");
    }
}

/* Warnings and errors count; what the layer remarks about its own checks does not, unless it is an
 * error. */
static void messages_are_counted_but_for_remarks(void **state)
{
    (void)state;
    enum {
        WARNING = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT,
        ERROR = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT
    };
    static const struct {
        int severity;
        const char *name, *text;
        uint32_t count; /* so far */
    } said[] = {
        {WARNING, "UNASSIGNED-GPU-Assisted Validation Warning",
         "... No buffer device address checking", 0},
        {WARNING, "VALIDATION-SETTINGS",
         "Both GPU Assisted Validation and Normal Core Check Validation are enabled, x", 0},
        {WARNING, "WARNING-GPU-Assisted-Validation", "Internal Warning: Forcing x", 0},
        {WARNING, "WARNING-GPU-Assisted-Validation", "Internal Warning: Adding x", 0},
        {WARNING, "WARNING-GPU-Assisted-Validation", "[Disabling gpuav_validate_ray_query] x", 0},
        {WARNING, "VALIDATION-SETTINGS", "first", 1},
        {WARNING, "other", "Internal Warning: Adding x", 2},
        {WARNING, NULL, "Internal Warning: Adding x", 3},
        {ERROR, "WARNING-GPU-Assisted-Validation", "Internal Warning: Adding x", 4},
    };
    struct vk_options options = fake_options();
    struct reason reason = {"none"};
    struct vk *vk;
    options.validate = true;
    fake_reset();
    fake.layer = "VK_LAYER_KHRONOS_validation";
    gpu_must(vk_open(&options, &vk, &reason), &reason);
    assert_int_equal(fake.messenger.messageSeverity, WARNING | ERROR);
    assert_int_equal(fake.messenger.messageType,
                     VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                         VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT);
    for (size_t i = 0; i < ARRAY_COUNT(said); i++) {
        const VkDebugUtilsMessengerCallbackDataEXT data = {.pMessageIdName = said[i].name,
                                                           .pMessage = said[i].text};
        assert_int_equal(
            fake.messenger.pfnUserCallback((VkDebugUtilsMessageSeverityFlagBitsEXT)said[i].severity,
                                           0, &data, fake.messenger.pUserData),
            VK_FALSE);
        assert_int_equal(vk_messages(vk, &reason), said[i].count);
        assert_string_equal(reason.text, said[i].count ? "vulkan validation: first" : "none");
    }
    assert_int_equal(vk_close(vk, &reason), 4);
    must_be_clean("messages");
    fake_reset();
    assert_int_equal(vk_open(&options, &vk, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "VK_LAYER_KHRONOS_validation is not installed"));
    fake_reset();
    fake.layer = "VK_LAYER_KHRONOS_validatio";
    assert_int_equal(vk_open(&options, &vk, &reason), STATUS_UNSUPPORTED);
}

typedef enum status play_fn(const struct engine *engine, const struct fake_stage *s,
                            struct reason *reason);

static void fail_each_call(const struct engine *engine, play_fn *play, const struct fake_stage *s)
{
    static const struct {
        VkResult result;
        enum status status;
    } ways[] = {{VK_ERROR_OUT_OF_DEVICE_MEMORY, STATUS_MEMORY},
                {VK_ERROR_DEVICE_LOST, STATUS_DEVICE},
                {VK_ERROR_UNKNOWN, STATUS_DEVICE}};
    struct reason reason;
    for (int shared = 0; shared < 2; shared++) {
        uint32_t calls = 0;
        for (uint32_t at = 0; at <= calls; at++)
            for (size_t way = 0; way < ARRAY_COUNT(ways); way++) {
                fake_reset();
                fake.run = all_done;
                fake.fail_at = at;
                fake.result = ways[way].result;
                if (!shared)
                    fake.device[0].base.deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
                enum status status = play(engine, s, &reason);
                must_be_clean(fake.failed ? fake.failed : engine->name);
                calls = at ? calls : fake.calls;
                if (at == 0)
                    gpu_must(status, &reason);
                else if (strcmp(fake.failed, "vkEnumerateDeviceExtensionProperties") == 0)
                    assert_int_equal(status, STATUS_UNSUPPORTED);
                else if (status != ways[way].status || !reason.text[0])
                    fail_msg("%s: call %u of %u, %s: status %d, '%s'", engine->name, at, calls,
                             fake.failed, (int)status, reason.text);
            }
    }
}

/* With mapped and with copied memory. */
static void every_call_of_an_engine_that_fails_is_a_status(void **state)
{
    (void)state;
    struct fake_stage s = stage_make();
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    for (size_t i = 0; i < ARRAY_COUNT(engine_names); i++)
        fail_each_call(engine_find(engine_names[i]), engine_play, &s);
    for (size_t i = 0; i < ARRAY_COUNT(world_names); i++)
        fail_each_call(engine_find(world_names[i]), world_play, &s);
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    stage_free(&s);
}

static uint32_t left_out;

/* One ray is not done, and says why. */
static void all_but_one(const struct fake_dispatch *dispatch)
{
    all_done(dispatch);
    const struct fake_part *flags = &dispatch->part[ABI_BIND_FLAGS];
    memcpy(flags->byte + flags->offset + 4 * left_out, &(uint32_t){ABI_FLAG_LOOP}, 4);
}

static void assert_named(const char *name, play_fn *play, const struct fake_stage *s)
{
    for (left_out = 0; left_out < RAYS; left_out++) {
        struct reason reason;
        char text[64];
        fake_reset();
        fake.run = all_but_one;
        assert_int_equal(play(engine_find(name), s, &reason), STATUS_DEVICE);
        (void)snprintf(text, sizeof text, "ray %u was not finished: the driver ended its loop",
                       left_out);
        if (!strstr(reason.text, text))
            fail_msg("%s: '%s' is not '%s'", name, reason.text, text);
        must_be_clean(name);
    }
}

/* Of each ray, the first and the last ones included. */
static void ray_that_is_not_done_is_named(void **state)
{
    (void)state;
    struct fake_stage s = stage_make();
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    for (size_t i = 0; i < ARRAY_COUNT(engine_names); i++)
        assert_named(engine_names[i], engine_play, &s);
    for (size_t i = 0; i < ARRAY_COUNT(world_names); i++)
        assert_named(world_names[i], world_play, &s);
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    stage_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(limits_of_pipelines_are_exact),
        cmocka_unit_test(limits_of_dispatches_are_exact),
        cmocka_unit_test(limits_of_acceleration_structures_are_exact),
        cmocka_unit_test(limits_of_worlds_are_exact),
        cmocka_unit_test(time_is_that_of_the_devices_clock),
        cmocka_unit_test(messages_are_counted_but_for_remarks),
        cmocka_unit_test(every_call_of_an_engine_that_fails_is_a_status),
        cmocka_unit_test(ray_that_is_not_done_is_named),
    };
    assert_int_equal(unsetenv("RAYDIFF_VALIDATE"), 0); /* the layer is for drivers */
    return cmocka_run_group_tests(tests, NULL, NULL);
}
