/* One Vulkan device used for compute: found at run time, one queue, buffers, one dispatch at a
 * time. Independent of rays. Not thread-safe. */
#ifndef VK_H
#define VK_H

#include "ref/base/base.h"

#define VK_WAIT_NS       60000000000u /* longest wait for one dispatch by default */
#define VK_BINDINGS_MAX  8u
#define VK_CONSTANTS_MAX 16u
#define VK_SERIES_MAX    64u
#define VK_UPDATE_MAX    65536u
#define VK_NAME_BYTES    256u

struct vk_options {
    const char *library; /* the loader to open, NULL: libvulkan.so.1 */
    const char *driver;  /* as driver_find (gpu/vk/vk_driver.h) takes it, NULL: any */
    int device;    /* index as vk_describe lists them, -1: the first that matches and can compute */
    bool validate; /* run under VK_LAYER_KHRONOS_validation and count its messages */
    bool watch;    /* the same, every access of a shader to memory included; switches off the
                      robustness that makes broken accesses harmless */
    bool staging;  /* copy through a staging buffer even where memory is shared */
    bool ray_query;   /* the device must have ray queries, see gpu/vk/vk_accel.h */
    uint64_t wait_ns; /* longest wait for one dispatch, 0: VK_WAIT_NS */
};

/* What matters of a device. */
struct vk_limits {
    char device[VK_NAME_BYTES];
    char driver[VK_NAME_BYTES]; /* name and version as the driver gives them */
    uint32_t api_version;       /* as VK_MAKE_API_VERSION packs it */
    uint64_t buffer_bytes;      /* largest storage buffer: range and allocation limits */
    uint32_t groups;            /* most workgroups of a dispatch */
    uint32_t group_size;        /* most invocations of a workgroup */
    uint32_t bindings;          /* most storage buffers of a shader */
    uint64_t alignment;         /* of where a part of a buffer may begin, see vk_work */
    uint32_t timestamp_bits;    /* 0: no timestamps */
    float timestamp_ns;         /* nanoseconds per tick */
    bool software;              /* a CPU runs it */
    bool shared_memory;         /* buffers are mapped: no staging copies */
    bool round_to_nearest;      /* float controls, 32 bit */
    bool keeps_denormals;
    bool keeps_inf_nan;
};

struct vk;          /* an open device */
struct vk_pipeline; /* a compute shader with its constants fixed */
struct vk_buffer;   /* a storage buffer */

/* Opens loader, instance and one device. `*out` is NULL on error.
 * Errors: STATUS_UNSUPPORTED no loader, driver not there, no device, no match (the reason lists
 * the devices), no compute queue, no validation layer; STATUS_DEVICE a call failed;
 * STATUS_MEMORY. */
enum status vk_open(const struct vk_options *options, struct vk **out,
                    struct reason *reason) MUST_USE;

/* Waits for the device, destroys everything. Pipelines and buffers must have been freed. Returns
 * the number of validation messages since vk_open, those about leaks included; `reason` (may be
 * NULL) has the first. NULL is fine. A device that hangs is left behind undestroyed. */
uint32_t vk_close(struct vk *vk, struct reason *reason);

const struct vk_limits *vk_limits(const struct vk *vk);

/* Validation messages so far; the first one goes to `reason` unless there is none. */
uint32_t vk_messages(const struct vk *vk, struct reason *reason);

/* Lists the devices, one a line with its index, or the reason why there is none. */
void vk_describe(const struct vk_options *options, char *text, size_t text_bytes);

/* Makes a storage buffer of `bytes` bytes (0 is made 16), content undefined.
 * Errors: STATUS_LIMIT larger than the device allows (bytes and limit); STATUS_MEMORY;
 * STATUS_DEVICE. */
enum status vk_buffer_make(struct vk *vk, uint64_t bytes, struct vk_buffer **out,
                           struct reason *reason) MUST_USE;

/* The same with a copy of `data` in it; `data` may be NULL if `bytes` is 0. On error the buffer, if
 * one was made, is left in *out. Errors: as vk_buffer_make and vk_buffer_write. */
enum status vk_buffer_make_of(struct vk *vk, const void *data, uint64_t bytes,
                              struct vk_buffer **out, struct reason *reason) MUST_USE;

/* Replaces *buffer (may be NULL) by a new one of `bytes` bytes if it is smaller; content undefined
 * then. Errors: as vk_buffer_make; *buffer is NULL then. */
enum status vk_buffer_grow(struct vk *vk, uint64_t bytes, struct vk_buffer **buffer,
                           struct reason *reason) MUST_USE;

/* Frees one, or `count` of them, which become NULL. NULL is fine. */
void vk_buffer_free(struct vk *vk, struct vk_buffer *buffer);
void vk_buffers_free(struct vk *vk, struct vk_buffer **buffer, uint32_t count);
uint64_t vk_buffer_bytes(const struct vk_buffer *buffer); /* NULL: 0 */

/* Copies into or out of the buffer; the range must lie in it. Errors: STATUS_DEVICE, _MEMORY. */
enum status vk_buffer_write(struct vk *vk, struct vk_buffer *buffer, uint64_t offset,
                            const void *data, uint64_t bytes, struct reason *reason) MUST_USE;
enum status vk_buffer_read(struct vk *vk, struct vk_buffer *buffer, uint64_t offset, void *data,
                           uint64_t bytes, struct reason *reason) MUST_USE;

/* A compute shader, for vk_pipeline_make. */
struct vk_shader {
    const char *name;     /* for messages */
    const uint32_t *word; /* SPIR-V with entry point `main` */
    uint32_t word_count;
    uint32_t binding_count; /* storage buffers 0 .. binding_count - 1 of set 0 */
    uint32_t push_bytes;    /* a multiple of 4, at most 128 */
    bool accel; /* binding `binding_count` is an acceleration structure, see vk_pipeline_use */
    const uint32_t *constant; /* value of specialization constant i; borrowed for the call */
    uint32_t constant_count;  /* at most VK_CONSTANTS_MAX */
};

/* Errors: STATUS_UNSUPPORTED constant 0, the workgroup's size, is 0 or over the device's limit, or
 * more storage buffers than the device allows; STATUS_DEVICE; STATUS_MEMORY. */
enum status vk_pipeline_make(struct vk *vk, const struct vk_shader *shader,
                             struct vk_pipeline **out, struct reason *reason) MUST_USE;
void vk_pipeline_free(struct vk *vk, struct vk_pipeline *pipeline); /* NULL is fine */

/* What one dispatch cost. */
struct vk_time {
    uint64_t ns;
    bool device_clock; /* from timestamps, else from submission to the fence on the host's clock */
};

/* Runs `groups` workgroups and waits. buffer[i] is bound to binding i, all of the shader's.
 * Errors: STATUS_DEVICE lost, or not done within the wait (then the device is given up: later
 * calls fail too); STATUS_MEMORY; STATUS_LIMIT more groups than the device allows. */
enum status vk_dispatch(struct vk *vk, struct vk_pipeline *pipeline,
                        struct vk_buffer *const *buffer, const void *push, uint32_t groups,
                        struct vk_time *time, struct reason *reason) MUST_USE;

/* One dispatch of a series. */
struct vk_step {
    struct vk_pipeline *pipeline; /* all with the same bindings and push_bytes */
    const void *push;
    uint32_t groups;
    struct vk_buffer *groups_of; /* NULL, or the buffer that holds the number of groups as three */
    uint64_t groups_at;          /* words at this offset, written before; `groups` is not read */
    struct vk_buffer *update; /* NULL, or a buffer whose first bytes are set before the dispatch */
    const void *bytes;        /* to these: at most VK_UPDATE_MAX, a multiple of 4 */
    uint32_t byte_count;
};

/* Runs 1 to VK_SERIES_MAX dispatches in one submission, one after the other, and waits: each sees
 * what those before it wrote. buffer[i] is bound to binding i of all. Errors: as vk_dispatch. */
enum status vk_dispatch_series(struct vk *vk, struct vk_buffer *const *buffer,
                               const struct vk_step *step, uint32_t count, struct vk_time *time,
                               struct reason *reason) MUST_USE;

/* Descriptor sets for many dispatches in one submission. */
struct vk_sets;

/* Makes `count` sets of `bindings` storage buffers, and with `accel` an acceleration structure as
 * binding `bindings`. Errors: STATUS_DEVICE; STATUS_MEMORY. */
enum status vk_sets_make(struct vk *vk, uint32_t bindings, bool accel, uint32_t count,
                         struct vk_sets **out, struct reason *reason) MUST_USE;
void vk_sets_free(struct vk *vk, struct vk_sets *sets); /* NULL is fine */

/* One dispatch of many. Its shader sees of buffer i the bytes from part[i].offset on, no others:
 * robust accesses beyond them are as harmless as those beyond a buffer. */
struct vk_work {
    struct vk_pipeline *pipeline; /* without `accel` */
    struct {
        uint64_t offset, bytes; /* offset a multiple of the device's alignment; bytes not 0 */
    } part[VK_BINDINGS_MAX];
    const void *push;
    uint32_t groups;
};

/* Runs `count` dispatches, at most the number of sets, in one submission and waits. buffer[i] is
 * bound to binding i of all, in parts. They may run in any order, also at once. Errors: as
 * vk_dispatch. */
enum status vk_dispatch_many(struct vk *vk, struct vk_sets *sets, struct vk_buffer *const *buffer,
                             const struct vk_work *work, uint32_t count,
                             struct reason *reason) MUST_USE;

#endif
