#include "ref/outside/plugin_layout.h"

#include "ref/outside/shared_object.h"

#include <string.h>

#define NAME_MOST 15 /* limit in files of packed trees (ref/packed/packed_file.h) */

_Static_assert(WIDE_MAX >= RAYDIFF_WIDE_MOST, "a plugin's nodes fit into ours");
_Static_assert(sizeof(struct box) == sizeof(struct raydiff_box), "boxes are the same");

/* --- one node -------------------------------------------------------------------------------- */

static const struct raydiff_plugin *plugin_of(const struct layout *layout)
{
    return layout->family;
}

struct raydiff_packed plugin_view(const struct packed *packed)
{
    return (struct raydiff_packed){.word = packed->word,
                                   .item = packed->item,
                                   .records = packed->node_count,
                                   .items = packed->item_count,
                                   .root = packed->root};
}

/* Checks all that the plugin returns. A node that breaks a rule becomes one without children and
 * items, which packed_walk_make counts as a bad reference. */
static void load(const struct packed *packed, uint32_t ref, struct wide *out)
{
    const struct raydiff_plugin *plugin = plugin_of(packed->layout);
    const struct raydiff_packed as_theirs = plugin_view(packed);
    struct raydiff_wide from;
    from.child_count = from.item_first = from.item_count = 0;
    *out = (struct wide){.child_count = 0};
    plugin->load(&as_theirs, ref, &from);
    if (from.child_count > packed->layout->width)
        return;
    for (uint32_t i = 0; i < from.child_count; i++)
        if (!packed_ref_valid(packed, from.child[i]))
            return;
    out->child_count = from.child_count;
    memcpy(out->box, from.box, from.child_count * sizeof *out->box);
    memcpy(out->child, from.child, from.child_count * sizeof *out->child);
    if (from.child_count == 0) {
        out->item_first = from.item_first;
        out->item_count = from.item_count;
    }
}

/* Returns the box of a child slot from its record. */
static struct box slot_box(const struct packed *packed, uint32_t ref)
{
    struct wide record;
    load(packed, (ref - packed->node_count) / packed->layout->width, &record);
    for (uint32_t i = 0; i < record.child_count; i++)
        if (record.child[i] == ref)
            return record.box[i];
    return box_empty();
}

static struct box box(const struct packed *packed, uint32_t ref)
{
    const struct raydiff_plugin *plugin = plugin_of(packed->layout);
    struct box out = box_empty();
    if (plugin->box) {
        const struct raydiff_packed as_theirs = plugin_view(packed);
        const struct raydiff_box theirs = plugin->box(&as_theirs, ref);
        memcpy(&out, &theirs, sizeof out);
        return out;
    }
    if (ref >= packed->node_count)
        return slot_box(packed, ref);
    struct wide node;
    load(packed, ref, &node);
    for (uint32_t i = 0; i < node.child_count; i++)
        box_add_box(&out, &node.box[i]);
    return out;
}

static uint32_t item(const struct packed *packed, uint32_t slot)
{
    const struct raydiff_plugin *plugin = plugin_of(packed->layout);
    const struct raydiff_packed as_theirs = plugin_view(packed);
    if (plugin->item)
        return plugin->item(&as_theirs, slot);
    return slot < packed->item_count ? packed->item[slot] : ABI_NO_PRIM;
}

/* --- the table ------------------------------------------------------------------------------- */

static plugin_pack_fn *pack_with = plugin_pack;
static _Thread_local enum packed_rule last_rule;

void plugin_pack_with(plugin_pack_fn *pack)
{
    pack_with = pack;
}

static enum status pack(const struct layout *self, const struct bvh *bvh, const struct scene *scene,
                        struct packed *out, struct reason *reason)
{
    last_rule = PACKED_SOUND;
    return pack_with(self, bvh, scene, out, &last_rule, reason);
}

enum packed_rule plugin_rule(void)
{
    return last_rule;
}

/* Words of --layout are no names. */
static bool name_is_fine(const char *name)
{
    return object_name_is_fine(name, NAME_MOST) && strcmp(name, "all") != 0 &&
           strcmp(name, "every") != 0 && strcmp(name, "auto") != 0;
}

enum status plugin_check(const char *name, const struct raydiff_plugin *plugin,
                         struct reason *reason)
{
    if (!plugin)
        return fail(reason, STATUS_INPUT, "%.120s: raydiff_plugin() returns NULL", name);
    if (plugin->version != RAYDIFF_PLUGIN_VERSION || plugin->bytes != sizeof *plugin)
        return fail(reason, STATUS_INPUT,
                    "%.120s: version %u of %u bytes, this raydiff has %u of %zu: compile it with "
                    "its ref/plugin.h",
                    name, plugin->version, plugin->bytes, RAYDIFF_PLUGIN_VERSION, sizeof *plugin);
    if (!name_is_fine(plugin->name))
        return fail(reason, STATUS_INPUT,
                    "%.120s: its name must be a letter, then letters, digits and _, at most %d",
                    name, NAME_MOST);
    if (plugin->width != 2 && plugin->width != 4 && plugin->width != 8)
        return fail(reason, STATUS_INPUT, "%.120s: width %u is not 2, 4 or 8", name, plugin->width);
    if (plugin->node_bytes == 0 || plugin->node_bytes % 16 != 0 || plugin->node_bytes > 1024)
        return fail(reason, STATUS_INPUT,
                    "%.120s: records of %u bytes are not a multiple of 16, 1024 at most", name,
                    plugin->node_bytes);
    if (!plugin->pack || !plugin->load || (plugin->width == 2 && !plugin->box))
        return fail(reason, STATUS_INPUT, "%.120s: it has no %s()", name,
                    !plugin->pack   ? "pack"
                    : !plugin->load ? "load"
                                    : "box");
    return STATUS_OK;
}

static struct layout made[LAYOUTS_ADDED_MOST];
static size_t made_count;

enum status plugin_layout_add(const char *name, const struct raydiff_plugin *plugin,
                              const struct layout **out, struct reason *reason)
{
    *out = NULL;
    enum status status = plugin_check(name, plugin, reason);
    if (status)
        return status;
    if (made_count == ARRAY_COUNT(made))
        return fail(reason, STATUS_LIMIT, "%.120s: more than %zu layouts from outside", name,
                    ARRAY_COUNT(made));
    struct layout *layout = &made[made_count];
    *layout = (struct layout){.name = plugin->name,
                              .summary = plugin->summary ? plugin->summary : "",
                              .node_bytes = plugin->node_bytes,
                              .width = plugin->width,
                              .order = VISIT_NEAR,
                              .outside = true,
                              .family = plugin,
                              .pack = pack,
                              .load = load,
                              .box = box,
                              .item = item};
    status = layout_add(layout, reason);
    if (status)
        return status;
    made_count++;
    *out = layout;
    return STATUS_OK;
}
