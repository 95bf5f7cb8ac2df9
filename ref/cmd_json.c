#include "ref/cmd_json.h"

#include "ref/cmd_options.h"

#include <stdlib.h>

enum status json_write(const char *path, json_t *root, unsigned digits, struct reason *reason)
{
    struct file_out out = {.stream = NULL};
    char *text = root ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(digits)) : NULL;
    json_decref(root);
    if (!text)
        return fail(reason, STATUS_MEMORY, "%s: no memory for the JSON", path);
    enum status status = options_out(path, &out, reason);
    if (status == STATUS_OK) {
        fputs(text, out.stream);
        fputc('\n', out.stream);
        status = file_out_commit(&out, reason);
    }
    free(text);
    return status;
}
