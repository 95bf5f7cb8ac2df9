#include "gpu/build/wide_compare.h"

#include "ref/store.h"

#include <stdio.h>

const char *const wide_part_names[WIDE_PARTS] = {"wide", "words"};

/* What C makes. */
struct wide_twin {
    struct staged_wide wide;
    struct packed packed;
};

static enum status make_twin(const struct layout *layout, const struct staged *staged,
                             const struct scene *scene, struct wide_twin *out,
                             uint64_t ns[WIDE_PARTS], struct reason *reason)
{
    struct wide_tree tree = {0};
    uint64_t start = time_ns();
    *out = (struct wide_twin){.packed.store = tri_stores[0]};
    enum status status = staged_wide_make(staged, layout->width, layout->leaf_most, &out->wide);
    ns[WIDE_COLLAPSE] = time_ns() - start;
    if (!status)
        status = staged_wide_tree(&out->wide, staged, &tree);
    if (status)
        return fail(reason, status, "no memory for a wide tree of %u triangles", staged->count);
    start = time_ns();
    if (tree.node_count > 0)
        status = layout->pack_tree(layout, &tree, out->wide.item, out->wide.item_count, scene,
                                   &out->packed, reason);
    ns[WIDE_WORDS] = time_ns() - start;
    out->packed.layout = layout;
    wide_tree_free(&tree);
    return status;
}

struct staged_difference wide_words_compare(const uint32_t *word, uint32_t word_count,
                                            const struct packed *packed)
{
    const uint32_t words = packed->layout->node_bytes / 4;
    struct staged_difference at = {0};
    if (word_count != packed->word_count) {
        at = (struct staged_difference){.stage = "words", .count = 1};
        snprintf(at.text, sizeof at.text, "%u words, not %u", word_count, packed->word_count);
        return at;
    }
    for (uint32_t i = 0; i < word_count; i++) {
        if (word[i] == packed->word[i])
            continue;
        if (at.count++ > 0)
            continue;
        at.stage = "words";
        at.element = i / words;
        snprintf(at.text, sizeof at.text, "word %u of the record is %08x, not %08x", i % words,
                 word[i], packed->word[i]);
    }
    return at;
}

static struct staged_difference compare(const struct device_wide *devices,
                                        const struct wide_twin *twin)
{
    struct staged_difference at = staged_wide_compare(&devices->wide, &twin->wide);
    return at.stage ? at : wide_words_compare(devices->word, devices->word_count, &twin->packed);
}

/* What both sides' statuses come to: only a limit of both is none. */
static enum status settle(const struct layout *layout, enum status devices, enum status mine,
                          const struct reason *theirs, const struct reason *ours,
                          struct wide_result *out, struct reason *reason)
{
    if (mine && mine != STATUS_LIMIT)
        return fail(reason, mine, "%s", ours->text);
    if (mine && !devices)
        return fail(reason, STATUS_DEVICE, "%s: the device encodes what C refuses: %s",
                    layout->name, ours->text);
    if (devices && !mine)
        return fail(reason, devices, "%s", theirs->text);
    if (devices)
        out->refused = *theirs;
    return STATUS_OK;
}

enum status wide_compare(struct device_tree *tree, const struct layout *layout,
                         const struct staged *mine, const struct scene *scene,
                         struct wide_result *out, struct reason *reason)
{
    struct device_wide devices;
    struct device_wide_times times;
    struct wide_twin twin;
    struct reason theirs = {""}, ours = {""};
    *out = (struct wide_result){0};
    enum status status = device_wide_make(tree, layout, &devices, &times, &theirs);
    if (status && status != STATUS_LIMIT)
        return fail(reason, status, "%s", theirs.text);
    enum status expected = make_twin(layout, mine, scene, &twin, out->c_ns, &ours);
    bool both = !status && !expected;
    status = settle(layout, status, expected, &theirs, &ours, out, reason);
    if (both)
        out->differs = compare(&devices, &twin);
    out->nodes = twin.wide.node_count;
    out->device_ns[WIDE_COLLAPSE] = times.collapse_ns;
    out->device_ns[WIDE_WORDS] = times.encode_ns;
    out->device_bytes = times.bytes;
    device_wide_free(&devices);
    staged_wide_free(&twin.wide);
    packed_free(&twin.packed);
    return status;
}
