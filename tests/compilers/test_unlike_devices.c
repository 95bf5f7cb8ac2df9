/* Of several devices that differ in all that they answer, the one that is taken has nothing of
 * those that were looked at (tests/gpu/fake_vulkan.h). */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_device_has_nothing_of_the_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
