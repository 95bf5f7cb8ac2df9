/* The page of raydiff explain as text. */
#include "cmd/explain/cmd_explain.h"

#include "cmd/common/cmd_tables.h"
#include "ref/explain/imitate.h"
#include "ref/explain/outside.h"
#include "ref/base/ray_text.h"

#include <stdio.h>

static void print_hit(const struct hit *hit)
{
    if (hit->prim == ABI_NO_PRIM) {
        fputs("a miss", stdout);
        return;
    }
    printf("triangle %u at t = ", hit->prim);
    print_float(hit->t);
    printf(", u = %.9g, v = %.9g", (double)hit->u, (double)hit->v);
}

static void print_subject(const struct explain_page *page)
{
    const struct explain_of *of = page->of;
    const struct ray *ray = &page->ray->ray;
    const float range[2] = {ray->tmin, ray->tmax};
    printf("scene     %s: %u triangles\n", of->spec, page->scene->tri_count);
    if (page->rays)
        printf("ray       %zu of %zu of set %s, seed %llu\n", page->index, page->count, page->rays,
               (unsigned long long)of->seed);
    print_floats(0, "origin", ray->org, 3);
    print_floats(0, "direction", ray->dir, 3);
    print_floats(0, "range", range, 2);
    char text[STORED_NAME_MOST];
    const char *layout = stored_name(of->layout, of->store, text);
    printf("engine    %s", of->engine->name);
    if (of->layout && of->tree)
        printf(", layout %s, tree %s, box %s", layout, of->tree, of->box->name);
    else if (of->layout)
        printf(", layout %s, builder %s, leaf %u, box %s", layout, of->builder->name,
               of->build.leaf, of->box->name);
    printf(", triangle %s, query %s\n", of->tri->name, query_name(of->query));
}

static void print_truth(const struct oracle_answer *truth)
{
    fputs("truth     ", stdout);
    if (truth->flags & ORACLE_REFUSED)
        puts("none: the ray is not finite, or its range is empty");
    else if (truth->prim == ABI_NO_PRIM)
        puts("a miss");
    else
        printf("triangle %u%s at t in [%.17g, %.17g], %s\n", truth->prim,
               truth->tie_count > 1 ? " and others at the same t" : "", truth->t_lo, truth->t_hi,
               oracle_class_name((enum oracle_class)truth->class));
}

static void print_verdict(const struct judged_ray *ray)
{
    const struct judgement *judgement = &ray->judgement;
    fputs("verdict   ", stdout);
    if (!ray->answer.finished) {
        puts("not finished");
        return;
    }
    if (judgement->verdict != VERDICT_WRONG)
        printf("allowed: %s", verdict_name(judgement->verdict));
    else if (judgement->expected == ABI_NO_PRIM)
        printf("WRONG: %s", wrong_name(judgement->wrong));
    else
        printf("WRONG: %s, triangle %u was to be found", wrong_name(judgement->wrong),
               judgement->expected);
    if (judgement->behind)
        printf(", or at the least triangle %u behind it", judgement->lost);
    if (judgement->over > 0)
        printf(", error of t %.3g of its bound", judgement->over);
    if (judgement->displacement > 0)
        printf(", right if vertices move by %.3g u of their distance", judgement->displacement);
    if (judgement->verdict != VERDICT_WRONG && explain_is_wrong(ray))
        fputs("; but not the bits that C gives, as this engine promises", stdout);
    putchar('\n');
}

const char *explain_note_text(const struct replay_note *note)
{
    if (!note->tested)
        return "never reached";
    if (!note->hit)
        return "TURNED AWAY";
    return note->visited ? "entered" : note->skipped ? "SKIPPED" : "hit, never entered";
}

static void print_note(const struct explain_step *step)
{
    const struct replay_note *note = &step->note;
    fputs(explain_note_text(note), stdout);
    if (note->tested && note->hit && note->visited)
        printf(", t from %.9g", (double)note->entry);
    else if (note->tested && note->hit && note->skipped)
        printf(": entry %.9g is beyond the best t", (double)note->entry);
    putchar('\n');
}

static void print_way(const struct explanation *why)
{
    if (why->step_count == 0)
        return;
    printf("traversal path (cpu) to triangle %u\n", why->prim);
    printf("  %8s %8s %-6s box test\n", "node", "record", "kind");
    for (uint32_t i = 0; i < why->step_count; i++) {
        const struct explain_step *step = &why->step[i];
        printf("  %8u %8d %-6s ", step->note.node,
               step->record == EXPLAIN_NONE ? -1 : (int)step->record,
               step->leaf ? "leaf" : "inner");
        print_note(step);
        if (step->ref != REF_OK)
            printf("  %26s its children are not the tree's%s\n", "",
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

static void print_bound(const char *name, const struct explain_bound *bound)
{
    char exact[32], canonical[32], decoded[32];
    float_text_write(bound->exact, exact);
    float_text_write(bound->canonical, canonical);
    float_text_write(bound->decoded, decoded);
    printf("  %-5s %18s %18s %18s %12.4g %12lld  %s\n", name, exact, canonical, decoded,
           bound->half_steps, (long long)bound->float_steps, explain_fault_text(bound->fault));
    printf("  %-5s %18.9g %18.9g %18.9g\n", "", (double)bound->exact, (double)bound->canonical,
           (double)bound->decoded);
}

/* Prints the node where the traversal ended: words, bounds, slabs. */
static void print_node(const struct explain_step *step)
{
    static const char *const names[] = {"x lo", "x hi", "y lo", "y hi", "z lo", "z hi"};
    printf("node %u, record %u, words", step->note.node, step->record);
    for (uint32_t i = 0; i < step->word_count; i++)
        printf(" %08x", step->word[i]);
    printf("\n  %-5s %18s %18s %18s %12s %12s\n", "bound", "of its triangles", "of the tree",
           "in the bytes", "float16", "float32");
    for (int k = 0; k < 3; k++) {
        print_bound(names[2 * k], &step->lo[k]);
        print_bound(names[2 * k + 1], &step->hi[k]);
    }
    puts("  (the last two: steps outward from the triangles' bound to the bytes')");
    printf("  %-5s %18s %18s %24s %24s\n", "slab", "enter", "leave, padded", "enter exactly",
           "leave exactly");
    for (int k = 0; k < 3; k++)
        printf("  %-5c %18.9g %18.9g %24.17g %24.17g\n", "xyz"[k], (double)step -> slab[k].enter,
               (double)step->slab[k].leave, step->slab[k].exact_enter, step->slab[k].exact_leave);
    if (step->note.tested)
        printf("  box test: entry %.9g, best t so far %.9g, %s\n", (double)step->note.entry,
               (double)step->note.tbest, step->note.hit ? "hit" : "no hit");
}

static void print_end(const struct explain_page *page)
{
    const struct explanation *why = &page->ray->why;
    switch (why->end) {
    case END_BOX:
    case END_SKIPPED:
        print_node(&why->step[why->last]);
        break;
    case END_REFERENCE:
        printf("  no child reference that C followed leads to node %u\n",
               why->step[why->last].note.node);
        break;
    case END_SLOT:
        printf("  slot %u of its leaf should name triangle %u; ", why->slot, why->prim);
        if (why->slot_stored == ABI_NO_PRIM)
            puts("nothing is read there");
        else
            printf("it names triangle %u\n", why->slot_stored);
        break;
    case END_TRIANGLE:
        puts("  the triangle test rejects it");
        break;
    case END_FARTHER:
    case END_HIT:
        printf("  it is hit%s: ",
               why->end == END_FARTHER ? ", but not nearer than the best so far" : "");
        print_hit(&why->notes.prim_hit);
        putchar('\n');
        break;
    case END_NOWHERE:
        break;
    }
}

/* Prints the exact result for one triangle, and what the engine's formula can decide. */
static void print_triangle(const struct explain_page *page, uint32_t prim)
{
    const struct judged *judged = page->judged;
    const struct ray *ray = &page->ray->ray;
    struct oracle_pair pair;
    if (prim >= page->scene->tri_count || page->ray->truth.flags & ORACLE_REFUSED)
        return;
    oracle_pair(judged->from.oracle, ray, prim, &pair);
    printf("triangle %u exactly: %s", prim, oracle_class_name(pair.class));
    if (pair.class != ORACLE_MISS && pair.class != ORACLE_ZERO_AREA)
        printf(", t in [%.17g, %.17g], smallest barycentric %.3g", pair.t_lo, pair.t_hi,
               pair.margin);
    putchar('\n');
    if (judged->model.formula == TWIN_UNKNOWN || !ray_in_contract(ray))
        return;
    float v[3][3];
    scene_tri(page->scene, prim, v);
    struct twin twin = twin_eval(judged->model.formula, judged->model.rounding, ray, v);
    printf("  its formula: t = %.9g, off by at most %.3g; %s%s\n", (double)twin.t, twin.t_err,
           twin.certain    ? "certainly a hit"
           : twin.possible ? "hit or miss within its rounding"
                           : "certainly no hit",
           twin.det == 0 ? ", the determinant's sign is open" : "");
}

static void print_tried(const struct explanation *why)
{
    for (size_t i = 0; i < why->attempt_count; i++) {
        const struct explain_attempt *attempt = &why->attempt[i];
        if (!attempt->changed)
            continue;
        printf("  %-22s %s: ", cause_name(repair_cause(attempt->repair)),
               repair_text(attempt->repair));
        if (attempt->end != REPLAY_DONE)
            fputs("not finished", stdout);
        else
            print_hit(&attempt->hit);
        printf(": %s%s\n", attempt->opinion.allowed ? "allowed, " : "wrong, ",
               attempt->opinion.text);
    }
}

static void print_defect(const struct explain_imitation *one)
{
    fputs(defect_text(one->defect), stdout);
    if (defect_is_numbered(one->defect))
        printf(" (%u)", one->parameter);
}

/* Prints how a defect failed to predict the engine. With several parameters, the one that got
 * farthest is printed. */
static void print_failed(const struct explanation *why, enum defect defect)
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
    printf("  %-22s ", cause_name(defect_cause(defect)));
    print_defect(most);
    if (!most->same)
        puts(": gives another answer");
    else if (most->refuted)
        printf(": gives this answer, but not the engine's to %u of %u other rays\n",
               most->asked - most->witnesses, most->asked);
    else
        printf(": gives this answer, but only %u of %u other rays distinguish it from C\n",
               most->telling, most->asked);
}

static void print_imitated(const struct explanation *why)
{
    fputs("  C on the same bytes answers ", stdout);
    print_hit(&why->replayed);
    printf(": %s\n", why->replayed_opinion.text);
    const struct explain_imitation *one = &why->imitation[why->imitated];
    if (why->imitated < why->imitation_count && explain_is_shown(one)) {
        fputs("  C with this planted: ", stdout);
        print_defect(one);
        printf(": the same as the engine, also for %u of %u other rays; on %u of these C answers "
               "otherwise, on which the engine does as planted %u times\n",
               one->witnesses, one->asked, one->telling, one->told);
        return;
    }
    puts(why->witness_count > 0
             ? "  none of these planted in C predicts the engine's answers:"
             : "  none of these is confirmed, since no other ray could be traced:");
    for (enum defect defect = DEFECT_NONE + 1; defect < DEFECT_COUNT; defect++)
        print_failed(why, defect);
}

/* Prints hints if an engine with an unknown tree missed a triangle that is hit exactly, whether or
 * not the miss is allowed. */
static void print_hints(const struct explain_page *page)
{
    const struct judged_ray *ray = page->ray;
    struct outside_hint hint[OUTSIDE_HINTS];
    if (page->judged->known || !ray->answer.finished || ray->answer.hit.prim != ABI_NO_PRIM ||
        ray->truth.prim == ABI_NO_PRIM)
        return;
    size_t count = explain_outside(page->scene, &ray->ray, ray->truth.prim, hint);
    for (size_t i = 0; i < count; i++)
        printf("%s%s (%s)\n", i == 0 ? "lost by?   " : "           ", hint[i].text,
               cause_name(hint[i].cause));
}

/* Prints the other faults of a ray that has several. */
static void print_needed(const struct explanation *why)
{
    bool first = true;
    for (enum repair repair = 0; repair < REPAIR_COUNT; repair++) {
        enum cause cause = repair_cause(repair);
        if (!(why->needed >> repair & 1u))
            continue;
        if (!first)
            printf("  and     %s: %s (no repair helps alone)\n", cause_name(cause),
                   cause_text(cause));
        first = false;
    }
}

static void print_cause(const struct explain_page *page)
{
    const struct explanation *why = &page->ray->why;
    if (why->cause == CAUSE_NONE)
        return;
    printf("cause     %s: %s\n", cause_name(why->cause), cause_text(why->cause));
    print_needed(why);
    if (why->inside) {
        puts("  C on the same bytes answers the same; with one repair at a time it answers");
        print_tried(why);
        puts("  (repairs that change nothing are left out)");
    } else if (why->imitation_count > 0) {
        print_imitated(why);
    }
}

void explain_print(const struct explain_page *page)
{
    const struct judged_ray *ray = page->ray;
    char command[EXPLAIN_COMMAND_MOST];
    print_subject(page);
    print_truth(&ray->truth);
    fputs("answer    ", stdout);
    if (ray->answer.finished)
        print_hit(&ray->answer.hit);
    else
        fputs(ray->reason.text, stdout);
    putchar('\n');
    print_verdict(ray);
    print_way(&ray->why);
    print_end(page);
    print_triangle(page, ray->why.prim);
    if (ray->judgement.behind && ray->judgement.expected != ray->why.prim)
        print_triangle(page, ray->judgement.expected);
    if (ray->answer.finished && ray->answer.hit.prim != ray->why.prim)
        print_triangle(page, ray->answer.hit.prim);
    print_cause(page);
    print_hints(page);
    explain_command(page->of, &ray->ray, command);
    printf("again     %s\n", page->again ? page->again : command);
}
