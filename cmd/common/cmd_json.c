#include "cmd/common/cmd_json.h"

#include "cmd/common/cmd_options.h"
#include "ref/base/command.h"
#include "ref/match/turnout.h"
#include "ref/base/json_record.h"

#include <stdio.h>
#include <stdlib.h>

json_t *json_bits(float x)
{
    return json_sprintf("0x%08x", float_bits(x));
}

json_t *json_ray_bits(const struct ray *ray)
{
    const float value[8] = {ray->org[0], ray->org[1], ray->org[2], ray->tmin,
                            ray->dir[0], ray->dir[1], ray->dir[2], ray->tmax};
    json_t *out = json_array();
    for (size_t i = 0; i < ARRAY_COUNT(value); i++)
        json_array_append_new(out, json_bits(value[i]));
    return out;
}

json_t *json_float(float x)
{
    return json_record("value=%g bits=%p", (double)x, json_bits(x));
}

json_t *json_verdicts(const size_t count[VERDICT_COUNT])
{
    json_t *out = json_object();
    for (enum verdict v = 0; v < VERDICT_COUNT; v++)
        json_add(out, "%s=%zu", verdict_name(v), count[v]);
    return out;
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
    return json_record("prim=%p t=%p u=%p v=%p", json_prim(hit->prim), json_float(hit->t),
                       json_float(hit->u), json_float(hit->v));
}

json_t *json_turnout(const struct turnout *turnout)
{
    json_t *out = json_array();
    for (size_t i = 0; i < turnout->count; i++) {
        const struct turnout_one *one = &turnout->one[i];
        json_array_append_new(out,
                              json_record("kind=%s name=%s asked=%zu answered=%zu refused=%zu "
                                          "skipped=%zu failed=%zu vacuous=%i reason=%s",
                                          one->kind, one->name, turnout_asked(one),
                                          one->end[TURNOUT_ANSWERED], one->end[TURNOUT_REFUSED],
                                          one->end[TURNOUT_SKIPPED] + one->end[TURNOUT_ABSENT],
                                          one->end[TURNOUT_FAILED],
                                          turnout_code(one) == EXIT_MISMATCH, one->reason.text));
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
