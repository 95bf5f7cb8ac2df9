/* The page of raydiff explain as JSON, and its command line. Floats stand as bit patterns beside
 * the readable number. */
#include "ref/cmd_explain_inner.h"

#include "fuzz/plugin_shader.h"
#include "ref/explain/outside.h"
#include "ref/explain/ray_text.h"
#include "ref/mutant.h"
#include "scenes/file.h"
#include "ref/cmd_json.h"
#include "ref/cmd_use.h"
#include "ref/command.h"

#include <jansson.h>
#include <math.h>
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
    if (!o->json || MUTANT == MUTANT_EXPLAIN_SILENT)
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

/* Appends printf-formatted text as far as it fits. */
static void append(char text[EXPLAIN_COMMAND_MOST], const char *format, const char *word)
{
    size_t used = strlen(text);
    snprintf(text + used, EXPLAIN_COMMAND_MOST - used, format, word);
}

/* How the tree was built, as far as its builder reads it. */
static void append_build(const struct explain_of *of, const struct option_use *use,
                         char text[EXPLAIN_COMMAND_MOST])
{
    const struct build_options *build = &of->build;
    const struct {
        const char *name;
        bool differs;
        double value;
    } options[] = {{"leaf", build->leaf != BUILD_LEAF_DEFAULT, build->leaf},
                   {"eps", build->eps != BUILD_EPS_DEFAULT, (double)build->eps},
                   {"bins", build->bins != 0, build->bins},
                   {"radius", build->radius != 0, build->radius},
                   {"split-budget", build->split_budget != 0, fmax(build->split_budget, 0)},
                   {"split-alpha", build->split_alpha != 0, fmax(build->split_alpha, 0)}};
    struct reason why;
    char number[32];
    for (size_t i = 0; i < ARRAY_COUNT(options); i++) {
        if (!options[i].differs || !option_is_used(use, options[i].name, &why))
            continue;
        snprintf(number, sizeof number, " %.9g", options[i].value);
        append(text, " --%s", options[i].name);
        append(text, "%s", number);
    }
    snprintf(number, sizeof number, "%u", build->passes);
    if (build->passes)
        append(text, " --optimize reinsert=%s", number);
}

void explain_command(const struct explain_of *of, const struct ray *ray,
                     char text[EXPLAIN_COMMAND_MOST])
{
    char number[32], numbers[RAY_TEXT_MOST];
    struct reason why;
    struct list builder = {.count = 0};
    const struct list engine = list_of_engine(of->engine);
    char *const scene[] = {(char *)(uintptr_t)of->spec}; /* is read alone */
    while (of->builder && builders_all[builder.index[0]] &&
           builders_all[builder.index[0]] != of->builder)
        builder.index[0]++;
    builder.count = of->builder && builders_all[builder.index[0]];
    const struct option_use use = {
        .engine = &engine, .builder = &builder, .scene = scene, .scene_count = 1};
    snprintf(text, EXPLAIN_COMMAND_MOST, "raydiff explain");
    command_word(text, EXPLAIN_COMMAND_MOST, of->spec);
    ray_text_write(ray, numbers);
    append(text, " --ray '%s'", numbers);
    append(text, "%s", " --engine");
    command_word(text, EXPLAIN_COMMAND_MOST, of->engine->name);
    if (of->layout) {
        plugin_command(text, EXPLAIN_COMMAND_MOST, of->layout);
        append(text, "%s", of->tree ? " --bvh" : " --builder");
        command_word(text, EXPLAIN_COMMAND_MOST, of->tree ? of->tree : of->builder->name);
        if (of->store && of->store != tri_stores[0])
            append(text, " --store %s", of->store->name);
        append(text, " --box %s", of->box->name);
        if (!of->tree)
            append_build(of, &use, text);
    }
    if (option_is_used(&use, "tri", &why))
        append(text, " --tri %s", of->tri->name);
    append(text, " --query %s", query_name(of->query));
    snprintf(number, sizeof number, "%llu", (unsigned long long)of->seed);
    if (of->seed != 1 && option_is_used(&use, "seed", &why))
        append(text, " --seed %s", number);
    if (of->driver && option_is_used(&use, "driver", &why)) {
        append(text, "%s", " --driver");
        command_word(text, EXPLAIN_COMMAND_MOST, of->driver);
    }
}

struct explain_of explain_of_row(const struct row *row, const char *spec, uint64_t seed,
                                 const char *driver)
{
    return (struct explain_of){.spec = spec,
                               .seed = seed,
                               .engine = row->engine,
                               .layout = row->layout,
                               .store = row->options.store,
                               .builder = row->options.builder,
                               .build = row->options.build,
                               .tree = row->options.tree ? row->options.tree->name : NULL,
                               .box = row->options.box,
                               .tri = row->options.tri,
                               .query = row->options.query,
                               .driver = driver};
}
