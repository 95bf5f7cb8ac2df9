/* Of several devices that differ in all that they answer, the one that is taken has nothing of
 * those that were looked at; and what a device says of structures that it serialised itself, right
 * or wrong, is told with its name (tests/gpu/fake_vulkan.h). */
#include "tests/gpu/fake_work.h"

/* Three devices that differ in all that they answer; of the last one the driver tells no largest
 * allocation. */
static void unlike_devices(void)
{
    fake_reset();
    fake.devices = 3;
    fake.device[1].base.deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
    fake.device[2].driver_name = "Another Driver";
    for (uint32_t i = 0; i < 3; i++) {
        struct fake_device *device = &fake.device[i];
        VkPhysicalDeviceLimits *limits = &device->base.limits;
        (void)snprintf(device->base.deviceName, 16, "device %u", i);
        device->base.apiVersion = VK_API_VERSION_1_2 + i;
        device->allocation = (uint64_t[]){1u << 20, 5 * FAKE_ACCEL_BYTES, 0}[i];
        device->nearest = i == 0;
        device->denormals = i == 1;
        device->inf_nan = i == 2;
        limits->maxTexelBufferElements = 1000 + i;
        limits->maxStorageBufferRange = 5000 - i;
        limits->maxComputeWorkGroupCount[0] = 60 + i;
        limits->maxComputeWorkGroupSize[0] = 128 >> i;
        limits->maxPerStageDescriptorStorageBuffers = 9 - i;
        limits->minStorageBufferOffsetAlignment = 16u << i;
        limits->timestampPeriod = 3.0f - (float)i;
        device->family[0].timestampValidBits = 64 - 28 * i;
        device->scratch_alignment = 64u << i;
        device->most_triangles = 40 - 10 * i;
        device->memory.memoryTypeCount = 3;
        for (uint32_t k = 0; k < 3; k++)
            device->memory.memoryTypes[k] = device->memory.memoryTypes[0];
        device->memory_types = 1u << (2 - i);
    }
}

/* All that is told of the open device, and what it allows, as a text. */
static void tell_device(const struct vk_options *options, char text[4096])
{
    struct vk *vk = must_open(options);
    const struct vk_limits *l = vk_limits(vk);
    struct reason reason = {""};
    struct vk_buffer *buffer, *vertices = NULL;
    size_t at = (size_t)snprintf(
        text, 4096, "%s %s %x %llu %u %u %u %llu %u %u %g %d%d%d%d%d", l->device, l->driver,
        l->api_version, (unsigned long long)l->buffer_bytes, l->groups, l->group_size, l->bindings,
        (unsigned long long)l->alignment, l->texels, l->timestamp_bits, (double)l->timestamp_ns,
        l->software, l->shared_memory, l->round_to_nearest, l->keeps_denormals, l->keeps_inf_nan);
    for (uint64_t bytes = 256; bytes <= 8192; bytes += 256) {
        reason.text[0] = '\0';
        const enum status status = vk_buffer_make(vk, bytes, &buffer, &reason);
        at += (size_t)snprintf(text + at, 4096 - at, " %d/%d", (int)status,
                               status ? 0 : (int)fake.memory_type[0]);
        vk_buffer_free(vk, buffer);
    }
    gpu_must(vk_buffer_make(vk, 64, &vertices, &reason), &reason);
    for (uint32_t count = 1; count <= 41 && options->ray_query; count++) {
        struct vk_accel *accel;
        reason.text[0] = '\0';
        const enum status status = vk_accel_make(vk, vertices, 3, vertices, count, &accel, &reason);
        at += (size_t)snprintf(text + at, 4096 - at, " %d %.60s", (int)status, reason.text);
        vk_accel_free(vk, accel);
    }
    vk_buffer_free(vk, vertices);
    must_close(vk);
}

/* Whichever is chosen, all is as where it is the only device. */
static void a_device_has_nothing_of_the_others(void **state)
{
    (void)state;
    for (int queries = 0; queries < 2; queries++)
        for (uint32_t i = 0; i < 3; i++) {
            struct vk_options options = fake_options();
            char among[4096], alone[4096];
            options.ray_query = queries;
            options.device = (int)i;
            unlike_devices();
            tell_device(&options, among);
            unlike_devices();
            fake.devices = 1;
            fake.device[0] = fake.device[i];
            options.device = -1;
            tell_device(&options, alone);
            assert_string_equal(among, alone);
        }
}

/* Makes a structure of one triangle, which is copied, serialises it and loads it. */
static enum status save_and_load(struct vk *vk, enum vk_accel_copy copy, struct reason *reason)
{
    static const struct vk_accel_geometry geometry = {0, 1, true, NULL};
    const struct vk_accel_instance instance = {.mesh = 0};
    const struct vk_accel_how how = {.copy = copy};
    struct vk_buffer *vertices = NULL;
    struct vk_accel *accel = NULL, *again = NULL;
    struct vk_accel_bytes *bytes = NULL;
    enum status status = vk_buffer_make(vk, 64, &vertices, reason);
    const struct vk_accel_mesh mesh = {vertices, vertices, 3, &geometry, 1, NULL, NULL};
    const struct vk_accel_world world = {
        .mesh = &mesh, .instance = &instance, .mesh_count = 1, .instance_count = 1, .how = &how};
    if (!status)
        status = vk_accel_make_world(vk, &world, &accel, reason);
    if (!status)
        status = vk_accel_save(vk, accel, &bytes, reason);
    const uint64_t saved = fake.accel_address; /* of the mesh's structure */
    if (!status)
        status = vk_accel_load(vk, bytes, &again, reason);
    for (uint32_t level = 0; level < 2 && !status; level++) {
        uint64_t count, handle, each;
        const uint8_t *byte = vk_accel_bytes_level(bytes, level, &count, &handle);
        assert_non_null(byte);
        /* Each handle of the top one is that of the structure that was loaded. */
        for (uint64_t i = 0; level == 0 && fake.serial_handle == 0 && i < fake.serial_handles;
             i++) {
            memcpy(&each, byte + 56 + 8 * i, sizeof each);
            assert_true(each != 0 && each != saved);
            assert_memory_equal(&each, byte + 56, sizeof each);
        }
        assert_int_equal(count, fake.serial_bytes);
        assert_int_equal(handle != 0, level == 1);
    }
    vk_accel_bytes_free(bytes);
    vk_accel_free(vk, again);
    vk_accel_free(vk, accel);
    vk_buffer_free(vk, vertices);
    return status;
}

static struct vk_options with_lives(void)
{
    struct vk_options options = fake_options();
    options.ray_query = true;
    options.ray_more.lives = true;
    return options;
}

/* The head of a structure has 56 bytes, each handle 8. */
static void what_a_device_serialised_is_told_by_its_name(void **state)
{
    (void)state;
    static const struct {
        uint64_t bytes, handles, handle;
        bool incompatible;
        const char *why; /* NULL: all is well */
    } cases[] = {
        {200, 0, 0, false, NULL},
        {56, 0, 0, false, NULL},
        {64, 1, 0, false, NULL},
        {200, 18, 0, false, NULL},
        {200, 0, 0, true, "calls what it serialised itself incompatible"},
        {0, 0, 0, false, "has an acceleration structure of 0 bytes"},
        {55, 0, 0, false, "serialised a structure whose header counts 0 handles in 55 bytes"},
        {63, 1, 0, false, "serialised a structure whose header counts 1 handles in 63 bytes"},
        {200, 19, 0, false, "serialised a structure whose header counts 19 handles in 200 bytes"},
        {200, 2, 0x123, false,
         "serialised a top level whose handle 0, 0x123, is that of no structure"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        const struct vk_options options = with_lives();
        struct reason reason = {""};
        char wanted[160] = "";
        fake_reset();
        fake.serial_bytes = cases[i].bytes;
        fake.serial_handles = cases[i].handles;
        fake.serial_handle = cases[i].handle;
        fake.incompatible = cases[i].incompatible;
        struct vk *vk = must_open(&options);
        assert_int_equal(save_and_load(vk, VK_ACCEL_COPY_NONE, &reason),
                         cases[i].why ? STATUS_DEVICE : STATUS_OK);
        if (cases[i].why)
            (void)snprintf(wanted, sizeof wanted, "vulkan: fake device %s", cases[i].why);
        assert_string_equal(reason.text, wanted);
        must_close(vk);
    }
}

/* Each call that can fail fails once. */
static void nothing_is_left_where_a_copy_fails(void **state)
{
    (void)state;
    for (int copy = VK_ACCEL_COPY_NONE; copy <= VK_ACCEL_COPY_SERIALISE; copy++) {
        bool failed = true;
        for (uint32_t at = 1; failed; at++) {
            const struct vk_options options = with_lives();
            struct reason reason = {""};
            struct vk *vk;
            fake_reset();
            fake.fail_at = at;
            fake.result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
            enum status status = vk_open(&options, &vk, &reason);
            if (!status)
                status = save_and_load(vk, (enum vk_accel_copy)copy, &reason);
            failed = fake.failed != NULL;
            assert_int_equal(status != STATUS_OK, failed);
            assert_int_equal(vk_close(vk, NULL), 0);
            must_be_clean(failed ? fake.failed : "no call that fails");
        }
    }
}

/* The heap of the memory that is chosen, and of no other, to the byte. */
static void what_no_heap_holds_is_refused(void **state)
{
    (void)state;
    const struct vk_options options = fake_options();
    for (uint32_t heap = 0; heap < 3; heap++)
        for (uint64_t size = 4096 - 32; size <= 4096 + 32; size += 16) {
            struct fake_device *device = &fake.device[0];
            struct reason reason = {""};
            struct vk_buffer *buffer;
            char text[96];
            fake_reset();
            device->memory.memoryHeapCount = 3;
            for (uint32_t h = 0; h < 3; h++)
                device->memory.memoryHeaps[h].size = h == heap ? size : h < heap ? 1u << 30 : 64;
            device->memory.memoryTypes[0].heapIndex = heap;
            struct vk *vk = must_open(&options);
            const enum status status = vk_buffer_make(vk, 4096, &buffer, &reason);
            assert_int_equal(status, size < 4096 ? STATUS_LIMIT : STATUS_OK);
            (void)snprintf(text, sizeof text, "4096 bytes do not fit in a heap of %u bytes",
                           (unsigned)size);
            assert_int_equal(strstr(reason.text, text) != NULL, size < 4096);
            vk_buffer_free(vk, buffer);
            must_close(vk);
        }
}

/* Each way to build has a feature and an entry point; without one of them no device is opened. */
static void ways_to_build_need_what_is_theirs(void **state)
{
    (void)state;
    static const char *const feature[] = {"accelerationStructureIndirectBuild",
                                          "accelerationStructureHostCommands"};
    static const char *const entry[] = {"vkCmdBuildAccelerationStructuresIndirectKHR",
                                        "vkBuildAccelerationStructuresKHR"};
    for (unsigned asked = 0; asked < 4; asked++)
        for (unsigned has = 0; has < 4; has++) {
            struct vk_options options = with_lives();
            struct reason reason = {""};
            struct vk *vk;
            const unsigned lacks = asked & ~has;
            const char *const why = lacks   ? feature[lacks & 1 ? 0 : 1]
                                    : asked ? entry[asked & 1 ? 0 : 1]
                                            : NULL;
            options.ray_more.indirect = asked & 1;
            options.ray_more.host = asked & 2;
            fake_reset();
            fake.device[0].has_indirect = has & 1;
            fake.device[0].has_host = has & 2;
            assert_int_equal(vk_open(&options, &vk, &reason), why ? STATUS_UNSUPPORTED : STATUS_OK);
            if (why && !strstr(reason.text, why))
                fail_msg("'%s' is not '%s'", reason.text, why);
            assert_int_equal(vk_close(vk, NULL), 0);
            must_be_clean("a way to build");
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_device_has_nothing_of_the_others),
        cmocka_unit_test(what_a_device_serialised_is_told_by_its_name),
        cmocka_unit_test(nothing_is_left_where_a_copy_fails),
        cmocka_unit_test(what_no_heap_holds_is_refused),
        cmocka_unit_test(ways_to_build_need_what_is_theirs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
