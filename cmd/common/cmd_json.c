#include "cmd/common/cmd_json.h"

#include "cmd/common/cmd_options.h"
#include "ref/base/command.h"
#include "ref/match/turnout.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

json_t *json_number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

json_t *json_float(float x)
{
    char bits[16];
    snprintf(bits, sizeof bits, "0x%08x", float_bits(x));
    return json_pack("{s:o, s:s}", "value", json_number((double)x), "bits", bits);
}

json_t *json_floats(const float *x, size_t count)
{
    json_t *out = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(out, json_float(x[i]));
    return out;
}

json_t *json_prim(uint32_t prim)
{
    return prim == ABI_NO_PRIM ? json_null() : json_integer((json_int_t)prim);
}

json_t *json_hit(const struct hit *hit)
{
    return json_pack("{s:o, s:o, s:o, s:o}", "prim", json_prim(hit->prim), "t", json_float(hit->t),
                     "u", json_float(hit->u), "v", json_float(hit->v));
}

json_t *json_turnout(const struct turnout *turnout)
{
    json_t *out = json_array();
    for (size_t i = 0; i < turnout->count; i++) {
        const struct turnout_one *one = &turnout->one[i];
        json_array_append_new(
            out, json_pack("{s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:b, s:s}", "kind", one->kind,
                           "name", one->name, "asked", (json_int_t)turnout_asked(one), "answered",
                           (json_int_t)one->end[TURNOUT_ANSWERED], "refused",
                           (json_int_t)one->end[TURNOUT_REFUSED], "skipped",
                           (json_int_t)(one->end[TURNOUT_SKIPPED] + one->end[TURNOUT_ABSENT]),
                           "failed", (json_int_t)one->end[TURNOUT_FAILED], "vacuous",
                           turnout_code(one) == EXIT_MISMATCH, "reason", one->reason.text));
    }
    return out;
}

enum status json_write(const char *path, json_t *root, unsigned digits, struct reason *reason)
{
    struct file_out out = {.stream = NULL};
    enum status status = options_out(path, &out, reason);
    if (status == STATUS_OK)
        return json_write_out(&out, root, digits, reason);
    json_decref(root);
    return status;
}

enum status json_write_out(struct file_out *out, json_t *root, unsigned digits,
                           struct reason *reason)
{
    char *text = root ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(digits)) : NULL;
    json_decref(root);
    if (!text) {
        file_out_discard(out);
        return fail(reason, STATUS_MEMORY, "no memory for the JSON");
    }
    fputs(text, out->stream);
    fputc('\n', out->stream);
    free(text);
    return file_out_commit(out, reason);
}
