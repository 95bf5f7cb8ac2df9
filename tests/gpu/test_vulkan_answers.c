/* What a device answers, and what comes of it, by value: which device and queue family is chosen,
 * limits, memory, timestamps, messages (tests/gpu/fake_vulkan.h). */
#include "tests/gpu/fake_work.h"

/* Opens the device anew and returns its limits. */
static struct vk_limits limits_now(void)
{
    struct vk_options options = fake_options();
    struct vk *vk = must_open(&options);
    struct vk_limits limits = *vk_limits(vk);
    must_close(vk);
    return limits;
}

static void limits_are_those_of_the_device(void **state)
{
    (void)state;
    fake_reset();
    struct fake_device *device = &fake.device[0];
    device->base.limits.maxComputeWorkGroupCount[1] = 7;
    device->base.limits.maxComputeWorkGroupCount[2] = 8;
    struct vk_limits limits = limits_now();
    assert_string_equal(limits.device, "fake device");
    assert_string_equal(limits.driver, "fake driver 1.2");
    assert_int_equal(limits.api_version, VK_API_VERSION_1_3);
    assert_int_equal(limits.buffer_bytes, 1u << 26);
    assert_int_equal(limits.groups, 65535);
    assert_int_equal(limits.group_size, 1024);
    assert_int_equal(limits.bindings, 8);
    assert_int_equal(limits.alignment, 16);
    assert_int_equal(limits.timestamp_bits, 64);
    assert_true(limits.timestamp_ns == 2);
    assert_true(limits.software && limits.shared_memory);
    assert_false(limits.round_to_nearest || limits.keeps_denormals || limits.keeps_inf_nan);
}

/* A workgroup has two limits, a buffer as well. */
static void the_smaller_of_two_limits_counts(void **state)
{
    (void)state;
    static const uint32_t most[][3] = {{512, 1024, 512}, {1024, 512, 512}, {511, 512, 511}};
    for (size_t i = 0; i < ARRAY_COUNT(most); i++) {
        fake_reset();
        fake.device[0].base.limits.maxComputeWorkGroupSize[0] = most[i][0];
        fake.device[0].base.limits.maxComputeWorkGroupInvocations = most[i][1];
        assert_int_equal(limits_now().group_size, most[i][2]);
    }
    static const uint64_t bytes[][2] = {
        {0, 1u << 26}, {1000, 1000}, {(1u << 26) - 1, (1u << 26) - 1}, {1u << 27, 1u << 26}};
    for (size_t i = 0; i < ARRAY_COUNT(bytes); i++) {
        fake_reset();
        fake.device[0].allocation = bytes[i][0];
        assert_int_equal(limits_now().buffer_bytes, bytes[i][1]);
    }
}

static void promises_of_floats_are_told_apart(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        fake_reset();
        fake.device[0].nearest = i == 0;
        fake.device[0].denormals = i == 1;
        fake.device[0].inf_nan = i == 2;
        struct vk_limits limits = limits_now();
        assert_int_equal(limits.round_to_nearest, i == 0);
        assert_int_equal(limits.keeps_denormals, i == 1);
        assert_int_equal(limits.keeps_inf_nan, i == 2);
        struct vk_options options = fake_options();
        char text[1024];
        vk_describe(&options, text, sizeof text);
        must_be_clean("a description");
        char wanted[256];
        (void)snprintf(wanted, sizeof wanted,
                       "0: fake device (fake driver 1.2)\n    Vulkan 1.3, buffers to 64 MiB, "
                       "workgroups to 1024, timestamps yes\n    f32: round to nearest %s, "
                       "denormals %s, inf and NaN %s\n",
                       i == 0 ? "promised" : "not promised", i == 1 ? "kept" : "not promised",
                       i == 2 ? "kept" : "not promised");
        assert_string_equal(text, wanted);
    }
}

/* Before Vulkan 1.2 driver and floats need an extension each. */
static void older_devices_are_asked_by_extension(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        fake_reset();
        struct fake_device *device = &fake.device[0];
        device->base.apiVersion = VK_API_VERSION_1_1;
        device->base.driverVersion = 0xBEEF;
        device->nearest = true;
        device->extension_count = 0;
        if (i & 1)
            device->extension[device->extension_count++] = VK_KHR_DRIVER_PROPERTIES_EXTENSION_NAME;
        if (i & 2)
            device->extension[device->extension_count++] =
                VK_KHR_SHADER_FLOAT_CONTROLS_EXTENSION_NAME;
        struct vk_limits limits = limits_now();
        assert_string_equal(limits.driver, i & 1 ? "fake driver 1.2" : "driver version 0xbeef");
        assert_int_equal(limits.round_to_nearest, (i & 2) != 0);
        assert_int_equal(limits.buffer_bytes, 1u << 26);
    }
    fake_reset();
    fake.device[0].driver_info = "";
    assert_string_equal(limits_now().driver, "fake driver");
}

static void devices_and_loaders_before_1_1_are_refused(void **state)
{
    (void)state;
    struct vk_options options = fake_options();
    struct reason reason = {""};
    struct vk *vk;
    fake_reset();
    fake.device[0].base.apiVersion = VK_API_VERSION_1_1 - 1;
    assert_int_equal(vk_open(&options, &vk, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "1.1 compute"));
    must_be_clean("an old device");
    fake_reset();
    fake.version = VK_API_VERSION_1_1 - 1;
    assert_int_equal(vk_open(&options, &vk, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "loader is older"));
    must_be_clean("an old loader");
    static const uint32_t asked[][2] = {{VK_API_VERSION_1_1, VK_API_VERSION_1_1},
                                        {VK_API_VERSION_1_2 - 1, VK_API_VERSION_1_1},
                                        {VK_API_VERSION_1_2, VK_API_VERSION_1_2},
                                        {VK_API_VERSION_1_3, VK_API_VERSION_1_2}};
    for (size_t i = 0; i < ARRAY_COUNT(asked); i++) {
        fake_reset();
        fake.version = asked[i][0];
        must_close(must_open(&options));
        assert_int_equal(fake.api, asked[i][1]);
    }
}

/* Of those that compute and have queues the first with the most bits. */
static void queue_family_with_the_best_clock_is_taken(void **state)
{
    (void)state;
    enum { C = VK_QUEUE_COMPUTE_BIT, G = VK_QUEUE_GRAPHICS_BIT };
    static const struct {
        uint32_t flags[3], queues[3], bits[3], family, want;
    } cases[] = {
        {{C, C, C}, {1, 1, 1}, {36, 64, 64}, 1, 64}, {{C, C, C}, {1, 1, 1}, {36, 36, 35}, 0, 36},
        {{G, C, C}, {1, 1, 1}, {64, 0, 0}, 1, 0},    {{C, C, C}, {0, 0, 2}, {64, 64, 1}, 2, 1},
        {{C, G, C}, {1, 1, 1}, {1, 64, 2}, 2, 2},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        fake_reset();
        fake.device[0].family_count = 3;
        for (int f = 0; f < 3; f++)
            fake.device[0].family[f] = (VkQueueFamilyProperties){
                cases[i].flags[f], cases[i].queues[f], cases[i].bits[f], {1, 1, 1}};
        assert_int_equal(limits_now().timestamp_bits, cases[i].want);
        assert_int_equal(fake.family, cases[i].family);
    }
    fake_reset();
    fake.device[0].family[0].queueFlags = G;
    struct vk_options options = fake_options();
    struct reason reason = {""};
    struct vk *vk;
    char text[512];
    assert_int_equal(vk_open(&options, &vk, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "0: fake device (fake driver 1.2), cannot compute"));
    vk_describe(&options, text, sizeof text);
    assert_non_null(strstr(text, "timestamps no (the host's clock is used)"));
    must_be_clean("no compute");
}

/* Three devices, told apart by their names; the second is hardware. */
static void three_devices(void)
{
    fake_reset();
    fake.devices = 3;
    for (uint32_t i = 0; i < 3; i++)
        (void)snprintf(fake.device[i].base.deviceName, 16, "device %u", i);
    fake.device[1].base.deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
    fake.device[2].driver_name = "Another Driver";
}

static void device_is_chosen_by_index_name_and_kind(void **state)
{
    (void)state;
    static const struct {
        int index;
        const char *driver, *want; /* NULL: none matches */
    } cases[] = {
        {-1, NULL, "device 0"},
        {0, NULL, "device 0"},
        {1, NULL, "device 1"},
        {2, NULL, "device 2"},
        {3, NULL, NULL},
        {-1, "hardware", "device 1"},
        {-1, "DEVICE 2", "device 2"},
        {-1, "another", "device 2"},
        {0, "another", NULL},
        {2, "fake", NULL},
        {-1, "1.2", "device 0"},
        {-1, "device 22", NULL},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct vk_options options = fake_options();
        struct reason reason = {""};
        struct vk *vk;
        options.device = cases[i].index;
        options.driver = cases[i].driver;
        three_devices();
        enum status status = vk_open(&options, &vk, &reason);
        if (cases[i].want) {
            gpu_must(status, &reason);
            assert_string_equal(vk_limits(vk)->device, cases[i].want);
            assert_string_equal(fake.chosen->base.deviceName, cases[i].want);
            assert_int_equal(vk_close(vk, NULL), 0);
        } else {
            assert_int_equal(status, STATUS_UNSUPPORTED);
            assert_non_null(strstr(reason.text, "0: device 0 (fake driver 1.2); 1: device 1 "));
        }
        must_be_clean("a choice");
    }
    fake_reset();
    fake.devices = 0;
    struct vk_options options = fake_options();
    struct reason reason = {""};
    struct vk *vk;
    assert_int_equal(vk_open(&options, &vk, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "driver 'any', index any; there is: none"));
    must_be_clean("no device");
}

/* Each of the extensions and features is needed, and Vulkan 1.2. */
static void ray_queries_need_all_their_parts(void **state)
{
    (void)state;
    struct vk_options options = fake_options();
    options.ray_query = true;
    for (int i = 0; i < 8; i++) {
        struct reason reason = {""};
        struct vk *vk;
        fake_reset();
        struct fake_device *device = &fake.device[0];
        if (i > 0 && i <= 3)
            device->extension[i - 1] = "VK_other";
        device->has_address = i != 4;
        device->has_accel = i != 5;
        device->has_query = i != 6;
        device->base.apiVersion = i == 7 ? VK_API_VERSION_1_2 - 1 : VK_API_VERSION_1_2;
        enum status status = vk_open(&options, &vk, &reason);
        assert_int_equal(status, i ? STATUS_UNSUPPORTED : STATUS_OK);
        if (!status)
            assert_int_equal(vk_close(vk, NULL), 0);
        must_be_clean("ray queries");
    }
}

/* Integrated devices share memory as well, unless copies are asked for. */
static void memory_is_shared_by_the_kind_of_device(void **state)
{
    (void)state;
    static const VkPhysicalDeviceType type[] = {
        VK_PHYSICAL_DEVICE_TYPE_OTHER, VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
        VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU,
        VK_PHYSICAL_DEVICE_TYPE_CPU};
    for (int i = 0; i < 5; i++) {
        fake_reset();
        fake.device[0].base.deviceType = type[i];
        struct vk_limits limits = limits_now();
        assert_int_equal(limits.software, i == 4);
        assert_int_equal(limits.shared_memory, i == 1 || i == 4);
    }
}

/* Of the host's the first coherent and cached one that is allowed, else the first coherent one; of
 * the device's the first local one, else the first. */
static void memory_type_is_the_best_allowed(void **state)
{
    (void)state;
    enum {
        L = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
        V = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT,
        H = V | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
        K = H | VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
        NONE = 99
    };
    static const struct {
        uint32_t flags[4], allowed;
        bool staging;
        uint32_t want;
    } cases[] = {
        {{L, V, H, K}, 15, false, 3},  {{L, V, H, K}, 7, false, 2},
        {{L, H, K, K}, 15, false, 2},  {{L, V, V, L}, 15, false, NONE},
        {{H, V, H, L}, 15, true, 3},   {{H, V, H, V}, 14, true, 1},
        {{L, H, L, L}, 12, true, 2},   {{K, H, H, H}, 15, false, 0},
        {{L, L, L, L}, 0, true, NONE},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct vk_options options = fake_options();
        struct reason reason = {""};
        struct vk_buffer *buffer = NULL;
        options.staging = cases[i].staging;
        fake_reset();
        fake.device[0].memory.memoryTypeCount = 4;
        fake.device[0].memory_types = cases[i].allowed;
        for (int k = 0; k < 4; k++)
            fake.device[0].memory.memoryTypes[k] = (VkMemoryType){cases[i].flags[k], 0};
        struct vk *vk = must_open(&options);
        enum status status = vk_buffer_make(vk, 20, &buffer, &reason);
        assert_int_equal(status, cases[i].want == NONE ? STATUS_DEVICE : STATUS_OK);
        if (status)
            assert_non_null(strstr(reason.text, "no memory type"));
        else
            assert_int_equal(fake.memory_type[0], cases[i].want);
        vk_buffer_free(vk, buffer);
        must_close(vk);
    }
}

/* Of limits the number itself is allowed, one more is not; a buffer has 16 bytes at least. */
static void limits_of_buffers_are_exact(void **state)
{
    (void)state;
    struct vk_options options = fake_options();
    struct reason reason = {""};
    for (int i = 0; i < 4; i++) {
        const uint64_t bytes = i < 2 ? 5000 + (uint64_t)i : 3000 + (uint64_t)(i - 2);
        struct vk_buffer *buffer;
        fake_reset();
        fake.device[0].base.limits.maxStorageBufferRange = 5000;
        fake.device[0].memory.memoryHeaps[0].size = i < 2 ? 1u << 20 : 3000;
        struct vk *vk = must_open(&options);
        assert_int_equal(vk_buffer_make(vk, bytes, &buffer, &reason), i % 2 ? STATUS_LIMIT : 0);
        assert_int_equal(vk_buffer_bytes(buffer), i % 2 ? 0 : bytes);
        vk_buffer_free(vk, buffer);
        must_close(vk);
    }
    fake_reset();
    struct vk *vk = must_open(&options);
    for (uint64_t bytes = 0; bytes < 20; bytes++) {
        struct vk_buffer *buffer;
        gpu_must(vk_buffer_make(vk, bytes, &buffer, &reason), &reason);
        assert_int_equal(vk_buffer_bytes(buffer), bytes < 16 ? 16 : bytes);
        const struct vk_buffer *before = buffer;
        gpu_must(vk_buffer_grow(vk, 16, &buffer, &reason), &reason);
        assert_ptr_equal(buffer, before);
        gpu_must(vk_buffer_grow(vk, 21, &buffer, &reason), &reason);
        assert_int_equal(vk_buffer_bytes(buffer), 21);
        vk_buffer_free(vk, buffer);
    }
    must_close(vk);
}

/* Devices that cannot be listed are none, with the reason. */
static void list_that_fails_is_its_reason(void **state)
{
    (void)state;
    struct vk_options options = fake_options();
    char text[256];
    fake_reset();
    fake.fail_name = "vkEnumeratePhysicalDevices";
    fake.result = VK_ERROR_INITIALIZATION_FAILED;
    vk_describe(&options, text, sizeof text);
    assert_string_equal(text, "vulkan: vkEnumeratePhysicalDevices: initialization failed "
                              "(VkResult -3)");
    must_be_clean("a list");
    fake_reset();
    fake.devices = 0;
    vk_describe(&options, text, sizeof text);
    assert_string_equal(text, "no device\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(limits_are_those_of_the_device),
        cmocka_unit_test(the_smaller_of_two_limits_counts),
        cmocka_unit_test(promises_of_floats_are_told_apart),
        cmocka_unit_test(older_devices_are_asked_by_extension),
        cmocka_unit_test(devices_and_loaders_before_1_1_are_refused),
        cmocka_unit_test(queue_family_with_the_best_clock_is_taken),
        cmocka_unit_test(device_is_chosen_by_index_name_and_kind),
        cmocka_unit_test(ray_queries_need_all_their_parts),
        cmocka_unit_test(memory_is_shared_by_the_kind_of_device),
        cmocka_unit_test(memory_type_is_the_best_allowed),
        cmocka_unit_test(limits_of_buffers_are_exact),
        cmocka_unit_test(list_that_fails_is_its_reason),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
