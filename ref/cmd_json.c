#include "ref/cmd_json.h"

#include <stdlib.h>

enum status json_write_to(struct file_out *out, const char *path, json_t *root, unsigned digits,
                          struct reason *reason)
{
    char *text = root ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(digits)) : NULL;
    json_decref(root);
    if (!text)
        return fail(reason, STATUS_MEMORY, "%s: no memory for the JSON", path);
    enum status status = out->stream ? STATUS_OK : file_out_open(path, out, reason);
    if (status == STATUS_OK) {
        fputs(text, out->stream);
        fputc('\n', out->stream);
        status = file_out_commit(out, reason);
    }
    free(text);
    return status;
}

enum status json_write(const char *path, json_t *root, unsigned digits, struct reason *reason)
{
    struct file_out out = {.stream = NULL};
    return json_write_to(&out, path, root, digits, reason);
}
