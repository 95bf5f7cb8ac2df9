/* Opens plugin layouts (ref/plugin.h) from shared objects. A plugin's code first runs in a child
 * process, so that a crash, a hang or running out of memory becomes a status. For programs. */
#ifndef PLUGIN_GUARD_H
#define PLUGIN_GUARD_H

#include "ref/outside/plugin_layout.h"
#include "ref/packed/packed_check.h"

#define PLUGIN_SUFFIX  ".so"
#define PLUGIN_MS      60000u
#define PLUGIN_MB      8192u
#define PLUGIN_OPEN_MS 10000u /* limit of opening, also if packing has more time */

/* Sets the limits for packing a tree from now on: time, and memory beyond what the process has. 0:
 * the defaults above; memory of UINT32_MAX: no limit. */
void plugin_limits(uint32_t ms, uint32_t megabytes);

/* Opens a shared object, first in a child, and adds its layout to layouts_all. A path that was
 * opened before returns the same layout. It stays open until the program ends. From the first call
 * on, plugin layouts pack in a child, which also checks the tree. This process uses the words that
 * the child sends, and calls only what was called there on the same bytes: load, box and item.
 * Opening it in this process repeats what worked in the child, but may still hang. Then the process
 * ends with a message and exit code 3.
 * Errors: STATUS_INPUT no regular file, cannot be opened, has no raydiff_plugin, as
 * plugin_layout_add; STATUS_DEVICE it crashed or did not end; STATUS_MEMORY. */
enum status plugin_open(const char *path, const struct layout **out,
                        struct reason *reason) MUST_USE;

/* Packs in a child; plugin_open passes it to plugin_pack_with. Errors: as plugin_pack;
 * STATUS_DEVICE it crashed or did not end. */
enum status plugin_pack_guarded(const struct layout *layout, const struct bvh *bvh,
                                const struct scene *scene, struct packed *out,
                                enum packed_rule *rule, struct reason *reason) MUST_USE;

/* Returns true if the last STATUS_DEVICE of packing or opening was a timeout. */
bool plugin_hung(void);

/* Returns the path that the layout was opened from, as given; NULL: not a plugin. */
const char *plugin_path(const struct layout *layout);

#endif
