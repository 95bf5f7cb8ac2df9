#include "ref/cmd_tree.h"

#include <stdio.h>
#include <stdlib.h>

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
