/* The arithmetic that a peer reports. */
#include "ref/outside/pipe.h"
#include "ref/primitives/test_run.h"
#include "ref/twin/model.h"

static const struct {
    const char *name;
    enum twin_formula formula;
} formulas[] = {{"unknown", TWIN_UNKNOWN},
                {"mt", TWIN_MT},
                {"woop", TWIN_WOOP},
                {"embree", TWIN_EMBREE},
                {"embree_robust", TWIN_EMBREE_ROBUST},
                {"pluecker", TWIN_PLUECKER},
                {"baldwin_webber", TWIN_BALDWIN_WEBBER},
                {"tri_accel", TWIN_TRI_ACCEL}};

static const char *const roundings[] = {"ieee", "flushed", "vulkan", "vulkan_rte", "embree"};

const char *pipe_formula_name(uint32_t formula)
{
    return formula < ARRAY_COUNT(formulas) ? formulas[formula].name : NULL;
}

const char *pipe_rounding_name(uint32_t rounding)
{
    return rounding < ARRAY_COUNT(roundings) ? roundings[rounding] : NULL;
}

enum status pipe_list_check(const struct hit *hit, uint32_t count, uint32_t capacity,
                            uint32_t triangles, struct reason *reason)
{
    if (count / 2 > triangles)
        return fail(reason, STATUS_INPUT, "has %u hits on %u triangles", count, triangles);
    for (uint32_t k = 0; k < count && k < capacity; k++) {
        if (hit[k].prim == ABI_NO_PRIM)
            return fail(reason, STATUS_INPUT, "has a miss as hit %u of %u", k, count);
        if (hit[k].prim >= triangles)
            return fail(reason, STATUS_INPUT, "names triangle %u of %u", hit[k].prim, triangles);
    }
    return STATUS_OK;
}

enum status pipe_displacement(float units, struct model *model, struct reason *reason)
{
    if (units == 0.0f)
        return STATUS_OK;
    if (!(units > 0.0f && units <= PIPE_DISPLACEMENT_MOST))
        return fail(reason, STATUS_INPUT, "displacement %g is not above 0, at most %g",
                    (double)units, (double)PIPE_DISPLACEMENT_MOST);
    if (model->formula != TWIN_UNKNOWN)
        return fail(reason, STATUS_INPUT,
                    "displacement %g beside a formula, which has its own bound", (double)units);
    model->displacement = (double)units;
    return STATUS_OK;
}

enum status pipe_model(uint32_t formula, uint32_t rounding, uint32_t flags, struct model *out,
                       struct reason *reason)
{
    const struct rounding known[] = {ROUNDING_IEEE, ROUNDING_FLUSHED, ROUNDING_VULKAN,
                                     ROUNDING_VULKAN_RTE, ROUNDING_EMBREE};
    *out = (struct model){.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
    if (formula >= ARRAY_COUNT(formulas))
        return fail(reason, STATUS_INPUT, "formula %u is not one of 0 to %zu", formula,
                    ARRAY_COUNT(formulas) - 1);
    if (rounding >= ARRAY_COUNT(known))
        return fail(reason, STATUS_INPUT, "rounding %u is not one of 0 to %zu", rounding,
                    ARRAY_COUNT(known) - 1);
    if (flags & ~(PIPE_FLAG_OPEN | PIPE_FLAG_WATERTIGHT | PIPE_FLAG_UNNAMED))
        return fail(reason, STATUS_INPUT,
                    "flags 0x%x have more than open 1, watertight 2, unnamed 4", flags);
    *out = (struct model){.formula = formulas[formula].formula,
                          .rounding = known[rounding],
                          .slab = formulas[formula].formula == TWIN_EMBREE,
                          .open = (flags & PIPE_FLAG_OPEN) != 0,
                          .watertight = (flags & PIPE_FLAG_WATERTIGHT) != 0,
                          .any_unnamed = (flags & PIPE_FLAG_UNNAMED) != 0};
    return STATUS_OK;
}
