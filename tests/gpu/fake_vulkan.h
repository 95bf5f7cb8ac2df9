/* A Vulkan loader, driver and device that compute nothing, within the test program, which exports
 * vkGetInstanceProcAddr: vk_options.library "" opens the program itself. Any call can be made to
 * fail, any entry point to be missing; what is made, destroyed and recorded is counted. */
#ifndef TESTS_FAKE_VULKAN_H
#define TESTS_FAKE_VULKAN_H

#define VK_NO_PROTOTYPES
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

#define FAKE_BINDINGS 8u
#define FAKE_LOG      64u

/* What an acceleration structure needs for each primitive, and to be built. */
#define FAKE_ACCEL_BYTES   64u
#define FAKE_SCRATCH_BYTES 1000u

/* What a device answers. */
struct fake_device {
    VkPhysicalDeviceProperties base;
    uint64_t allocation; /* largest memory allocation */
    const char *driver_name, *driver_info;
    bool nearest, denormals, inf_nan;
    VkQueueFamilyProperties family[4];
    uint32_t family_count;
    const char *extension[6];
    uint32_t extension_count;
    bool has_address, has_accel, has_query;
    bool has_indirect, has_host; /* builds; but it lacks their entry points */
    uint32_t scratch_alignment;
    uint64_t most_triangles, most_geometries, most_instances;
    VkPhysicalDeviceMemoryProperties memory;
    uint32_t memory_types; /* bits of those that a buffer may lie in */
};

/* A buffer as a shader sees it. */
struct fake_part {
    uint8_t *byte; /* NULL: not bound */
    uint64_t offset, bytes;
    VkFormat format; /* of a texel buffer; else 0 */
};

/* A dispatch that was recorded. */
struct fake_dispatch {
    uint32_t groups; /* UINT32_MAX: indirect, its counts are at `at` of a buffer */
    uint64_t at;
    uint32_t push_bytes;
    uint32_t push[32];
    uint32_t constants, constant[16]; /* of its pipeline */
    struct fake_part part[FAKE_BINDINGS];
};

struct fake {
    struct fake_device device[3];
    uint32_t devices;
    uint32_t version;  /* of the loader */
    const char *layer; /* NULL: none is installed */

    /* What goes wrong. */
    const char *missing;    /* an entry point */
    uint32_t fail_at;       /* 1: the first call that can fail; 0: none */
    const char *fail_name;  /* or each call of this */
    VkResult result;        /* of it */
    uint32_t waits_in_vain; /* that many waits for fences time out */
    bool no_ticks;          /* timestamps cannot be read */
    bool incompatible;      /* what was serialised is called so */
    uint64_t serial_bytes;  /* of what is serialised: as many, with so many handles in its head; */
    uint64_t serial_handles, serial_handle; /* each is this, or 0: that of the last structure that
                                             * was asked for its address */

    /* What was done. */
    uint32_t calls;     /* those that can fail */
    const char *failed; /* the call that failed */
    long alive;         /* objects not destroyed */
    long destroyed;
    const char *wrong;       /* first use that Vulkan forbids */
    uint64_t waited[4];      /* time allowed to the last waits, the last one first */
    uint64_t memory_type[4]; /* of the last allocations, the last one first */
    const struct fake_device *chosen;
    void *opened;    /* the last device, a struct fake_object */
    uint32_t family; /* of its queue */
    uint32_t api;    /* version asked of the instance */
    VkBool32 robust;
    uint32_t extensions;    /* enabled for the device */
    bool checks;            /* the layer's checks of memory accesses are enabled */
    bool races;             /* likewise those of races between dispatches */
    uint64_t ticks[2];      /* what the timestamps are */
    uint64_t accel_address; /* the last that was asked for */
    struct fake_dispatch log[FAKE_LOG];
    char recorded[64];      /* the last command buffer, a letter each: see fake_record() */
    uint32_t barrier[8][4]; /* in it: stages and accesses, before and after */
    uint32_t barriers;
    uint32_t dispatches;
    uint32_t updates, builds, idles;
    uint32_t built[4]; /* primitives of each build */
    VkDebugUtilsMessengerCreateInfoEXT messenger;
    void (*run)(const struct fake_dispatch *); /* called for each dispatch; may be NULL */
};

extern struct fake fake;

/* Makes it one healthy device, on which nothing was done; what was alive is forgotten. */
void fake_reset(void);

/* Its own memory comes from these, where allocations of the program are made to fail. */
void fake_memory(void *(*own_calloc)(size_t, size_t), void (*own_free)(void *));

/* --- between its files ------------------------------------------------------------------------ */

enum fake_kind {
    FAKE_INSTANCE = 1,
    FAKE_MESSENGER,
    FAKE_PHYSICAL,
    FAKE_DEVICE,
    FAKE_QUEUE,
    FAKE_COMMANDS,
    FAKE_COMMAND,
    FAKE_FENCE,
    FAKE_QUERY,
    FAKE_BUFFER,
    FAKE_MEMORY,
    FAKE_MODULE,
    FAKE_SET_LAYOUT,
    FAKE_LAYOUT,
    FAKE_PIPELINE,
    FAKE_POOL,
    FAKE_SET,
    FAKE_ACCEL,
    FAKE_VIEW
};

/* An object. */
struct fake_object {
    enum fake_kind kind;
    struct fake_object *of; /* of a set: the next one of its pool */
    uint64_t bytes;
    uint8_t *byte;
    uint32_t count, constant[16];
    uint32_t texels; /* of a set and its layout: bindings, bit 1 << i */
    struct fake_part part[FAKE_BINDINGS];
};

/* Makes an object, which counts as alive; drop() frees it, NULL is fine. what() checks its kind. */
struct fake_object *fake_make(enum fake_kind kind, struct fake_object *of);
void fake_drop(void *object, enum fake_kind kind);
struct fake_object *fake_what(void *object, enum fake_kind kind);

/* Zeroed. */
void *fake_bytes(size_t bytes);

/* The result of the call that is being made. */
VkResult fake_call(const char *name);
void fake_wrong(const char *what);

/* Notes a command: r queries are reset, t timestamp, p pipeline, s set, k push constants, d
 * dispatch, i indirect one, u update, c copy, b barrier, a acceleration structure. */
void fake_record(char command);

/* Nothing is bound to the command buffer, which is recorded from now on. */
void fake_unbind(void);

struct fake_entry {
    const char *name;
    PFN_vkVoidFunction function;
};
extern const struct fake_entry fake_device_entry[], fake_command_entry[], fake_set_entry[];
extern const size_t fake_device_entries, fake_command_entries, fake_set_entries;

#define FAKE_ENTRY(name)                                                                           \
    {                                                                                              \
#name, (PFN_vkVoidFunction)(name)                                                          \
    }

#endif
