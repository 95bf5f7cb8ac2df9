/* The page of raydiff explain as text. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/explain/cmd_explain_inner.h"

#include "cmd/common/cmd_tables.h"
#include "ref/explain/imitate.h"
#include "ref/explain/outside.h"
#include "ref/base/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_hit(FILE *out, const struct hit *hit)
{
    if (hit->prim == ABI_NO_PRIM) {
        fputs("a miss", out);
        return;
    }
    fprintf(out, "triangle %u at t = ", hit->prim);
    print_float(out, hit->t);
    fprintf(out, ", u = %.9g, v = %.9g", (double)hit->u, (double)hit->v);
}

static void print_subject(FILE *out, const struct explain_page *page)
{
    const struct explain_of *of = page->of;
    const struct ray *ray = &page->ray->ray;
    const float range[2] = {ray->tmin, ray->tmax};
    fprintf(out, "scene     %s: %u triangle%s\n", of->spec, page->scene->tri_count,
            plural(page->scene->tri_count));
    if (page->file && page->file->trial.step_count > 0) {
        char steps[STEPS_TEXT_MOST];
        steps_write(page->file->trial.step, page->file->trial.step_count, steps);
        fprintf(out, "steps     %s; the ray is traced after the last\n", steps);
    }
    if (page->rays)
        fprintf(out, "ray       %zu of %zu of set %s, seed %llu\n", page->index, page->count,
                page->rays, (unsigned long long)of->seed);
    print_floats(out, 0, "origin", ray->org, 3);
    print_floats(out, 0, "direction", ray->dir, 3);
    print_floats(out, 0, "range", range, 2);
    char text[STORED_NAME_MOST];
    const char *layout = stored_name(of->layout, of->store, text);
    fprintf(out, "engine    %s", of->engine->name);
    if (of->layout && of->tree)
        fprintf(out, ", layout %s, tree %s, box %s", layout, of->tree, of->box->name);
    else if (of->layout)
        fprintf(out, ", layout %s, builder %s, leaf %u, box %s", layout, of->builder->name,
                of->build.leaf, of->box->name);
    fprintf(out, ", triangle %s, query %s\n", of->tri->name, query_name(of->query));
    if (page->built && page->built[0])
        fprintf(out, "built     not as %s does: %s\n", of->builder->twin, page->built);
}

static void print_truth(FILE *out, const struct oracle_answer *truth)
{
    fputs("truth     ", out);
    if (truth->flags & ORACLE_REFUSED)
        fputs("none: the ray is not finite, or its range is empty\n", out);
    else if (truth->prim == ABI_NO_PRIM)
        fputs("a miss\n", out);
    else
        fprintf(out, "triangle %u%s at t in [%.17g, %.17g], %s\n", truth->prim,
                truth->tie_count > 1 ? " and others at the same t" : "", truth->t_lo, truth->t_hi,
                oracle_class_name((enum oracle_class)truth->class));
}

/* What it answers when no other ray is there. */
static void print_alone(FILE *out, const struct judged_ray *ray)
{
    const struct judgement *judgement = &ray->alone_judgement;
    if (!ray->among)
        return;
    fprintf(out, "          that is its answer among %zu rays; traced alone it gets another:\n",
            ray->among);
    fputs("alone     ", out);
    print_hit(out, &ray->alone);
    if (judgement->verdict == VERDICT_WRONG)
        fprintf(out, ": WRONG, %s\n", wrong_name(judgement->wrong));
    else
        fprintf(out, ": %s%s\n", judgement->verdict == VERDICT_RIGHT ? "" : "allowed, ",
                verdict_name(judgement->verdict));
}

static void print_verdict(FILE *out, const struct judged_ray *ray)
{
    const struct judgement *judgement = &ray->judgement;
    fputs("verdict   ", out);
    if (!ray->answer.finished) {
        fputs("not finished\n", out);
        return;
    }
    if (judgement->verdict != VERDICT_WRONG)
        fprintf(out, "%s%s", judgement->verdict == VERDICT_RIGHT ? "" : "allowed: ",
                verdict_name(judgement->verdict));
    else if (judgement->expected == ABI_NO_PRIM)
        fprintf(out, "WRONG: %s", wrong_name(judgement->wrong));
    else
        fprintf(out, "WRONG: %s, triangle %u was to be found", wrong_name(judgement->wrong),
                judgement->expected);
    if (judgement->behind)
        fprintf(out, ", or at the least triangle %u behind it", judgement->lost);
    if (judgement->over > 0)
        fprintf(out, ", error of t %.3g of its bound", judgement->over);
    if (judgement->displacement > 0)
        fprintf(out, ", right if vertices move by %.3g u of their distance",
                judgement->displacement);
    if (judgement->verdict != VERDICT_WRONG && explain_is_wrong(ray))
        fputs("; but not the bits that C gives, as this engine promises", out);
    putc('\n', out);
}

const char *explain_opinion(const struct opinion *opinion)
{
    if (!opinion->allowed)
        return "wrong, ";
    return strcmp(opinion->text, verdict_name(VERDICT_RIGHT)) == 0 ? "" : "allowed, ";
}

const char *explain_note_text(const struct replay_note *note)
{
    if (!note->tested)
        return "never reached";
    if (!note->hit)
        return "TURNED AWAY";
    if (note->missed)
        return "hit; TURNED AWAY by its oriented box";
    return note->visited ? "entered" : note->skipped ? "SKIPPED" : "hit, never entered";
}

static void print_note(FILE *out, const struct explain_step *step)
{
    const struct replay_note *note = &step->note;
    fputs(explain_note_text(note), out);
    if (note->tested && note->hit && note->visited)
        fprintf(out, ", t from %.9g", (double)note->entry);
    else if (note->tested && note->hit && note->skipped)
        fprintf(out, ": entry %.9g is beyond the best t", (double)note->entry);
    putc('\n', out);
}

static void print_way(FILE *out, const struct explanation *why)
{
    if (why->step_count == 0)
        return;
    fprintf(out, "traversal path (cpu) to triangle %u\n", why->prim);
    fprintf(out, "  %8s %8s %-6s box test\n", "node", "record", "kind");
    for (uint32_t i = 0; i < why->step_count; i++) {
        const struct explain_step *step = &why->step[i];
        fprintf(out, "  %8u %8d %-6s ", step->note.node,
                step->record == EXPLAIN_NONE ? -1 : (int)step->record,
                step->leaf ? "leaf" : "inner");
        print_note(out, step);
        if (step->ref != REF_OK)
            fprintf(out, "  %26s its children are not the tree's%s\n", "",
                    step->ref == REF_TRUNCATED ? ": cut to fewer bits" : "");
        if (i == why->last)
            break;
    }
}

const char *explain_fault_text(enum bound_fault fault)
{
    static const char *const names[] = {
        [BOUND_OK] = "",
        [BOUND_OVERFLOW] = "not finite",
        [BOUND_FLUSHED] = "flushed to 0",
        [BOUND_ROUNDED] = "rounded inward",
        [BOUND_STORED] = "another box",
        [BOUND_CUT] = "cut by the builder",
    };
    return names[fault];
}

static void print_end(FILE *out, const struct explain_page *page)
{
    const struct explanation *why = &page->ray->why;
    switch (why->end) {
    case END_BOX:
    case END_SKIPPED:
    case END_ORIENTED:
        explain_node_print(out, &why->step[why->last], page->screen.wide);
        break;
    case END_REFERENCE:
        fprintf(out, "  no child reference that C followed leads to node %u\n",
                why->step[why->last].note.node);
        break;
    case END_SLOT:
        fprintf(out, "  slot %u of its leaf should name triangle %u; ", why->slot, why->prim);
        if (why->slot_stored == ABI_NO_PRIM)
            fputs("nothing is read there\n", out);
        else
            fprintf(out, "it names triangle %u\n", why->slot_stored);
        break;
    case END_TRIANGLE:
        fputs("  the triangle test rejects it\n", out);
        break;
    case END_FARTHER:
    case END_HIT:
        fprintf(out, "  it is hit%s: ",
                why->end == END_FARTHER ? ", but not nearer than the best so far" : "");
        print_hit(out, &why->notes.prim_hit);
        putc('\n', out);
        break;
    case END_NOWHERE:
        break;
    }
}

/* Prints the exact result for one triangle, and what the engine's formula can decide. */
static void print_triangle(FILE *out, const struct explain_page *page, uint32_t prim)
{
    const struct judged *judged = page->judged;
    const struct ray *ray = &page->ray->ray;
    struct oracle_pair pair;
    if (prim >= page->scene->tri_count || page->ray->truth.flags & ORACLE_REFUSED)
        return;
    oracle_pair(judged->from.oracle, ray, prim, &pair);
    fprintf(out, "triangle %u exactly: %s", prim, oracle_class_name(pair.class));
    if (pair.class != ORACLE_MISS && pair.class != ORACLE_ZERO_AREA)
        fprintf(out, ", t in [%.17g, %.17g], smallest barycentric %.3g", pair.t_lo, pair.t_hi,
                pair.margin);
    putc('\n', out);
    if (judged->model.formula == TWIN_UNKNOWN || !ray_in_contract(ray))
        return;
    float v[3][3];
    scene_tri(page->scene, prim, v);
    struct twin twin = twin_eval(judged->model.formula, judged->model.rounding, ray, v);
    fprintf(out, "  its formula: t = %.9g, off by at most %.3g; %s%s\n", (double)twin.t, twin.t_err,
            twin.certain    ? "certainly a hit"
            : twin.possible ? "hit or miss within its rounding"
                            : "certainly no hit",
            twin.det == 0 ? ", the determinant's sign is open" : "");
}

static void print_tried(FILE *out, const struct explanation *why)
{
    for (size_t i = 0; i < why->attempt_count; i++) {
        const struct explain_attempt *attempt = &why->attempt[i];
        if (!attempt->changed)
            continue;
        fprintf(out, "  %-22s %s: ", cause_name(repair_cause(attempt->repair)),
                repair_text(attempt->repair));
        if (attempt->end != REPLAY_DONE)
            fputs("not finished", out);
        else
            print_hit(out, &attempt->hit);
        fprintf(out, ": %s%s\n", explain_opinion(&attempt->opinion), attempt->opinion.text);
    }
}

static void print_defect(FILE *out, const struct explain_imitation *one)
{
    fputs(defect_text(one->defect), out);
    if (defect_is_numbered(one->defect))
        fprintf(out, " (%u)", one->parameter);
}

/* Prints how a defect failed to predict the engine. With several parameters, the one that got
 * farthest is printed. */
static void print_failed(FILE *out, const struct explanation *why, enum defect defect)
{
    const struct explain_imitation *most = NULL;
    for (size_t i = 0; i < why->imitation_count; i++) {
        const struct explain_imitation *one = &why->imitation[i];
        if (one->defect != defect)
            continue;
        if (!most || (one->same && (!most->same || one->witnesses > most->witnesses)))
            most = one;
    }
    if (!most)
        return;
    fprintf(out, "  %-22s ", cause_name(defect_cause(defect)));
    print_defect(out, most);
    if (!most->same)
        fputs(": gives another answer\n", out);
    else if (most->refuted)
        fprintf(out, ": gives this answer, but not the engine's to %u of %u other rays\n",
                most->asked - most->witnesses, most->asked);
    else
        fprintf(out, ": gives this answer, but only %u of %u other rays distinguish it from C\n",
                most->telling, most->asked);
}

static void print_imitated(FILE *out, const struct explanation *why)
{
    fputs("  C on the same bytes answers ", out);
    print_hit(out, &why->replayed);
    fprintf(out, ": %s\n", why->replayed_opinion.text);
    const struct explain_imitation *one = &why->imitation[why->imitated];
    if (why->imitated < why->imitation_count && explain_is_shown(one)) {
        fputs("  C with this planted: ", out);
        print_defect(out, one);
        fprintf(out,
                ": the same as the engine, also for %u of %u other rays; on %u of these C answers "
                "otherwise, on which the engine does as planted %u times\n",
                one->witnesses, one->asked, one->telling, one->told);
        return;
    }
    fputs(why->witness_count > 0
              ? "  none of these planted in C predicts the engine's answers:\n"
              : "  none of these is confirmed, since no other ray could be traced:\n",
          out);
    for (enum defect defect = DEFECT_NONE + 1; defect < DEFECT_COUNT; defect++)
        print_failed(out, why, defect);
}

/* Prints hints if an engine with an unknown tree missed a triangle that is hit exactly, whether or
 * not the miss is allowed. */
static void print_hints(FILE *out, const struct explain_page *page)
{
    const struct judged_ray *ray = page->ray;
    struct outside_hint hint[OUTSIDE_HINTS];
    if (page->judged->known || !ray->answer.finished || ray->answer.hit.prim != ABI_NO_PRIM ||
        ray->truth.prim == ABI_NO_PRIM)
        return;
    size_t count = explain_outside(page->scene, &ray->ray, ray->truth.prim, hint);
    for (size_t i = 0; i < count; i++)
        fprintf(out, "%s%s (%s)\n", i == 0 ? "lost by?   " : "           ", hint[i].text,
                cause_name(hint[i].cause));
}

/* Prints the other faults of a ray that has several. */
static void print_needed(FILE *out, const struct explanation *why)
{
    bool first = true;
    for (enum repair repair = 0; repair < REPAIR_COUNT; repair++) {
        enum cause cause = repair_cause(repair);
        if (!(why->needed >> repair & 1u))
            continue;
        if (!first)
            fprintf(out, "  and     %s: %s (no repair helps alone)\n", cause_name(cause),
                    cause_text(cause));
        first = false;
    }
}

static void print_cause(FILE *out, const struct explain_page *page)
{
    const struct explanation *why = &page->ray->why;
    if (why->cause == CAUSE_NONE)
        return;
    fprintf(out, "cause     %s: %s\n", cause_name(why->cause), cause_text(why->cause));
    print_needed(out, why);
    if (why->inside) {
        fputs("  C on the same bytes answers the same; with one repair at a time it answers\n",
              out);
        print_tried(out, why);
        fputs("  (repairs that change nothing are left out)\n", out);
    } else if (why->imitation_count > 0) {
        print_imitated(out, why);
    }
}

static void print_page(FILE *out, const struct explain_page *page)
{
    const struct judged_ray *ray = page->ray;
    char command[EXPLAIN_COMMAND_MOST];
    print_subject(out, page);
    print_truth(out, &ray->truth);
    fputs("answer    ", out);
    if (ray->answer.finished)
        print_hit(out, &ray->answer.hit);
    else
        fputs(ray->reason.text, out);
    putc('\n', out);
    print_verdict(out, ray);
    print_alone(out, ray);
    print_way(out, &ray->why);
    print_end(out, page);
    print_triangle(out, page, ray->why.prim);
    if (ray->judgement.behind && ray->judgement.expected != ray->why.prim)
        print_triangle(out, page, ray->judgement.expected);
    if (ray->answer.finished && ray->answer.hit.prim != ray->why.prim)
        print_triangle(out, page, ray->answer.hit.prim);
    print_cause(out, page);
    print_hints(out, page);
    explain_command(page->of, &ray->ray, command);
    fprintf(out, "again     %s\n", page->again ? page->again : command);
}

void explain_print(const struct explain_page *page)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = page->screen.wide ? NULL : open_memstream(&text, &size);
    print_page(out ? out : stdout, page);
    if (out && fclose(out) == 0)
        screen_page(&page->screen, text, "again ");
    free(text);
}
