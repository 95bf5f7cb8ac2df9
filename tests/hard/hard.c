#include "tests/hard/hard.h"

#include "ref/twin/model.h"

#include <math.h>
#include <stdlib.h>

void hard_part_free(struct hard_part *part)
{
    scene_free(&part->scene);
    world_free(&part->world);
    free(part->ray);
    free(part->mode);
    free(part->want);
    free(part->id);
    free(part->prim_of);
    *part = (struct hard_part){0};
}

void hard_free(struct hard_made *made)
{
    for (size_t i = 0; i < made->part_count; i++)
        hard_part_free(&made->part[i]);
    made->part_count = 0;
}

enum status hard_make(const struct hard_case *one, struct hard_made *out, struct reason *reason)
{
    out->part_count = 0;
    for (size_t i = 0; i < HARD_PARTS_MOST; i++)
        out->part[i] = (struct hard_part){0};
    one->make(out);
    for (size_t i = 0; i < out->part_count; i++) {
        struct hard_part *part = &out->part[i];
        struct reason why;
        if (part->failed)
            return fail(reason, STATUS_MEMORY, "hard case %u, part %s: no memory, or no such scene",
                        one->number, part->label);
        const enum status rules = part->is_world    ? world_finish(&part->world, &why)
                                  : part->bad_scene ? STATUS_OK
                                                    : scene_check(&part->scene, &why);
        if (rules)
            return fail(reason, STATUS_INPUT, "hard case %u, part %s: %.200s", one->number,
                        part->label, why.text);
    }
    return STATUS_OK;
}

const char *hard_property_name(enum hard_property property)
{
    static const char *const names[PROPERTY_COUNT] = {
        "kept",   "verdict", "hit",       "miss",   "id",     "t",    "ends",
        "like",   "culled",  "bits",      "repeat", "any",    "mode", "stray",
        "finite", "refusal", "structure", "budget", "parity", "tag",
    };
    return (size_t)property < PROPERTY_COUNT ? names[property] : "unknown";
}

static bool in_scope(enum hard_scope scope, const struct model *model)
{
    bool asked =
        model->watertight || model->formula == TWIN_UNKNOWN || model->formula == TWIN_EMBREE_ROBUST;
    return scope == HARD_ALL || (scope == HARD_OWN && twin_is_own(model->formula)) ||
           (scope == HARD_LEAN && twin_is_own(model->formula) && model->formula != TWIN_PLUECKER) ||
           (scope == HARD_TIGHT && model->watertight) || (scope == HARD_FANS && asked);
}

static bool names_one_of(const struct hard_part *part, const struct hard_want *want, uint32_t prim)
{
    for (uint32_t i = 0; i < want->id_count; i++)
        if (part->id[want->id_first + i] == prim)
            return true;
    return false;
}

/* The widest component is the only one as wide: then woop chooses the same axis however they are
 * named. */
static bool one_axis_is_largest(const float dir[3])
{
    float a = fabsf(dir[0]), b = fabsf(dir[1]), c = fabsf(dir[2]);
    float most = fmaxf(a, fmaxf(b, c));
    return (a == most) + (b == most) + (c == most) == 1;
}

/* The other ray's answer, turned into what this one's should be. */
static bool is_like(const struct hard_part *part, size_t i, const struct hard_subject *subject,
                    const struct hit *answer, const struct hit *like, bool excused)
{
    const struct hard_want *want = &part->want[i];
    bool hit = answer->prim != ABI_NO_PRIM;
    uint32_t prim = answer->prim;
    if (hit && part->prim_of)
        prim = prim < part->scene.tri_count ? part->prim_of[prim] : ABI_NO_PRIM;
    if (hit != (like->prim != ABI_NO_PRIM))
        return excused;
    if (!hit || subject->any)
        return true;
    if (prim != like->prim)
        return excused;
    bool mt = subject->model.formula == TWIN_MT || subject->model.formula == TWIN_MT_RTRS;
    bool woop = subject->model.formula == TWIN_WOOP && one_axis_is_largest(part->ray[i].dir);
    if (!(mt && part->like_bits & HARD_LIKE_MT) && !(woop && part->like_bits & HARD_LIKE_WOOP))
        return true;
    return answer->t == ldexpf(like->t, want->shift) - want->add;
}

/* True if quotients are rounded to nearest. Others differ from processor to processor, such as
 * Embree's, of an estimate of the reciprocal; they are held to their bound alone. */
static bool divides(const struct model *model)
{
    return model->formula == TWIN_UNKNOWN || model->rounding.div <= 1;
}

enum hard_property hard_check(const struct hard_part *part, size_t i,
                              const struct hard_subject *subject, const struct hit *answer,
                              const struct hit *like, bool excused)
{
    const struct hard_want *want = &part->want[i];
    bool hit = answer->prim != ABI_NO_PRIM;
    if (!in_scope(want->scope, &subject->model))
        return PROPERTY_KEPT;
    if (want->what & WANT_HIT && !hit)
        return PROPERTY_HIT;
    if (want->what & WANT_MISS && hit)
        return PROPERTY_MISS;
    if (want->what & WANT_ENDS && hit == subject->model.open)
        return PROPERTY_ENDS;
    if (want->what & WANT_ID && hit && !subject->any && !names_one_of(part, want, answer->prim))
        return PROPERTY_ID;
    if (want->what & WANT_T && hit && !subject->any && divides(&subject->model) &&
        !(answer->t == want->t))
        return PROPERTY_T;
    if (want->what & WANT_LIKE && like && !is_like(part, i, subject, answer, like, excused))
        return PROPERTY_LIKE;
    return PROPERTY_KEPT;
}
