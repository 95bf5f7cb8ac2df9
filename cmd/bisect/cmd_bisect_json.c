/* The JSON of raydiff bisect. */
#include "cmd/bisect/cmd_bisect.h"

#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"

static const char *const proofs[] = {"shortest", "minimal", "tries"};
static const char *const ends[] = {"found", "whole", "as_built", "unlike", "no_cure"};

static json_t *passes_json(const struct bisect *bisect)
{
    json_t *all = json_array(), *found = json_array();
    for (size_t i = 0; i < bisect->pass_count; i++) {
        json_array_append_new(all, json_string(bisect->pass[i]));
        if (bisect->in[i])
            json_array_append_new(found, json_string(bisect->pass[i]));
    }
    return json_record("all=%p found=%p proof=%s tried=%zu", all, found, proofs[bisect->proof],
                       bisect->pass_tries);
}

static json_t *change_json(const struct bisect *bisect)
{
    json_t *lines = json_array();
    for (size_t i = 0; i < bisect->line_count; i++) {
        const char sign[] = {bisect->line[i].sign, '\0'};
        json_array_append_new(lines, json_record("sign=%s text=%s", sign, bisect->line[i].text));
    }
    return json_record("function=%s what=%s decorations=%i edits=%zu found=%zu least=%i tried=%zu "
                       "lines=%p",
                       bisect->function, bisect->what, (int)bisect->decorations, bisect->edits,
                       bisect->edit_count, (int)bisect->least, bisect->edit_tries, lines);
}

enum status bisect_write_json(const char *path, const struct bisect_result *result, int exit_code,
                              struct reason *reason)
{
    const struct bisect_options *o = result->options;
    const struct bisect_subject *subject = result->subject;
    const struct bisect_shown *shown = &result->shown;
    const struct bisect *bisect = &result->bisect;
    json_t *symptom = shown->is
                          ? json_record("name=%s count=%zu of=%zu first_ray=%p open=%u",
                                        symptom_names[shown->symptom], shown->count, shown->of,
                                        shown->symptom == SYMPTOM_PRECISE
                                            ? json_null()
                                            : json_integer((json_int_t)shown->first),
                                        shown->open)
                          : json_null();
    json_t *root = json_record(
        "raydiff=%s exit=%d subject=%s rays=%zu engine=%s layout=%p shader=%s compiler=%s good=%s "
        "symptom=%p end=%p tool=%p passes=%p change=%p crashed=%zu hung=%zu",
        RAYDIFF_VERSION, exit_code, subject->text, subject->ray_count, o->engine->name,
        json_text(o->layout ? o->layout->name : NULL), result->shader, subject->bad_name,
        subject->good_name, symptom, json_text(shown->is ? ends[bisect->end] : NULL),
        json_text(result->tool[0] ? result->tool : NULL),
        bisect->pass_count > 0 ? passes_json(bisect) : json_null(),
        bisect->edit_count > 0 ? change_json(bisect) : json_null(), result->crashed, result->hung);
    return json_write(path, root, 17, reason);
}
