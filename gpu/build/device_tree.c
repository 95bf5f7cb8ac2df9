#include "gpu/build/device_tree_inner.h"

#include "gpu/shaders/shaders.h"

#include <stdlib.h>
#include <string.h>

static const char *const kernel_names[KERNELS] = {
    "build_bounds",     "build_codes",         "build_count",       "build_scan",
    "build_scatter",    "build_links",         "build_boxes",       "build_clusters",
    "build_refit",      "build_refit_cwbvh80", "build_refit_tiny8", "build_refit_half4",
    "build_refit_grid", "build_refit_hpb64",   "build_refit_amd64", "build_refit_gfx12",
    "build_adopt",      "build_sizes",         "build_open",        "build_level",
    "build_place",      "build_encode"};

const char *const device_stage_names[DEVICE_STAGES] = {"codes", "order", "links", "boxes"};

#define BLOCK      (ABI_BUILD_GROUP * ABI_BUILD_EACH)
#define DIGITS     (1u << ABI_BUILD_DIGIT)
#define STEPS_MOST 48u /* of the sort: three for each digit of 64 bits */

/* --- opening ---------------------------------------------------------------------------------- */

enum status device_tree_kernel(struct device_tree *tree, enum kernel kernel, struct reason *reason)
{
    static const uint32_t group = ABI_BUILD_GROUP;
    if (tree->kernel[kernel])
        return STATUS_OK;
    const struct shader *shader = shader_find(kernel_names[kernel]);
    const struct vk_shader make = {.name = shader->name,
                                   .word = shader->word,
                                   .word_count = shader->word_count,
                                   .binding_count = ABI_BUILD_BINDINGS,
                                   .push_bytes = sizeof(struct build_push),
                                   .constant = &group,
                                   .constant_count = 1};
    return vk_pipeline_make(tree->vk, &make, &tree->kernel[kernel], reason);
}

enum status device_tree_open(const struct vk_options *options, struct device_tree **out,
                             struct reason *reason)
{
    struct device_tree *tree = alloc_zeroed(1, sizeof *tree);
    *out = NULL;
    if (!tree)
        return fail(reason, STATUS_MEMORY, "no memory to open a device");
    enum status status = vk_open(options, &tree->vk, reason);
    for (int k = 0; k <= REFIT && !status; k++)
        status = device_tree_kernel(tree, (enum kernel)k, reason);
    if (status)
        (void)device_tree_close(tree, NULL);
    else
        *out = tree;
    return status;
}

uint32_t device_tree_close(struct device_tree *tree, struct reason *reason)
{
    if (!tree)
        return 0;
    if (tree->vk) {
        for (int k = 0; k < KERNELS; k++)
            vk_pipeline_free(tree->vk, tree->kernel[k]);
        vk_buffers_free(tree->vk, tree->buffer, ABI_BUILD_BINDINGS);
        vk_buffers_free(tree->vk, tree->wide, DEVICE_WIDE_BUFFERS);
    }
    uint32_t messages = vk_close(tree->vk, reason);
    free(tree);
    return messages;
}

const struct vk_limits *device_tree_limits(const struct device_tree *tree)
{
    return vk_limits(tree->vk);
}

/* --- building --------------------------------------------------------------------------------- */

#define POISON_BYTES (1u << 20)

enum status device_tree_poison(struct device_tree *tree, struct vk_buffer *buffer, uint64_t bytes,
                               struct reason *reason)
{
    uint32_t *junk = malloc(POISON_BYTES);
    enum status status = STATUS_OK;
    if (!junk)
        return fail(reason, STATUS_MEMORY, "no memory to prepare a device's buffers");
    tree->poisoned++;
    for (uint32_t i = 0; i < POISON_BYTES / sizeof *junk; i++)
        junk[i] = 0xD0000000u ^ tree->poisoned * 0x9E3779B9u ^ i * 0x85EBCA6Bu;
    for (uint64_t at = 0; at < bytes && !status; at += POISON_BYTES)
        status = vk_buffer_write(tree->vk, buffer, at, junk,
                                 bytes - at < POISON_BYTES ? bytes - at : POISON_BYTES, reason);
    free(junk);
    return status;
}

static enum status make_buffers(struct device_tree *tree, const struct scene *scene,
                                struct device_times *times, struct reason *reason)
{
    const uint64_t n = scene->tri_count, blocks = groups_of(scene->tri_count, BLOCK);
    const uint64_t digits = DIGITS * blocks, children = 2 * n;
    const uint64_t words[ABI_BUILD_BINDINGS] = {
        [ABI_BUILD_VERTICES] = 3 * (uint64_t)scene->vertex_count,
        [ABI_BUILD_INDICES] = 3 * n,
        [ABI_BUILD_KEYS] = 4 * n,
        [ABI_BUILD_OTHERS] = 4 * n,
        [ABI_BUILD_COUNTS] = digits > children ? digits : children,
        [ABI_BUILD_LINKS] = ABI_BUILD_LINK_WORDS * (n - 1) + n,
        [ABI_BUILD_BOXES] = 6 * (2 * n - 1),
        [ABI_BUILD_STATE] = ABI_STATE_WORDS};
    enum status status = STATUS_OK;
    times->bytes = 0;
    for (int b = 0; b < ABI_BUILD_BINDINGS && !status; b++) {
        status = vk_buffer_grow(tree->vk, sizeof(uint32_t) * words[b], &tree->buffer[b], reason);
        times->bytes += sizeof(uint32_t) * words[b];
    }
    if (!status)
        status = vk_buffer_write(tree->vk, tree->buffer[ABI_BUILD_VERTICES], 0, scene->vertex,
                                 sizeof(uint32_t) * words[ABI_BUILD_VERTICES], reason);
    if (!status)
        status = vk_buffer_write(tree->vk, tree->buffer[ABI_BUILD_INDICES], 0, scene->index,
                                 sizeof(uint32_t) * words[ABI_BUILD_INDICES], reason);
    for (int b = ABI_BUILD_KEYS; b <= ABI_BUILD_BOXES && !status; b++)
        status = device_tree_poison(tree, tree->buffer[b], sizeof(uint32_t) * words[b], reason);
    return status;
}

static enum status run(struct device_tree *tree, const struct vk_step *step, uint32_t count,
                       uint64_t *ns, struct reason *reason)
{
    struct vk_time time = {0};
    enum status status = vk_dispatch_series(tree->vk, tree->buffer, step, count, &time, reason);
    *ns = time.ns;
    return status;
}

static enum status run_codes(struct device_tree *tree, const struct build_push *push, uint64_t *ns,
                             struct reason *reason)
{
    static const uint32_t state[ABI_STATE_WORDS] = {UINT32_MAX, UINT32_MAX, UINT32_MAX};
    const uint32_t groups = groups_of(push->count, ABI_BUILD_GROUP);
    const struct vk_step step[] = {
        {.pipeline = tree->kernel[BOUNDS],
         .push = push,
         .groups = groups,
         .update = tree->buffer[ABI_BUILD_STATE],
         .bytes = state,
         .byte_count = sizeof state},
        {.pipeline = tree->kernel[CODES], .push = push, .groups = groups}};
    return run(tree, step, ARRAY_COUNT(step), ns, reason);
}

/* An even number of passes, so that the keys end where they began. */
static enum status run_sort(struct device_tree *tree, const struct build_push *push, uint64_t *ns,
                            struct reason *reason)
{
    struct build_push pass[STEPS_MOST / 3];
    struct vk_step step[STEPS_MOST];
    const uint32_t passes = (push->axis_bits > 10 ? 64 : 32) / ABI_BUILD_DIGIT;
    for (uint32_t p = 0; p < passes; p++) {
        pass[p] = *push;
        pass[p].shift = ABI_BUILD_DIGIT * p;
        pass[p].swapped = p % 2;
        for (uint32_t k = 0; k < 3; k++)
            step[3 * p + k] = (struct vk_step){.pipeline = tree->kernel[COUNT + k],
                                               .push = &pass[p],
                                               .groups = k == 1 ? 1 : push->blocks};
    }
    return run(tree, step, 3 * passes, ns, reason);
}

static enum status run_one(struct device_tree *tree, enum kernel kernel,
                           const struct build_push *push, uint64_t *ns, struct reason *reason)
{
    const struct vk_step step = {.pipeline = tree->kernel[kernel],
                                 .push = push,
                                 .groups = groups_of(push->count, ABI_BUILD_GROUP)};
    return run(tree, &step, 1, ns, reason);
}

static enum status run_all(struct device_tree *tree, enum staged_kind kind,
                           const struct build_push *push, struct device_times *times,
                           struct reason *reason)
{
    enum status status = run_codes(tree, push, &times->ns[DEVICE_CODES], reason);
    if (!status)
        status = run_sort(tree, push, &times->ns[DEVICE_ORDER], reason);
    if (!status)
        status = run_one(tree, LINKS, push, &times->ns[DEVICE_LINKS], reason);
    if (!status)
        status = run_one(tree, kind == STAGED_HPLOC ? CLUSTERS : BOXES, push,
                         &times->ns[DEVICE_BOXES], reason);
    return status;
}

/* --- reading back ----------------------------------------------------------------------------- */

static enum status read_keys(struct device_tree *tree, struct staged *out, uint32_t *room,
                             struct reason *reason)
{
    const uint32_t n = out->count;
    enum status status = vk_buffer_read(tree->vk, tree->buffer[ABI_BUILD_KEYS], 0, room,
                                        4 * sizeof *room * (uint64_t)n, reason);
    if (status)
        return status;
    memset(out->code, 0, n * sizeof *out->code);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t *key = room + 4 * (size_t)i;
        out->order[i] = key[2];
        if (key[2] < n)
            out->code[key[2]] = (uint64_t)key[0] << 32 | key[1];
    }
    return STATUS_OK;
}

static enum status read_links(struct device_tree *tree, bool clusters, struct staged *out,
                              uint32_t *room, struct reason *reason)
{
    const size_t words = clusters ? 2 : ABI_BUILD_LINK_WORDS;
    struct vk_buffer *from = tree->buffer[clusters ? ABI_BUILD_COUNTS : ABI_BUILD_LINKS];
    const uint32_t inner = out->count - 1;
    enum status status = STATUS_OK;
    if (inner > 0)
        status = vk_buffer_read(tree->vk, from, 0, room, words * sizeof *room * inner, reason);
    for (uint32_t i = 0; i < inner && !status; i++)
        memcpy(out->child[i], room + words * i, sizeof out->child[i]);
    return status;
}

static enum status read_all(struct device_tree *tree, bool clusters, struct staged *out,
                            struct reason *reason)
{
    uint32_t *room = malloc(ABI_BUILD_LINK_WORDS * sizeof *room * (size_t)out->count);
    if (!room)
        return fail(reason, STATUS_MEMORY, "no memory for a tree of %u triangles", out->count);
    enum status status = read_keys(tree, out, room, reason);
    if (!status)
        status = read_links(tree, clusters, out, room, reason);
    if (!status)
        status = vk_buffer_read(tree->vk, tree->buffer[ABI_BUILD_BOXES], 0, out->box,
                                sizeof *out->box * (2 * (uint64_t)out->count - 1), reason);
    if (!status)
        status =
            vk_buffer_read(tree->vk, tree->buffer[ABI_BUILD_STATE],
                           ABI_STATE_ROOT * sizeof out->root, &out->root, sizeof out->root, reason);
    free(room);
    return status;
}

enum status device_tree_messages(struct device_tree *tree, struct reason *reason)
{
    struct reason first;
    uint32_t count = vk_messages(tree->vk, &first);
    return count ? fail(reason, STATUS_DEVICE, "%u validation messages, the first: %s", count,
                        first.text)
                 : STATUS_OK;
}

enum status device_tree_build(struct device_tree *tree, enum staged_kind kind,
                              const struct scene *scene, struct staged *out,
                              struct device_times *times, struct reason *reason)
{
    struct device_times unused;
    const struct build_push push = {.count = scene->tri_count,
                                    .axis_bits = kind == STAGED_LBVH30 ? 10 : 21,
                                    .blocks = groups_of(scene->tri_count, BLOCK)};
    times = times ? times : &unused;
    *times = (struct device_times){0};
    *out = (struct staged){0};
    tree->built = false;
    if (scene->tri_count > STAGED_MOST)
        return fail(reason, STATUS_LIMIT, "a tree in stages holds at most 2^30 triangles, not %u",
                    scene->tri_count);
    tree->count = scene->tri_count;
    tree->built = scene->tri_count == 0;
    tree->links_in_counts = kind == STAGED_HPLOC;
    if (scene->tri_count == 0)
        return STATUS_OK;
    if (staged_alloc(scene->tri_count, out))
        return fail(reason, STATUS_MEMORY, "no memory for a tree of %u triangles",
                    scene->tri_count);
    enum status status = make_buffers(tree, scene, times, reason);
    if (!status)
        status = run_all(tree, kind, &push, times, reason);
    if (!status)
        status = read_all(tree, kind == STAGED_HPLOC, out, reason);
    if (!status)
        status = device_tree_messages(tree, reason);
    tree->built = status == STATUS_OK;
    if (status)
        staged_free(out);
    return status;
}
