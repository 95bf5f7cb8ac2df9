/* The page of raydiff explain as JSON. Floats stand as bit patterns beside the readable number. */
#include "cmd/explain/cmd_explain_inner.h"

#include "ref/explain/outside.h"
#include "ref/base/ray_text.h"
#include "ref/files/file.h"
#include "cmd/common/cmd_json.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static json_t *bound_json(const struct explain_bound *bound)
{
    static const char *const faults[] = {"ok", "overflow", "flushed", "rounded", "stored", "cut"};
    return json_pack("{s:o, s:o, s:o, s:o, s:I, s:s}", "exact", json_float(bound->exact), "tree",
                     json_float(bound->canonical), "decoded", json_float(bound->decoded),
                     "float16_steps", json_number(bound->half_steps), "float32_steps",
                     (json_int_t)bound->float_steps, "fault", faults[bound->fault]);
}

static json_t *step_json(const struct explain_step *step)
{
    static const char *const refs[] = {"ok", "truncated", "other"};
    json_t *lo = json_array(), *hi = json_array(), *slab = json_array(), *words = json_array();
    for (int k = 0; k < 3; k++) {
        const struct slab_axis *axis = &step->slab[k];
        json_array_append_new(lo, bound_json(&step->lo[k]));
        json_array_append_new(hi, bound_json(&step->hi[k]));
        json_array_append_new(
            slab, json_pack("{s:o, s:o, s:o, s:o}", "enter", json_float(axis->enter), "leave",
                            json_float(axis->leave), "exact_enter", json_number(axis->exact_enter),
                            "exact_leave", json_number(axis->exact_leave)));
    }
    for (uint32_t i = 0; i < step->word_count; i++) {
        char text[16];
        snprintf(text, sizeof text, "%08x", step->word[i]);
        json_array_append_new(words, json_string(text));
    }
    return json_pack(
        "{s:I, s:o, s:b, s:s, s:b, s:b, s:b, s:b, s:o, s:o, s:o, s:o, s:o, s:o}", "node",
        (json_int_t)step->note.node, "record",
        step->record == EXPLAIN_NONE ? json_null() : json_integer((json_int_t)step->record), "leaf",
        step->leaf, "children", refs[step->ref], "tested", step->note.tested, "hit", step->note.hit,
        "entered", step->note.visited, "skipped", step->note.skipped, "entry",
        json_float(step->note.entry), "best", json_float(step->note.tbest), "lo", lo, "hi", hi,
        "slab", slab, "words", words);
}

static json_t *tried_json(const struct explanation *why)
{
    json_t *out = json_array();
    for (size_t i = 0; i < why->attempt_count; i++) {
        const struct explain_attempt *attempt = &why->attempt[i];
        json_array_append_new(
            out, json_pack("{s:s, s:s, s:b, s:b, s:b, s:s, s:o}", "cause",
                           cause_name(repair_cause(attempt->repair)), "repair",
                           repair_text(attempt->repair), "finished", attempt->end == REPLAY_DONE,
                           "changed", attempt->changed, "allowed", attempt->opinion.allowed,
                           "verdict", attempt->opinion.text, "answer", json_hit(&attempt->hit)));
    }
    return out;
}

/* Repairs that help only together. */
static json_t *needed_json(const struct explanation *why)
{
    json_t *out = json_array();
    for (enum repair repair = 0; repair < REPAIR_COUNT; repair++)
        if (why->needed >> repair & 1u)
            json_array_append_new(out,
                                  json_pack("{s:s, s:s}", "cause", cause_name(repair_cause(repair)),
                                            "repair", repair_text(repair)));
    return out;
}

static json_t *imitated_json(const struct explanation *why)
{
    json_t *out = json_array();
    for (size_t i = 0; i < why->imitation_count; i++) {
        const struct explain_imitation *one = &why->imitation[i];
        json_array_append_new(
            out, json_pack("{s:s, s:s, s:I, s:b, s:b, s:I, s:I, s:I, s:I}", "cause",
                           cause_name(defect_cause(one->defect)), "defect",
                           defect_text(one->defect), "parameter", (json_int_t)one->parameter,
                           "same", one->same, "refuted", one->refuted, "witnesses",
                           (json_int_t)one->witnesses, "of", (json_int_t)one->asked, "telling",
                           (json_int_t)one->telling, "told", (json_int_t)one->told));
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
            out, json_pack("{s:s, s:s}", "cause", cause_name(hint[i].cause), "text", hint[i].text));
    return out;
}

static json_t *subject_json(const struct explain_page *page)
{
    const struct explain_of *of = page->of;
    return json_pack("{s:s, s:I, s:s, s:s?, s:s?, s:s?, s:s?, s:i, s:s?, s:s, s:s, s:s?, s:I}",
                     "scene", of->spec, "seed", (json_int_t)of->seed, "engine", of->engine->name,
                     "layout", of->layout ? of->layout->name : NULL, "store",
                     of->layout && of->store ? of->store->name : NULL, "builder",
                     of->builder ? of->builder->name : NULL, "bvh", of->tree, "leaf",
                     (int)of->build.leaf, "box", of->layout ? of->box->name : NULL, "tri",
                     of->tri->name, "query", query_name(of->query), "rays", page->rays, "index",
                     (json_int_t)page->index);
}

static json_t *judgement_json(const struct judged_ray *ray)
{
    const struct judgement *judgement = &ray->judgement;
    return json_pack(
        "{s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o}", "verdict", verdict_name(judgement->verdict),
        "wrong", wrong_name(judgement->wrong), "expected", json_prim(judgement->expected), "t_lo",
        json_number(judgement->t_lo), "t_hi", json_number(judgement->t_hi), "over",
        json_number(judgement->over), "displacement", json_number(judgement->displacement), "lost",
        json_prim(judgement->behind ? judgement->lost : ABI_NO_PRIM));
}

static json_t *page_json(const struct explain_page *page, int exit_code)
{
    const struct judged_ray *ray = page->ray;
    const struct explanation *why = &ray->why;
    const struct oracle_answer *truth = &ray->truth;
    char command[EXPLAIN_COMMAND_MOST];
    json_t *way = json_array(), *out = json_object();
    for (uint32_t i = 0; i < why->step_count; i++)
        json_array_append_new(way, step_json(&why->step[i]));
    explain_command(page->of, &ray->ray, command);
    json_object_set_new(out, "raydiff", json_string(RAYDIFF_VERSION));
    json_object_set_new(out, "exit", json_integer(exit_code));
    json_object_set_new(out, "subject", subject_json(page));
    json_object_set_new(out, "command", json_string(command));
    json_object_set_new(out, "origin", json_floats(ray->ray.org, 3));
    json_object_set_new(out, "direction", json_floats(ray->ray.dir, 3));
    json_object_set_new(out, "tmin", json_float(ray->ray.tmin));
    json_object_set_new(out, "tmax", json_float(ray->ray.tmax));
    json_object_set_new(out, "truth",
                        json_pack("{s:o, s:I, s:o, s:o, s:s}", "prim", json_prim(truth->prim),
                                  "ties", (json_int_t)truth->tie_count, "t_lo",
                                  json_number(truth->t_lo), "t_hi", json_number(truth->t_hi),
                                  "class", oracle_class_name((enum oracle_class)truth->class)));
    json_object_set_new(out, "finished", json_boolean(ray->answer.finished));
    json_object_set_new(out, "reason", json_string(ray->reason.text));
    json_object_set_new(out, "answer", json_hit(&ray->answer.hit));
    json_object_set_new(out, "judgement", judgement_json(ray));
    json_object_set_new(out, "cause", json_string(cause_name(why->cause)));
    json_object_set_new(out, "needed", needed_json(why));
    json_object_set_new(out, "inside", json_boolean(why->inside));
    json_object_set_new(out, "c_answers", json_hit(&why->replayed));
    json_object_set_new(out, "end", json_string(explain_end_name(why->end)));
    json_object_set_new(out, "last", json_integer((json_int_t)why->last));
    json_object_set_new(out, "way", way);
    json_object_set_new(out, "tried", tried_json(why));
    json_object_set_new(out, "imitated", imitated_json(why));
    json_object_set_new(out, "hints", hints_json(page));
    json_object_set_new(out, "decode", explain_decode_json(page->decode));
    return out;
}

enum status explain_write_json(const char *path, const struct explain_page *page, int exit_code,
                               struct reason *reason)
{
    json_t *root = page_json(page, exit_code);
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
    json_object_set_new(subject, "index", json_null());
    json_object_set_new(out, "raydiff", json_string(RAYDIFF_VERSION));
    json_object_set_new(out, "exit", json_integer(exit_code));
    json_object_set_new(out, "subject", subject);
    json_object_set_new(out, "rays_judged", json_integer((json_int_t)count));
    json_object_set_new(out, "cause", json_string(cause_name(CAUSE_NONE)));
    json_object_set_new(out, "decode", explain_decode_json(decode));
    return json_write(o->json, out, 17, reason);
}
