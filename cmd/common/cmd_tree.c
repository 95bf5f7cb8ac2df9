#include "cmd/common/cmd_tree.h"

#include "cmd/common/cmd_use.h"

#include <stdio.h>
#include <stdlib.h>

enum status tree_check_options(const char *path, size_t scene_count, struct reason *reason)
{
    static const char builds[] =
        "builder store leaf eps bins radius split-budget split-alpha presplit optimize";
    const char *name;
    for (size_t i = 0; path && (name = option_given(i)) != NULL; i++)
        if (option_among(builds, name))
            return fail(reason, STATUS_INPUT,
                        "--bvh: the tree is built already: it goes without --%s", name);
    if (path && scene_count > 1)
        return fail(reason, STATUS_INPUT, "--bvh: a tree belongs to one scene, not to %zu",
                    scene_count);
    return STATUS_OK;
}

enum status tree_open(const char *command, const char *path, const struct scene *scene,
                      struct tree_file *out, struct reason *reason)
{
    char *bytes;
    size_t size;
    *out = (struct tree_file){0};
    enum status status = file_read(path, &bytes, &size, reason);
    if (status)
        return status;
    status = tree_file_read(file_label(path), bytes, size, scene, out, reason);
    free(bytes);
    if (!status)
        out->name = path;
    if (!status && out->doubt.text[0])
        fprintf(stderr, "raydiff %s: warning: %s\n", command, out->doubt.text);
    return status;
}

struct list tree_layouts(const struct tree_file *file, const struct list *list)
{
    return tree_file_is_packed(file) ? list_of_one(TABLE_LAYOUTS, file->packed.layout) : *list;
}
