/* The option --bvh FILE of commands that use a tree. For commands only. */
#ifndef CMD_TREE_H
#define CMD_TREE_H

#include "cmd/common/cmd_options.h"
#include "cmd/common/cmd_tables.h"
#include "ref/packed/tree_file.h"

/* Refuses what contradicts --bvh `path` (NULL: not given): flags of builders that were given, and
 * several scenes. Errors: STATUS_INPUT. */
enum status tree_check_options(const char *path, size_t scene_count,
                               struct reason *reason) MUST_USE;

/* Reads the tree of a scene and prints its doubt, if any, as a warning. `path` is borrowed by
 * *out. Errors: STATUS_INPUT no such file; as tree_file_read. On error *out is zero. */
enum status tree_open(const char *command, const char *path, const struct scene *scene,
                      struct tree_file *out, struct reason *reason) MUST_USE;

/* The layout of a packed tree as a list of one; of a JSON tree `list`. For runs without --layout. */
struct list tree_layouts(const struct tree_file *file, const struct list *list);

#endif
