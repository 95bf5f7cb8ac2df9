/* The page of raydiff explain as JSON. Floats are written as bit patterns and as readable
 * numbers. */
#include "cmd/explain/cmd_explain_inner.h"
#include "cmd/explain/cmd_explain_oriented.h"

#include "ref/explain/outside.h"
#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"

#include <jansson.h>
#include <stdio.h>

static json_t *bound_json(const struct explain_bound *bound)
{
    static const char *const faults[] = {"ok", "overflow", "flushed", "rounded", "stored", "cut"};
    return json_record("exact=%p tree=%p decoded=%p float16_steps=%g float32_steps=%zu fault=%s",
                       json_float(bound->exact), json_float(bound->canonical),
                       json_float(bound->decoded), bound->half_steps, bound->float_steps,
                       faults[bound->fault]);
}

static json_t *step_json(const struct explain_step *step)
{
    static const char *const refs[] = {"ok", "truncated", "other"};
    json_t *lo = json_array(), *hi = json_array(), *slab = json_array(), *words = json_array();
    for (int k = 0; k < 3; k++) {
        const struct slab_axis *axis = &step->slab[k];
        json_array_append_new(lo, bound_json(&step->lo[k]));
        json_array_append_new(hi, bound_json(&step->hi[k]));
        json_array_append_new(slab, json_record("enter=%p leave=%p exact_enter=%g exact_leave=%g",
                                                json_float(axis->enter), json_float(axis->leave),
                                                axis->exact_enter, axis->exact_leave));
    }
    for (uint32_t i = 0; i < step->word_count; i++) {
        char text[16];
        snprintf(text, sizeof text, "%08x", step->word[i]);
        json_array_append_new(words, json_string(text));
    }
    return json_record(
        "node=%u record=%p leaf=%i children=%s tested=%i hit=%i entered=%i "
        "skipped=%i entry=%p best=%p lo=%p hi=%p slab=%p oriented=%p words=%p",
        step->note.node,
        step->record == EXPLAIN_NONE ? json_null() : json_integer((json_int_t)step->record),
        step->leaf, refs[step->ref], step->note.tested, step->note.hit, step->note.visited,
        step->note.skipped, json_float(step->note.entry), json_float(step->note.tbest), lo, hi,
        slab, explain_oriented_json(&step->oriented), words);
}

static json_t *tried_json(const struct explanation *why)
{
    json_t *out = json_array();
    for (size_t i = 0; i < why->attempt_count; i++) {
        const struct explain_attempt *attempt = &why->attempt[i];
        json_array_append_new(
            out,
            json_record("cause=%s repair=%s finished=%i changed=%i allowed=%i verdict=%s answer=%p",
                        cause_name(repair_cause(attempt->repair)), repair_text(attempt->repair),
                        attempt->end == REPLAY_DONE, attempt->changed, attempt->opinion.allowed,
                        attempt->opinion.text, json_hit(&attempt->hit)));
    }
    return out;
}

/* Lists the repairs that only help together. */
static json_t *needed_json(const struct explanation *why)
{
    json_t *out = json_array();
    for (enum repair repair = 0; repair < REPAIR_COUNT; repair++)
        if (why->needed >> repair & 1u)
            json_array_append_new(out, json_record("cause=%s repair=%s",
                                                   cause_name(repair_cause(repair)),
                                                   repair_text(repair)));
    return out;
}

static json_t *imitated_json(const struct explanation *why)
{
    json_t *out = json_array();
    for (size_t i = 0; i < why->imitation_count; i++) {
        const struct explain_imitation *one = &why->imitation[i];
        json_array_append_new(out, json_record("cause=%s defect=%s parameter=%u same=%i refuted=%i "
                                               "witnesses=%u of=%u telling=%u told=%u",
                                               cause_name(defect_cause(one->defect)),
                                               defect_text(one->defect), one->parameter, one->same,
                                               one->refuted, one->witnesses, one->asked,
                                               one->telling, one->told));
    }
    return out;
}

static json_t *hints_json(const struct explain_page *page)
{
    const struct judged_ray *ray = page->ray;
    struct outside_hint hint[OUTSIDE_HINTS];
    json_t *out = json_array();
    size_t count = 0;
    if (!page->judged->known && ray->answer.finished && ray->answer.hit.prim == ABI_NO_PRIM &&
        ray->truth.prim != ABI_NO_PRIM)
        count = explain_outside(page->scene, &ray->ray, ray->truth.prim, hint);
    for (size_t i = 0; i < count; i++)
        json_array_append_new(
            out, json_record("cause=%s text=%s", cause_name(hint[i].cause), hint[i].text));
    return out;
}

static json_t *subject_json(const struct explain_page *page)
{
    const struct explain_of *of = page->of;
    return json_record("scene=%s seed=%zu engine=%s layout=%p store=%p builder=%p bvh=%p leaf=%u "
                       "box=%p tri=%s query=%s rays=%p index=%zu built=%p",
                       of->spec, of->seed, of->engine->name,
                       json_text(of->layout ? of->layout->name : NULL),
                       json_text(of->layout && of->store ? of->store->name : NULL),
                       json_text(of->builder ? of->builder->name : NULL), json_text(of->tree),
                       of->build.leaf, json_text(of->layout ? of->box->name : NULL), of->tri->name,
                       query_name(of->query), json_text(page->rays), page->index,
                       json_text(page->built && page->built[0] ? page->built : NULL));
}

static json_t *judgement_json(const struct judged_ray *ray)
{
    const struct judgement *judgement = &ray->judgement;
    return json_record(
        "verdict=%s wrong=%s expected=%p t_lo=%g t_hi=%g over=%g displacement=%g lost=%p",
        verdict_name(judgement->verdict), wrong_name(judgement->wrong),
        json_prim(judgement->expected), judgement->t_lo, judgement->t_hi, judgement->over,
        judgement->displacement, json_prim(judgement->behind ? judgement->lost : ABI_NO_PRIM));
}

json_t *explain_json(const struct explain_page *page, int exit_code)
{
    const struct judged_ray *ray = page->ray;
    const struct explanation *why = &ray->why;
    const struct oracle_answer *truth = &ray->truth;
    char command[EXPLAIN_COMMAND_MOST];
    json_t *way = json_array(), *out = json_object();
    for (uint32_t i = 0; i < why->step_count; i++)
        json_array_append_new(way, step_json(&why->step[i]));
    explain_command(page->of, &ray->ray, command);
    json_add(out,
             "raydiff=%s exit=%d subject=%p command=%s origin=%p direction=%p tmin=%p tmax=%p "
             "truth=%p finished=%i reason=%s answer=%p judgement=%p cause=%s needed=%p inside=%i "
             "c_answers=%p end=%s last=%u way=%p tried=%p imitated=%p hints=%p decode=%p",
             RAYDIFF_VERSION, exit_code, subject_json(page), command, json_floats(ray->ray.org, 3),
             json_floats(ray->ray.dir, 3), json_float(ray->ray.tmin), json_float(ray->ray.tmax),
             json_record("prim=%p ties=%u t_lo=%g t_hi=%g class=%s", json_prim(truth->prim),
                         truth->tie_count, truth->t_lo, truth->t_hi,
                         oracle_class_name((enum oracle_class)truth->class)),
             ray->answer.finished, ray->reason.text, json_hit(&ray->answer.hit),
             judgement_json(ray), cause_name(why->cause), needed_json(why), why->inside,
             json_hit(&why->replayed), explain_end_name(why->end), why->last, way, tried_json(why),
             imitated_json(why), hints_json(page), explain_decode_json(page->decode));
    return out;
}

enum status explain_write_json(const char *path, const struct explain_page *page, int exit_code,
                               struct reason *reason)
{
    json_t *root = explain_json(page, exit_code);
    return json_write(path, root, 17, reason);
}

enum status explain_write_none(const struct explain_options *o, size_t count,
                               const struct explain_decode *decode, int exit_code,
                               struct reason *reason)
{
    if (!o->json)
        return STATUS_OK;
    const struct explain_page page = {.of = &o->of, .rays = o->has_file ? NULL : o->rays->name};
    json_t *subject = subject_json(&page), *out = json_object();
    json_add(subject, "index=%p", json_null());
    json_add(out, "raydiff=%s exit=%d subject=%p rays_judged=%zu cause=%s decode=%p",
             RAYDIFF_VERSION, exit_code, subject, count, cause_name(CAUSE_NONE),
             explain_decode_json(decode));
    return json_write(o->json, out, 17, reason);
}
