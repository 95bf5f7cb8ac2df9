/* One Vulkan device for compute, loaded at run time: one queue, buffers, one dispatch at a time.
 * Does not depend on ray tracing. Not thread-safe. */
#ifndef VK_H
#define VK_H

#include "ref/base/base.h"

#define VK_WAIT_NS       60000000000u /* default of vk_options.wait_ns */
#define VK_BINDINGS_MAX  8u
#define VK_CONSTANTS_MAX 16u
#define VK_SERIES_MAX    64u
#define VK_UPDATE_MAX    65536u
#define VK_NAME_BYTES    256u

struct vk_shader;

/* Bindings (bit 1 << binding) that are no storage buffers. */
struct vk_ways {
    uint32_t texels;     /* uniform texel buffers */
    uint32_t references; /* storage buffers of 8 bytes: the address of what the caller binds */
};

/* Makes another module of a shader's before a pipeline is made of it. */
struct vk_compiler {
    /* Replaces shader->word and word_count by words that live until the program ends, the same
     * ones for the same module and constants. Errors: STATUS_DEVICE, STATUS_UNSUPPORTED,
     * STATUS_MEMORY. */
    enum status (*compile)(void *user, struct vk_shader *shader, struct reason *reason);
    void *user;
    struct vk_ways ways; /* of all its modules */
};

/* What is needed of a device with ray queries beyond these. */
struct vk_ray_more {
    bool lives;    /* copies of acceleration structures, and what they are asked */
    bool indirect; /* feature accelerationStructureIndirectBuild */
    bool host;     /* feature accelerationStructureHostCommands */
};

struct vk_options {
    const char *library; /* the loader to open, NULL: libvulkan.so.1 */
    const char *driver;  /* argument of driver_find (gpu/vk/vk_driver.h), NULL: any */
    int device;    /* index as vk_describe lists them, -1: the first that matches and can compute */
    bool validate; /* run under VK_LAYER_KHRONOS_validation and count its messages */
    bool watch;    /* also check every memory access of a shader; switches off the robustness that
                    * makes invalid accesses harmless */
    bool whole_modules; /* leave branches that constants decide to the driver, see vk_settle.h; so
                         * does RAYDIFF_WHOLE_MODULES=1 in the environment */
    bool staging;       /* copy through a staging buffer even if memory is shared */
    bool ray_query;     /* require ray queries, see gpu/vk/vk_accel.h */
    struct vk_ray_more ray_more;        /* with ray_query; zeros: nothing more */
    const struct vk_compiler *compiler; /* for vk_compile; borrowed; NULL: none */
    uint64_t wait_ns;                   /* longest wait for one dispatch, 0: VK_WAIT_NS */
};

/* Properties of a device. */
struct vk_limits {
    char device[VK_NAME_BYTES];
    char driver[VK_NAME_BYTES]; /* name and version that the driver reports */
    uint32_t api_version;       /* as VK_MAKE_API_VERSION packs it */
    uint64_t buffer_bytes;      /* largest storage buffer, by range and allocation limits */
    uint32_t groups;            /* most workgroups of a dispatch */
    uint32_t group_size;        /* most invocations of a workgroup */
    uint32_t bindings;          /* most storage buffers of a shader */
    uint64_t alignment;         /* of the offset of a part of a buffer, see vk_work */
    uint32_t texels;            /* most elements of a texel buffer */
    uint32_t timestamp_bits;    /* 0: no timestamps */
    float timestamp_ns;         /* nanoseconds per tick */
    bool software;              /* runs on a CPU */
    bool shared_memory;         /* buffers are mapped, without staging copies */
    bool round_to_nearest;      /* float controls, 32 bit */
    bool keeps_denormals;
    bool keeps_inf_nan;
};

struct vk;          /* an open device */
struct vk_pipeline; /* a compute shader with its constants fixed */
struct vk_buffer;   /* a storage buffer */

/* Opens the loader, an instance and one device. *out is NULL on error.
 * Errors: STATUS_UNSUPPORTED no loader, driver not found, no device, no match (the reason lists the
 * devices), no compute queue, no
 * validation layer, a feature of ray_more (with its name); STATUS_DEVICE a call failed;
 * STATUS_MEMORY. */
enum status vk_open(const struct vk_options *options, struct vk **out,
                    struct reason *reason) MUST_USE;

/* Waits for the device and destroys everything. Pipelines and buffers must have been freed. Returns
 * the number of validation messages since vk_open, including those about leaks; `reason` (may be
 * NULL) is set to the first. NULL is fine. A device that hangs is not destroyed. */
uint32_t vk_close(struct vk *vk, struct reason *reason);

const struct vk_limits *vk_limits(const struct vk *vk);

/* Returns the number of validation messages so far. Sets `reason` to the first, if any. */
uint32_t vk_messages(const struct vk *vk, struct reason *reason);

/* Lists the devices with their indices, one a line, or writes the reason why there are none. */
void vk_describe(const struct vk_options *options, char *text, size_t text_bytes);

/* Makes a storage buffer of `bytes` bytes, at least 16; its content is undefined.
 * Errors: STATUS_LIMIT larger than the device allows (bytes and limit); STATUS_MEMORY;
 * STATUS_DEVICE. */
enum status vk_buffer_make(struct vk *vk, uint64_t bytes, struct vk_buffer **out,
                           struct reason *reason) MUST_USE;

/* As vk_buffer_make, and copies `data` to the buffer; `data` may be NULL if `bytes` is 0. On error
 * the buffer, if one was made, is left in *out. Errors: as vk_buffer_make and vk_buffer_write. */
enum status vk_buffer_make_of(struct vk *vk, const void *data, uint64_t bytes,
                              struct vk_buffer **out, struct reason *reason) MUST_USE;

/* Replaces *buffer (may be NULL) with a new one of `bytes` bytes if it is smaller; the content is
 * then undefined. Errors: as vk_buffer_make; *buffer is then NULL. */
enum status vk_buffer_grow(struct vk *vk, uint64_t bytes, struct vk_buffer **buffer,
                           struct reason *reason) MUST_USE;

/* Frees one buffer, or `count` of them, which become NULL. NULL is fine. */
void vk_buffer_free(struct vk *vk, struct vk_buffer *buffer);
void vk_buffers_free(struct vk *vk, struct vk_buffer **buffer, uint32_t count);
uint64_t vk_buffer_bytes(const struct vk_buffer *buffer); /* NULL: 0 */

/* Copies to or from the buffer. The range must lie in it. Errors: STATUS_DEVICE, _MEMORY. */
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
    bool whole;             /* somebody else's: the driver gets the module as it is (vk_settle.h) */
    bool accel; /* binding `binding_count` is an acceleration structure, see vk_pipeline_use */
    struct vk_ways ways;      /* of these bindings */
    uint32_t words;           /* texel buffers of words; the others are of quads */
    const uint32_t *constant; /* specialization constant i is constant[i]; borrowed for the call */
    uint32_t constant_count;  /* at most VK_CONSTANTS_MAX */
};

/* Has the device's compiler replace the shader's module; without one does nothing. Whoever makes a
 * pipeline of a shader that traces or draws calls it before. Errors: as vk_compiler.compile. */
enum status vk_compile(const struct vk *vk, struct vk_shader *shader,
                       struct reason *reason) MUST_USE;

/* Makes a pipeline. Errors: STATUS_UNSUPPORTED constant 0, the workgroup's size, is 0 or over the
 * device's limit, or more storage buffers than the device allows; STATUS_DEVICE; STATUS_MEMORY. */
enum status vk_pipeline_make(struct vk *vk, const struct vk_shader *shader,
                             struct vk_pipeline **out, struct reason *reason) MUST_USE;
void vk_pipeline_free(struct vk *vk, struct vk_pipeline *pipeline); /* NULL is fine */

/* The time of one dispatch. */
struct vk_time {
    uint64_t ns;
    bool device_clock; /* from timestamps; else the host's clock from submission to fence */
};

/* Runs `groups` workgroups and waits. buffer[i] is bound to binding i, for all bindings of the
 * shader.
 * Errors: STATUS_DEVICE lost, or not done within the wait (later calls then fail, too);
 * STATUS_MEMORY; STATUS_LIMIT more groups, or elements of a texel buffer, than the device
 * allows. */
enum status vk_dispatch(struct vk *vk, struct vk_pipeline *pipeline,
                        struct vk_buffer *const *buffer, const void *push, uint32_t groups,
                        struct vk_time *time, struct reason *reason) MUST_USE;

/* One dispatch of a series. */
struct vk_step {
    struct vk_pipeline *pipeline; /* all steps have the same bindings and push_bytes */
    const void *push;
    uint32_t groups;
    struct vk_buffer *groups_of; /* NULL, or a buffer that holds the group counts as three */
    uint64_t groups_at;          /* words at this offset, written before; `groups` is then unused */
    struct vk_buffer *update; /* NULL, or a buffer whose first bytes are set before the dispatch */
    const void *bytes;        /* to these; at most VK_UPDATE_MAX, a multiple of 4 */
    uint32_t byte_count;
};

/* Runs 1 to VK_SERIES_MAX dispatches in one submission, one after the other, and waits. Each sees
 * what the earlier ones wrote. buffer[i] is bound to binding i of all. Errors: as vk_dispatch. */
enum status vk_dispatch_series(struct vk *vk, struct vk_buffer *const *buffer,
                               const struct vk_step *step, uint32_t count, struct vk_time *time,
                               struct reason *reason) MUST_USE;

/* Descriptor sets for many dispatches in one submission. */
struct vk_sets;

/* vk_shader.ways of shaders that the device's compiler has been at. */
struct vk_ways vk_ways(const struct vk *vk);

/* The most bytes of a buffer of which shaders of these ways read quads. */
uint64_t vk_quad_bytes(const struct vk *vk);

/* Makes `count` sets of `bindings` buffers of these ways, storage buffers by default; with `accel`
 * binding `bindings` is an acceleration structure. Errors: STATUS_DEVICE; STATUS_MEMORY. */
enum status vk_sets_make(struct vk *vk, uint32_t bindings, struct vk_ways ways, bool accel,
                         uint32_t count, struct vk_sets **out, struct reason *reason) MUST_USE;
void vk_sets_free(struct vk *vk, struct vk_sets *sets); /* NULL is fine */

/* One dispatch of many. Its shader sees only part[i] of buffer i: robust accesses beyond a part are
 * as harmless as those beyond a buffer. */
struct vk_work {
    struct vk_pipeline *pipeline; /* without `accel` */
    struct {
        uint64_t offset, bytes; /* offset a multiple of the device's alignment; bytes not 0 */
    } part[VK_BINDINGS_MAX];
    const void *push;
    uint32_t groups;
};

/* Checks that the parts of one dispatch fit what the device allows. Errors: STATUS_LIMIT a texel
 * buffer of more elements. */
enum status vk_work_check(const struct vk *vk, const struct vk_sets *sets,
                          const struct vk_work *work, struct reason *reason) MUST_USE;

/* Runs `count` dispatches, at most the number of sets, in one submission and waits. Parts of
 * buffer[i] are bound to binding i of all. They may run in any order, also at once. Errors: as
 * vk_dispatch. */
enum status vk_dispatch_many(struct vk *vk, struct vk_sets *sets, struct vk_buffer *const *buffer,
                             const struct vk_work *work, uint32_t count,
                             struct reason *reason) MUST_USE;

#endif
