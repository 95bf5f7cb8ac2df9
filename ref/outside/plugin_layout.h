/* Plugin layouts (ref/plugin.h) as layouts of the table. All that a plugin returns is checked
 * before it is used: its numbers can make raydiff reject a tree, but never read outside one. */
#ifndef PLUGIN_LAYOUT_H
#define PLUGIN_LAYOUT_H

#include "ref/layout.h"
#include "ref/plugin.h"
#include "ref/packed/packed_check.h"

/* Checks a plugin and adds its layout to layouts_all. `plugin` and its strings are borrowed until
 * the program ends. `name` is the file's, for reasons.
 * Errors: STATUS_INPUT "NAME: rule"; as layout_add. */
enum status plugin_layout_add(const char *name, const struct raydiff_plugin *plugin,
                              const struct layout **out, struct reason *reason) MUST_USE;

/* Returns a packed tree in the form that plugins read; its arrays are borrowed. */
struct raydiff_packed plugin_view(const struct packed *packed);

/* The check of plugin_layout_add. */
enum status plugin_check(const char *name, const struct raydiff_plugin *plugin,
                         struct reason *reason) MUST_USE;

/* Packs and checks in this process: counts and references of every reachable record, then
 * packed_check. Boxes that do not contain their children are accepted if the tree's own boxes do
 * not. Sets what layout->pack sets. Errors: STATUS_LIMIT the plugin's, with its reason;
 * STATUS_INPUT what the check found, with the record, and the rule in *rule; STATUS_MEMORY. On
 * error *out is zero. */
enum status plugin_pack(const struct layout *layout, const struct bvh *bvh,
                        const struct scene *scene, struct packed *out, enum packed_rule *rule,
                        struct reason *reason) MUST_USE;

/* Sets how layout->pack of plugin layouts packs. The default is plugin_pack;
 * ref/outside/plugin_guard.h packs in another process. Errors: as plugin_pack; STATUS_DEVICE it
 * crashed or did not end. */
typedef enum status plugin_pack_fn(const struct layout *layout, const struct bvh *bvh,
                                   const struct scene *scene, struct packed *out,
                                   enum packed_rule *rule, struct reason *reason);
void plugin_pack_with(plugin_pack_fn *pack);

/* The rule that this thread's last plugin-packed tree broke; PACKED_SOUND: none. */
enum packed_rule plugin_rule(void);

#endif
