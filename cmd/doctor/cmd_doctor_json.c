/* raydiff doctor --json. */
#include "cmd/doctor/cmd_doctor.h"

#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"

static json_t *engine_json(const struct doctor_engine *e)
{
    return json_record("name=%s runs=%i why=%p text=%s", e->engine->name, e->status == STATUS_OK,
                       json_text(e->status ? e->reason.text : NULL), e->text);
}

static json_t *driver_json(const struct doctor_driver *d)
{
    return json_pack("{s:s, s:b, s:s?, s:s, s:o*}", "name", d->name, "runs", d->status == STATUS_OK,
                     "why", d->status ? d->reason.text : NULL, "packages", d->version, "card",
                     d->status ? NULL : card_json(&d->card));
}

enum status doctor_write_json(const char *path, const struct doctor *doctor, struct reason *reason)
{
    json_t *list[2] = {json_array(), json_array()};
    for (size_t i = 0; i < doctor->engine_count; i++)
        (void)json_array_append_new(list[0], engine_json(&doctor->engine[i]));
    for (size_t i = 0; i < doctor->driver_count; i++)
        (void)json_array_append_new(list[1], driver_json(&doctor->driver[i]));
    json_t *root =
        json_record("raydiff=%s engines=%p drivers=%p", RAYDIFF_VERSION, list[0], list[1]);
    return json_write(path, root, 9, reason);
}
