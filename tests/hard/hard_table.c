#include "tests/hard/hard.h"

extern const struct hard_case hard_bad_input_cases[], hard_boxes_cases[], hard_closed_cases[],
    hard_directions_cases[], hard_drivers_cases[], hard_halves_cases[], hard_limits_cases[],
    hard_metamorphic_cases[], hard_planes_cases[], hard_range_cases[], hard_scale_cases[],
    hard_seed_cases[], hard_shapes_cases[], hard_known_cases[], hard_world_levels_cases[],
    hard_world_names_cases[], hard_world_rules_cases[], hard_world_transforms_cases[];

/* Each ends at the first without a number. */
static const struct hard_case *const tables[] = {
    hard_bad_input_cases,   hard_boxes_cases,       hard_closed_cases,
    hard_directions_cases,  hard_drivers_cases,     hard_halves_cases,
    hard_limits_cases,      hard_metamorphic_cases, hard_planes_cases,
    hard_range_cases,       hard_scale_cases,       hard_seed_cases,
    hard_shapes_cases,      hard_known_cases,       hard_world_levels_cases,
    hard_world_names_cases, hard_world_rules_cases, hard_world_transforms_cases};

/* The case with the next number, or NULL. */
static const struct hard_case *case_after(unsigned number)
{
    const struct hard_case *next = NULL;
    for (size_t t = 0; t < ARRAY_COUNT(tables); t++)
        for (const struct hard_case *one = tables[t]; one->number; one++)
            if (one->number > number && (!next || one->number < next->number))
                next = one;
    return next;
}

const struct hard_case *hard_case_at(size_t place)
{
    const struct hard_case *one = case_after(0);
    for (size_t i = 0; one && i < place; i++)
        one = case_after(one->number);
    return one;
}
