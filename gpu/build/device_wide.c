#include "gpu/build/device_wide.h"

#include "gpu/build/device_tree_inner.h"

#include <stdlib.h>
#include <string.h>

#define LARGEST     0x71800000u /* 2^100, the largest magnitude of a bound */
#define LEVEL_STEPS 3u
#define LEVELS_MOST 12u /* in a submission; of 100,000 triangles there are about seven */

static const struct {
    const char *name;
    uint32_t id;
} layouts_here[] = {{"cwbvh80", ABI_WIDE_CWBVH80},
                    {"tiny8", ABI_WIDE_TINY8},
                    {"tiny8_l8", ABI_WIDE_TINY8},
                    {"tiny8_l14", ABI_WIDE_TINY8}};

struct wide_run {
    struct device_tree *tree;
    const struct layout *layout;
    struct vk_buffer *buffer[ABI_BUILD_BINDINGS]; /* borrowed: as they are bound */
    struct build_push push;
    uint32_t node_count;
};

bool device_encodes(const struct layout *layout)
{
    for (size_t i = 0; i < ARRAY_COUNT(layouts_here); i++)
        if (layout == layout_find(layouts_here[i].name))
            return true;
    return false;
}

static uint32_t id_of(const struct layout *layout)
{
    size_t i = 0;
    while (layout != layout_find(layouts_here[i].name))
        i++;
    return layouts_here[i].id;
}

void device_wide_free(struct device_wide *wide)
{
    staged_wide_free(&wide->wide);
    free(wide->word);
    *wide = (struct device_wide){0};
}

/* The bounds of the scene are those of its root's children. */
static enum status check_bounds(const struct wide_run *run, struct reason *reason)
{
    uint32_t bound[ABI_STATE_ROOT];
    enum status status = vk_buffer_read(run->tree->vk, run->tree->buffer[ABI_BUILD_STATE], 0, bound,
                                        sizeof bound, reason);
    for (size_t i = 0; i < ARRAY_COUNT(bound) && !status; i++) {
        uint32_t magnitude = bound[i] >> 31 ? bound[i] & 0x7FFFFFFFu : ~bound[i] & 0x7FFFFFFFu;
        if (magnitude > LARGEST)
            status = fail(reason, STATUS_LIMIT,
                          "%s: a bound is at most %.9g in magnitude, the scene has %.9g; scale or "
                          "move the scene, or use layout f32",
                          run->layout->name, (double)float_from_bits(LARGEST),
                          (double)float_from_bits(magnitude));
    }
    return status;
}

/* Those of the build, but for what stands elsewhere; with other words where results will stand. */
static enum status make_buffers(struct wide_run *run, struct device_wide_times *times,
                                struct reason *reason)
{
    struct device_tree *tree = run->tree;
    const uint64_t words[DEVICE_WIDE_BUFFERS] = {
        (uint64_t)run->push.blocks * (run->layout->node_bytes / 4), run->push.count,
        ABI_WIDE_WORDS * (uint64_t)run->push.blocks};
    const int binding[DEVICE_WIDE_BUFFERS] = {ABI_WIDE_PACKED, ABI_WIDE_ITEMS, ABI_WIDE_NODES};
    enum status status = STATUS_OK;
    times->bytes = 0;
    memcpy(run->buffer, tree->buffer, sizeof run->buffer);
    for (int b = 0; b < DEVICE_WIDE_BUFFERS && !status; b++) {
        const uint64_t bytes = sizeof(uint32_t) * words[b];
        status = vk_buffer_grow(tree->vk, bytes, &tree->wide[b], reason);
        if (!status)
            status = device_tree_poison(tree, tree->wide[b], bytes, reason);
        run->buffer[binding[b]] = tree->wide[b];
        times->bytes += bytes;
    }
    return status;
}

/* Runs the steps, adding to *ns. */
static enum status submit(struct wide_run *run, const struct vk_step *step, uint32_t count,
                          uint64_t *ns, struct reason *reason)
{
    struct vk_time time = {0};
    enum status status = vk_dispatch_series(run->tree->vk, run->buffer, step, count, &time, reason);
    *ns += time.ns;
    return status;
}

/* Appends the steps of levels; the first of them is even. */
static uint32_t add_levels(struct wide_run *run, const struct build_push push[2],
                           struct vk_step *step, uint32_t count)
{
    static const enum kernel kernels[LEVEL_STEPS] = {OPEN, LEVEL, PLACE};
    struct vk_buffer *state = run->tree->buffer[ABI_BUILD_STATE];
    for (uint32_t level = 0; level < LEVELS_MOST; level++)
        for (uint32_t k = 0; k < LEVEL_STEPS; k++) {
            const uint32_t words = ABI_STATE_LEVEL + level % 2 * ABI_LEVEL_WORDS + ABI_LEVEL_GROUPS;
            step[count++] = (struct vk_step){.pipeline = run->tree->kernel[kernels[k]],
                                             .push = &push[level % 2],
                                             .groups = 1,
                                             .groups_of = kernels[k] == LEVEL ? NULL : state,
                                             .groups_at = sizeof(uint32_t) * words};
        }
    return count;
}

/* Level by level, as many as there are. An even number of them is in a submission. A device whose
 * levels do not go on, or go on beyond the most nodes, is not waited for. */
_Static_assert(LEVELS_MOST % 2 == 0, "levels begin with an even one");
_Static_assert(2 + LEVEL_STEPS * LEVELS_MOST <= VK_SERIES_MAX, "a submission holds them");
static enum status collapse(struct wide_run *run, uint64_t *ns, struct reason *reason)
{
    struct device_tree *tree = run->tree;
    const uint32_t groups = groups_of(run->push.count, ABI_BUILD_GROUP);
    struct build_push push[3] = {run->push, run->push, run->push};
    struct vk_step step[VK_SERIES_MAX];
    uint32_t level[ABI_LEVEL_WORDS], count = 2, before = 0;
    enum status status = STATUS_OK;
    push[1].swapped = 1;
    push[2].swapped = tree->links_in_counts;
    step[0] = (struct vk_step){.pipeline = tree->kernel[ADOPT], .push = &push[2], .groups = groups};
    step[1] = (struct vk_step){.pipeline = tree->kernel[SIZES], .push = push, .groups = groups};
    do {
        before = run->node_count;
        count = add_levels(run, push, step, count);
        status = submit(run, step, count, ns, reason);
        tree->links_in_counts = false;
        if (!status)
            status = vk_buffer_read(tree->vk, tree->buffer[ABI_BUILD_STATE],
                                    ABI_STATE_LEVEL * sizeof *level, level, sizeof level, reason);
        if (!status && level[ABI_LEVEL_FIRST] <= run->push.blocks)
            run->node_count = level[ABI_LEVEL_FIRST];
        count = 0;
    } while (!status && level[ABI_LEVEL_COUNT] > 0 && run->node_count > before);
    return status || run->node_count > 0
               ? status
               : fail(reason, STATUS_DEVICE, "%s: the device made no node", run->layout->name);
}

static enum status encode(struct wide_run *run, uint64_t *ns, struct reason *reason)
{
    struct build_push push = run->push;
    const struct vk_step step = {.pipeline = run->tree->kernel[ENCODE],
                                 .push = &push,
                                 .groups = groups_of(run->node_count, ABI_BUILD_GROUP)};
    push.blocks = run->node_count;
    return submit(run, &step, 1, ns, reason);
}

/* --- reading back ----------------------------------------------------------------------------- */

static void take_node(const uint32_t *node, uint32_t n, struct staged_wide *out)
{
    uint32_t next_node = node[ABI_WIDE_FIRST], next_item = node[ABI_WIDE_ITEM];
    out->node[n] = (struct wide_node){out->child_count, 0};
    for (uint32_t s = 0; s < ABI_WIDE_MOST; s++) {
        const uint32_t kind = node[ABI_WIDE_KINDS] >> 4 * s & 15u;
        struct staged_child *child = &out->child[out->child_count];
        if (kind == 0)
            continue;
        if (kind == ABI_WIDE_NODE)
            *child = (struct staged_child){node[ABI_WIDE_LINKS + s], next_node++, 0};
        else
            *child = (struct staged_child){node[ABI_WIDE_LINKS + s], next_item, kind};
        next_item += child->count;
        out->node[n].count++;
        out->child_count++;
    }
}

static enum status read_wide(struct wide_run *run, struct device_wide *out, struct reason *reason)
{
    struct device_tree *tree = run->tree;
    const uint32_t nodes = run->node_count;
    uint32_t *room = malloc(ABI_WIDE_WORDS * sizeof *room * ((size_t)nodes + 1));
    out->word_count = nodes * (run->layout->node_bytes / 4);
    out->word = malloc(sizeof *out->word * ((size_t)out->word_count + 1));
    enum status status =
        staged_wide_alloc(nodes, ABI_WIDE_MOST * nodes, run->push.count, &out->wide);
    if (!room || !out->word || status) {
        free(room);
        return fail(reason, STATUS_MEMORY, "no memory for a tree of %u nodes", nodes);
    }
    out->wide.child_count = 0;
    status = vk_buffer_read(tree->vk, run->buffer[ABI_WIDE_NODES], 0, room,
                            ABI_WIDE_WORDS * sizeof *room * (uint64_t)nodes, reason);
    for (uint32_t n = 0; n < nodes && !status; n++)
        take_node(room + ABI_WIDE_WORDS * (size_t)n, n, &out->wide);
    if (!status)
        status = vk_buffer_read(tree->vk, run->buffer[ABI_WIDE_ITEMS], 0, out->wide.item,
                                sizeof *out->wide.item * (uint64_t)run->push.count, reason);
    if (!status)
        status = vk_buffer_read(tree->vk, run->buffer[ABI_WIDE_PACKED], 0, out->word,
                                sizeof *out->word * (uint64_t)out->word_count, reason);
    free(room);
    return status;
}

enum status device_wide_make(struct device_tree *tree, const struct layout *layout,
                             struct device_wide *out, struct device_wide_times *times,
                             struct reason *reason)
{
    struct wide_run run = {.tree = tree, .layout = layout};
    *out = (struct device_wide){0};
    *times = (struct device_wide_times){0};
    if (!device_encodes(layout))
        return fail(reason, STATUS_UNSUPPORTED, "layout %s is not encoded on a device",
                    layout->name);
    if (!tree->built)
        return fail(reason, STATUS_UNSUPPORTED, "the device has no tree");
    if (tree->count == 0)
        return STATUS_OK;
    run.push = (struct build_push){
        .count = tree->count,
        .axis_bits = id_of(layout),
        .shift = layout->leaf_most,
        .blocks = staged_wide_nodes_most(tree->count, layout->width, layout->leaf_most)};
    enum status status = check_bounds(&run, reason);
    if (!status)
        status = make_buffers(&run, times, reason);
    for (int k = ADOPT; k <= ENCODE && !status; k++)
        status = device_tree_kernel(tree, (enum kernel)k, reason);
    if (!status)
        status = collapse(&run, &times->collapse_ns, reason);
    if (!status)
        status = encode(&run, &times->encode_ns, reason);
    if (!status)
        status = read_wide(&run, out, reason);
    if (!status)
        status = device_tree_messages(tree, reason);
    if (status)
        device_wide_free(out);
    return status;
}
