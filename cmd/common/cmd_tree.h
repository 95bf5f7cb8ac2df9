/* The option --bvh FILE of commands that use a tree. For commands only. */
#ifndef CMD_TREE_H
#define CMD_TREE_H

#include "cmd/common/cmd_options.h"
#include "cmd/common/cmd_tables.h"
#include "ref/packed/tree_file.h"

/* Rejects options that contradict --bvh `path` (NULL: not given): builder options, --store, and
 * several scenes. Errors: STATUS_INPUT. */
enum status tree_check_options(const char *path, size_t scene_count,
                               struct reason *reason) MUST_USE;

/* Reads the tree of a scene. If the tree is doubtful, prints a warning. *out borrows `path`.
 * Errors: STATUS_INPUT no such file; as tree_file_read. On error *out is zero. */
enum status tree_open(const char *command, const char *path, const struct scene *scene,
                      struct tree_file *out, struct reason *reason) MUST_USE;

/* The layouts of a run without --layout: that of a packed tree, or `list` for a tree as JSON. */
struct list tree_layouts(const struct tree_file *file, const struct list *list);

#endif
