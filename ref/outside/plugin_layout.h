/* Layouts from outside (ref/plugin.h) as layouts of the table. Everything that a plugin returns is
 * checked before it is used: its numbers can make raydiff refuse a tree, never read outside one. */
#ifndef PLUGIN_LAYOUT_H
#define PLUGIN_LAYOUT_H

#include "ref/layout.h"
#include "ref/plugin.h"
#include "ref/packed/packed_check.h"

/* Checks the layout that a shared object describes, and adds it to layouts_all. `plugin` and its
 * texts are borrowed for as long as the program runs.
 *   name   of the file, for reasons
 * Errors: STATUS_INPUT "NAME: rule"; as layout_add. */
enum status plugin_layout_add(const char *name, const struct raydiff_plugin *plugin,
                              const struct layout **out, struct reason *reason) MUST_USE;

/* A packed tree as plugins see it; arrays are borrowed. */
struct raydiff_packed plugin_view(const struct packed *packed);

/* The first half of plugin_layout_add. */
enum status plugin_check(const char *name, const struct raydiff_plugin *plugin,
                         struct reason *reason) MUST_USE;

/* Packs and checks, here and now: counts and references of every record that can be reached, then
 * packed_check; boxes that do not contain what is below are excused if the tree's own do not.
 * Sets what layout->pack sets. Errors: STATUS_LIMIT the plugin's, with its reason; STATUS_INPUT
 * what the check found, with the record, and the rule in *rule; STATUS_MEMORY. On error *out is
 * zero. */
enum status plugin_pack(const struct layout *layout, const struct bvh *bvh,
                        const struct scene *scene, struct packed *out, enum packed_rule *rule,
                        struct reason *reason) MUST_USE;

/* How layout->pack of a layout from outside packs; plugin_pack unless a program sets another
 * (ref/outside/plugin_guard.h does it in another process). Errors: as plugin_pack; STATUS_DEVICE it
 * crashed or did not end. */
typedef enum status plugin_pack_fn(const struct layout *layout, const struct bvh *bvh,
                                   const struct scene *scene, struct packed *out,
                                   enum packed_rule *rule, struct reason *reason);
void plugin_pack_with(plugin_pack_fn *pack);

/* The rule that the last tree of this thread broke that a layout from outside packed; PACKED_SOUND:
 * none. */
enum packed_rule plugin_rule(void);

#endif
