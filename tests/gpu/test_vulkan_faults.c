/* Every call to Vulkan fails in turn, and every entry point is missing in turn: a status with a
 * reason comes of it, and nothing is left behind (tests/gpu/fake_vulkan.h). */
#include "tests/gpu/fake_work.h"

/* All of it once; what was made is freed. */
static enum status play(const struct vk_options *options, struct reason *reason)
{
    struct fake_work w = {0};
    *reason = (struct reason){""};
    enum status status = work_make(&w, options, reason);
    if (!status)
        status = work_use(&w, reason);
    if (!w.vk) {
        assert_int_not_equal(status, STATUS_OK);
        return status;
    }
    vk_accel_free(w.vk, w.accel);
    vk_sets_free(w.vk, w.sets);
    vk_pipeline_free(w.vk, w.query);
    vk_pipeline_free(w.vk, w.pipeline);
    vk_buffers_free(w.vk, w.buffer, 3);
    for (int i = 0; i < 3; i++)
        assert_null(w.buffer[i]);
    assert_int_equal(vk_close(w.vk, NULL), 0);
    return status;
}

/* The options that lead to different calls. */
static const struct {
    bool staging, ray_query, validate, watch;
} kinds[] = {{0}, {.staging = true}, {.ray_query = true}, {.validate = true}, {.watch = true}};

static struct vk_options kind_reset(size_t kind)
{
    struct vk_options options = fake_options();
    options.staging = kinds[kind].staging;
    options.ray_query = kinds[kind].ray_query;
    options.validate = kinds[kind].validate;
    options.watch = kinds[kind].watch;
    fake_reset();
    fake.layer = options.validate || options.watch ? "VK_LAYER_KHRONOS_validation" : NULL;
    return options;
}

static void healthy_device_does_all_and_nothing_is_left(void **state)
{
    (void)state;
    struct reason reason;
    for (size_t kind = 0; kind < ARRAY_COUNT(kinds); kind++) {
        struct vk_options options = kind_reset(kind);
        gpu_must(play(&options, &reason), &reason);
        must_be_clean("a healthy device");
        assert_int_equal(fake.dispatches, 5);
        assert_int_equal(fake.builds, options.ray_query ? 2 : 0);
        assert_int_equal(fake.robust, !options.watch);
        assert_int_equal(fake.checks, options.watch);
        assert_int_equal(fake.races, options.validate && !options.watch);
        assert_int_equal(fake.extensions, options.ray_query ? 3 : 0);
        assert_int_equal(fake.idles > 0, options.watch);
    }
}

/* Groups, constants, push constants and parts of each dispatch as they were given. */
static void dispatches_are_recorded_as_given(void **state)
{
    (void)state;
    static const uint32_t groups[] = {2, 3, UINT32_MAX, 5, 6};
    static const uint64_t part[5][4] = {
        {0, 32, 0, 32}, {0, 32, 0, 32}, {0, 32, 0, 32}, {0, 16, 16, 16}, {16, 8, 0, 32}};
    struct vk_options options = kind_reset(0);
    struct reason reason;
    gpu_must(play(&options, &reason), &reason);
    for (size_t i = 0; i < ARRAY_COUNT(groups); i++) {
        const struct fake_dispatch *it = &fake.log[i];
        assert_int_equal(it->groups, groups[i]);
        assert_int_equal(it->at, i == 2 ? 4 : 0);
        assert_int_equal(it->constants, 3);
        assert_memory_equal(it->constant, work_constant, sizeof work_constant);
        assert_int_equal(it->push_bytes, 8);
        assert_int_equal(it->push[0], 11);
        assert_int_equal(it->push[1], 12);
        for (int b = 0; b < 2; b++) {
            assert_int_equal(it->part[b].offset, part[i][2 * b]);
            assert_int_equal(it->part[b].bytes, part[i][2 * b + 1]);
        }
        assert_null(it->part[2].byte);
    }
    assert_int_equal(fake.updates, 1);
}

/* The last command buffer, and its barriers. */
static void must_record(const char *commands, const uint32_t (*barrier)[4], uint32_t barriers)
{
    assert_string_equal(fake.recorded, commands);
    assert_int_equal(fake.barriers, barriers);
    for (uint32_t i = 0; i < barriers; i++)
        for (int k = 0; k < 4; k++)
            assert_int_equal(fake.barrier[i][k], barrier[i][k]);
}

/* What one command writes, others see: shaders after shaders, after updates and after copies, the
 * host after all of them. */
static void commands_are_recorded_in_order(void **state)
{
    (void)state;
    enum {
        C = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
        T = VK_PIPELINE_STAGE_TRANSFER_BIT,
        H = VK_PIPELINE_STAGE_HOST_BIT,
        I = VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
        SW = VK_ACCESS_SHADER_WRITE_BIT,
        SR = VK_ACCESS_SHADER_READ_BIT,
        TW = VK_ACCESS_TRANSFER_WRITE_BIT,
        TR = VK_ACCESS_TRANSFER_READ_BIT,
        HR = VK_ACCESS_HOST_READ_BIT,
        IR = VK_ACCESS_INDIRECT_COMMAND_READ_BIT
    };
    static const uint32_t push[2] = {1, 2}, read[1][4] = {{C, H | T, SW, HR | TR}};
    static const uint32_t copy[1][4] = {{T, H | C, TW, HR | SR}};
    static const uint32_t series[3][4] = {{C, C | I | T, SW, SR | SW | IR | TW},
                                          {T, C | I, TW, SR | SW | IR},
                                          {C, H | T, SW, HR | TR}};
    struct vk_options options = fake_options();
    struct reason reason = {""};
    struct fake_work w = {0};
    struct vk_time time;
    fake_reset();
    options.staging = true;
    gpu_must(work_make(&w, &options, &reason), &reason);
    must_record("cb", copy, 1);
    gpu_must(vk_dispatch(w.vk, w.pipeline, w.buffer, push, 1, &time, &reason), &reason);
    must_record("rtpskdtb", read, 1);
    const struct vk_step step[] = {{.pipeline = w.pipeline, .push = push, .groups = 1},
                                   {.pipeline = w.pipeline,
                                    .push = push,
                                    .groups_of = w.buffer[2],
                                    .update = w.buffer[2],
                                    .bytes = push,
                                    .byte_count = 8}};
    gpu_must(vk_dispatch_series(w.vk, w.buffer, step, 2, &time, &reason), &reason);
    must_record("rtpskdbubpskitb", series, 3);
    const struct vk_work work[] = {
        {.pipeline = w.pipeline, .part = {{0, 16}, {0, 16}}, .push = push, .groups = 1},
        {.pipeline = w.pipeline, .part = {{0, 16}, {0, 16}}, .push = push, .groups = 1}};
    gpu_must(vk_dispatch_many(w.vk, w.sets, w.buffer, work, 2, &reason), &reason);
    must_record("pskdskdb", read, 1);
    vk_sets_free(w.vk, w.sets);
    vk_pipeline_free(w.vk, w.pipeline);
    vk_buffers_free(w.vk, w.buffer, 3);
    must_close(w.vk);
}

/* A device whose extensions cannot be listed has none. */
static bool may_fail(const char *name)
{
    return strcmp(name, "vkEnumerateDeviceExtensionProperties") == 0;
}

/* A reason names the call, or what the call was for. */
static bool names(const char *reason, const char *call)
{
    static const char *const work[] = {"a dispatch", "a series of dispatches", "many dispatches",
                                       "copying a buffer", "building an acceleration structure"};
    if (strcmp(call, "vkCreateShaderModule") == 0 || strcmp(call, "vkCreateComputePipelines") == 0)
        return strstr(reason, "probe_abi: ") != NULL;
    if (strcmp(call, "vkWaitForFences") != 0 && strcmp(call, "vkDeviceWaitIdle") != 0)
        return strstr(reason, call) != NULL;
    for (size_t i = 0; i < ARRAY_COUNT(work); i++)
        if (strncmp(reason, "vulkan: ", 8) == 0 &&
            strncmp(reason + 8, work[i], strlen(work[i])) == 0)
            return true;
    return false;
}

static void every_call_that_fails_is_a_status_with_its_reason(void **state)
{
    (void)state;
    static const struct {
        VkResult result;
        enum status status;
        const char *text;
    } ways[] = {
        {VK_ERROR_OUT_OF_HOST_MEMORY, STATUS_MEMORY, "out of host memory"},
        {VK_ERROR_OUT_OF_DEVICE_MEMORY, STATUS_MEMORY, "out of device memory"},
        {VK_ERROR_INITIALIZATION_FAILED, STATUS_DEVICE, "initialization failed"},
        {VK_ERROR_DEVICE_LOST, STATUS_DEVICE, "device lost"},
        {VK_ERROR_MEMORY_MAP_FAILED, STATUS_DEVICE, "memory cannot be mapped"},
        {VK_ERROR_LAYER_NOT_PRESENT, STATUS_DEVICE, "layer not present"},
        {VK_ERROR_EXTENSION_NOT_PRESENT, STATUS_DEVICE, "extension not present"},
        {VK_ERROR_FEATURE_NOT_PRESENT, STATUS_DEVICE, "feature not present"},
        {VK_ERROR_TOO_MANY_OBJECTS, STATUS_DEVICE, "too many objects"},
        {VK_ERROR_UNKNOWN, STATUS_DEVICE, "failed"},
    };
    struct reason reason;
    for (size_t kind = 0; kind < ARRAY_COUNT(kinds); kind++) {
        struct vk_options options = kind_reset(kind);
        gpu_must(play(&options, &reason), &reason);
        const uint32_t calls = fake.calls;
        assert_true(calls > 20);
        for (uint32_t at = 1; at <= calls; at++)
            for (size_t way = 0; way < ARRAY_COUNT(ways); way++) {
                (void)kind_reset(kind);
                fake.fail_at = at;
                fake.result = ways[way].result;
                enum status status = play(&options, &reason);
                assert_non_null(fake.failed);
                must_be_clean(fake.failed);
                if (may_fail(fake.failed))
                    continue;
                char number[32];
                (void)snprintf(number, sizeof number, "%s (VkResult %d)", ways[way].text,
                               (int)ways[way].result);
                if (status != ways[way].status || !strstr(reason.text, number) ||
                    !names(reason.text, fake.failed))
                    fail_msg("%s, call %u, %s: status %d, '%s'", fake.failed, at, number,
                             (int)status, reason.text);
            }
    }
}

static void extensions_that_cannot_be_listed_are_none(void **state)
{
    (void)state;
    struct reason reason;
    struct vk_options options = kind_reset(2);
    fake.fail_name = "vkEnumerateDeviceExtensionProperties";
    fake.result = VK_ERROR_OUT_OF_HOST_MEMORY;
    assert_int_equal(play(&options, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "VK_KHR_ray_query"));
    must_be_clean("no extensions");
}

/* A part of a list is a list. */
static void lists_may_be_incomplete(void **state)
{
    (void)state;
    struct reason reason;
    for (int i = 0; i < 2; i++) {
        struct vk_options options = kind_reset(3);
        fake.fail_name = i ? "vkEnumerateInstanceLayerProperties" : "vkEnumeratePhysicalDevices";
        fake.result = VK_INCOMPLETE;
        gpu_must(play(&options, &reason), &reason);
        must_be_clean("an incomplete list");
    }
    struct vk_options options = kind_reset(3);
    fake.fail_name = "vkCreateInstance";
    fake.result = VK_ERROR_INCOMPATIBLE_DRIVER;
    assert_int_equal(play(&options, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "no driver"));
    must_be_clean("no driver");
}

/* The k-th entry point of a device. */
static const char *entry_name(size_t k)
{
    if (k < fake_device_entries)
        return fake_device_entry[k].name;
    k -= fake_device_entries;
    return k < fake_command_entries ? fake_command_entry[k].name
                                    : fake_set_entry[k - fake_command_entries].name;
}

/* Entry points of the loader, the instance and the device. vkDestroyDevice has no substitute. */
static void every_entry_point_that_is_missing_is_named(void **state)
{
    (void)state;
    static const char *const early[] = {"vkEnumerateInstanceVersion",
                                        "vkEnumerateInstanceLayerProperties",
                                        "vkEnumerateInstanceExtensionProperties",
                                        "vkCreateInstance",
                                        "vkEnumeratePhysicalDevices",
                                        "vkGetPhysicalDeviceProperties",
                                        "vkGetPhysicalDeviceProperties2",
                                        "vkGetPhysicalDeviceFeatures2",
                                        "vkGetPhysicalDeviceFormatProperties",
                                        "vkGetPhysicalDeviceMemoryProperties",
                                        "vkGetPhysicalDeviceQueueFamilyProperties",
                                        "vkEnumerateDeviceExtensionProperties",
                                        "vkCreateDevice",
                                        "vkGetDeviceProcAddr",
                                        "vkCreateDebugUtilsMessengerEXT",
                                        "vkDestroyDebugUtilsMessengerEXT"};
    struct reason reason;
    const size_t all =
        ARRAY_COUNT(early) + fake_device_entries + fake_command_entries + fake_set_entries;
    for (size_t kind = 2; kind < 5; kind++)
        for (size_t i = 0; i < all; i++) {
            size_t k = i - ARRAY_COUNT(early);
            const char *name = i < ARRAY_COUNT(early) ? early[i] : entry_name(k);
            const bool debug = strstr(name, "DebugUtils");
            const bool ray = strstr(name, "KHR") || strstr(name, "FormatProperties");
            const bool address = strcmp(name, "vkGetBufferDeviceAddress") == 0;
            if ((debug && kind == 2) || ((ray || address) && kind > 2))
                continue; /* not needed */
            struct vk_options options = kind_reset(kind);
            options.ray_more.lives = options.ray_query;
            fake.missing = name;
            char text[96];
            (void)snprintf(text, sizeof text, "the loader or driver lacks %s", name);
            if (play(&options, &reason) != STATUS_UNSUPPORTED || !strstr(reason.text, text))
                fail_msg("without %s: '%s'", name, reason.text);
            if (strcmp(name, "vkDestroyDevice") == 0)
                fake_drop(fake.opened, FAKE_DEVICE);
            else
                must_be_clean(name);
        }
}

/* What is not needed may be missing. */
static void entry_points_for_other_options_may_be_missing(void **state)
{
    (void)state;
    static const char *const spare[] = {"vkCreateDebugUtilsMessengerEXT",
                                        "vkGetBufferDeviceAddress",
                                        "vkCmdBuildAccelerationStructuresKHR"};
    struct reason reason;
    for (size_t i = 0; i < ARRAY_COUNT(spare); i++) {
        struct vk_options options = kind_reset(0);
        fake.missing = spare[i];
        gpu_must(play(&options, &reason), &reason);
        must_be_clean(spare[i]);
    }
}

/* One that ends within the time of grace leaves nothing behind, another one all. */
static void device_that_hangs_is_given_up(void **state)
{
    (void)state;
    static struct fake_work kept;
    struct reason reason;
    for (uint32_t vain = 1; vain <= 2; vain++) {
        struct fake_work w = {0};
        struct vk_options options = kind_reset(0);
        options.wait_ns = vain == 1 ? 0 : 1500000000;
        gpu_must(work_make(&w, &options, &reason), &reason);
        fake.waits_in_vain = vain;
        assert_int_equal(work_use(&w, &reason), STATUS_DEVICE);
        assert_non_null(strstr(reason.text, vain == 1 ? "a dispatch on fake device hangs: not done "
                                                        "after 60.000 s"
                                                      : "not done after 1.500 s"));
        assert_int_equal(work_use(&w, &reason), STATUS_DEVICE);
        assert_non_null(strstr(reason.text, "lost or hung before"));
        const long destroyed = fake.destroyed;
        vk_sets_free(w.vk, w.sets);
        vk_pipeline_free(w.vk, w.pipeline);
        for (int i = 0; i < 3; i++)
            vk_buffer_free(w.vk, w.buffer[i]);
        assert_int_equal(vk_close(w.vk, &reason), 0);
        assert_int_equal(fake.waited[0], 10000000000u); /* once */
        assert_int_equal(fake.waited[1], vain == 1 ? 60000000000u : 1500000000u);
        assert_int_equal(fake.waited[2], 0);
        if (vain == 1)
            must_be_clean("a device that hung");
        else
            assert_int_equal(fake.destroyed, destroyed);
        kept = w; /* what is lost on purpose */
    }
    assert_non_null(kept.vk);
}

static void device_that_was_lost_is_given_up(void **state)
{
    (void)state;
    struct fake_work w = {0};
    struct reason reason;
    struct vk_options options = kind_reset(1);
    gpu_must(work_make(&w, &options, &reason), &reason);
    fake.fail_name = "vkQueueSubmit";
    fake.result = VK_ERROR_DEVICE_LOST;
    assert_int_equal(work_use(&w, &reason), STATUS_DEVICE);
    fake.fail_name = NULL;
    assert_int_equal(work_use(&w, &reason), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "lost or hung before"));
    vk_sets_free(w.vk, w.sets);
    vk_pipeline_free(w.vk, w.pipeline);
    vk_buffers_free(w.vk, w.buffer, 3);
    assert_int_equal(vk_close(w.vk, &reason), 0);
    must_be_clean("a device that was lost");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(healthy_device_does_all_and_nothing_is_left),
        cmocka_unit_test(dispatches_are_recorded_as_given),
        cmocka_unit_test(commands_are_recorded_in_order),
        cmocka_unit_test(every_call_that_fails_is_a_status_with_its_reason),
        cmocka_unit_test(extensions_that_cannot_be_listed_are_none),
        cmocka_unit_test(lists_may_be_incomplete),
        cmocka_unit_test(every_entry_point_that_is_missing_is_named),
        cmocka_unit_test(entry_points_for_other_options_may_be_missing),
        cmocka_unit_test(device_that_hangs_is_given_up),
        cmocka_unit_test(device_that_was_lost_is_given_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
