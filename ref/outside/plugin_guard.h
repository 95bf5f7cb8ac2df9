/* Opens layouts from outside (ref/plugin.h) from their shared objects. All that they do for the
 * first time is done in a child process: a crash, a hang or running out of memory becomes a status.
 * For programs. */
#ifndef PLUGIN_GUARD_H
#define PLUGIN_GUARD_H

#include "ref/outside/plugin_layout.h"
#include "ref/packed/packed_check.h"

#define PLUGIN_SUFFIX  ".so"
#define PLUGIN_MS      60000u
#define PLUGIN_MB      8192u
#define PLUGIN_OPEN_MS 10000u /* limit of opening, even if packing has more */

/* What a plugin may take from now on to pack a tree: time, and memory beside what there is. 0: as
 * above; memory of UINT32_MAX: no limit. */
void plugin_limits(uint32_t ms, uint32_t megabytes);

/* Opens the shared object, first in a child, and adds its layout to layouts_all; a path
 * that was opened before gives the same layout. It stays open until the program ends. From the
 * first on, layouts from outside pack in a child, which checks, too; the words that it sends are
 * what is used. In this process runs then only what was tried there on the same bytes: load, box
 * and item.
 * Opening it here is what was tried there, but it may still hang: then the process is ended with a
 * line and exit code 3.
 * Errors: STATUS_INPUT no regular file, cannot be opened, has no raydiff_plugin, as
 * plugin_layout_add;
 * STATUS_DEVICE it crashed or did not end; STATUS_MEMORY. */
enum status plugin_open(const char *path, const struct layout **out,
                        struct reason *reason) MUST_USE;

/* Packs in a child: what plugin_open has layouts from outside pack with (plugin_pack_with).
 * Errors: as plugin_pack; STATUS_DEVICE it crashed or did not end. */
enum status plugin_pack_guarded(const struct layout *layout, const struct bvh *bvh,
                                const struct scene *scene, struct packed *out,
                                enum packed_rule *rule, struct reason *reason) MUST_USE;

/* Whether the last STATUS_DEVICE of a packing was that it took too long. */
bool plugin_hung(void);

/* The path that the layout was opened from, as it was given; NULL: it is none from outside. */
const char *plugin_path(const struct layout *layout);

#endif
