/* The table of outsiders.c: fewer rays are enough, and some lies take many judgements a ray. */
#include "tests/adversaries/spoil.h"

#define CLOSEST QUERY_CLOSEST
#define SECRET                                                                                     \
    {                                                                                              \
        .formula = TWIN_UNKNOWN                                                                    \
    }
#define SAYS(form, round)                                                                          \
    {                                                                                              \
        .formula = form, .rounding = round                                                         \
    }
#define IEEE                                                                                       \
    {                                                                                              \
        1, 1, 1, 0x1p-149                                                                          \
    }
#define EMBREE                                                                                     \
    {                                                                                              \
        1, 1, 5.5, 0x1p-126                                                                        \
    }
#define SAYS_EMBREE                                                                                \
    {                                                                                              \
        .formula = TWIN_EMBREE, .rounding = EMBREE, .slab = true                                   \
    }

const struct cheat outsiders[] = {
    {"a triangle without area hides all, as mt", "noise", NULL, RAYS_PRIMARY, 0, CLOSEST,
     SAYS(TWIN_MT, IEEE), sees_the_degenerate, true, 0, false, NULL},
    {"a triangle without area hides all, as woop", "noise", NULL, RAYS_PRIMARY, 0, CLOSEST,
     SAYS(TWIN_WOOP, IEEE), sees_the_degenerate, true, 0, false, NULL},
    {"a triangle without area hides all, as pluecker", "noise", NULL, RAYS_PRIMARY, 0, CLOSEST,
     SAYS(TWIN_PLUECKER, IEEE), sees_the_degenerate, true, 0, false, NULL},
    {"a triangle without area hides all, as baldwin_webber", "noise", NULL, RAYS_PRIMARY, 0,
     CLOSEST, SAYS(TWIN_BALDWIN_WEBBER, IEEE), sees_the_degenerate, true, 0, false, NULL},
    {"a triangle without area hides all, as embree", "noise", NULL, RAYS_PRIMARY, 0, CLOSEST,
     SAYS(TWIN_EMBREE, EMBREE), sees_the_degenerate, true, 0, false, NULL},
    {"a triangle without area hides all, as embree_robust", "noise", NULL, RAYS_PRIMARY, 0, CLOSEST,
     SAYS(TWIN_EMBREE_ROBUST, EMBREE), sees_the_degenerate, true, 0, false, NULL},
    {"what of it is excused, without area, as mt", "noise", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_MT, IEEE), claims_the_degenerate, false, 0, false, NULL},
    {"what of it is excused, without area, as woop", "noise", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_WOOP, IEEE), claims_the_degenerate, false, 0, false, NULL},
    {"what of it is excused, without area, as pluecker", "noise", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_PLUECKER, IEEE), claims_the_degenerate, false, 0, false, NULL},
    {"what of it is excused, without area, as baldwin_webber", "noise", NULL, RAYS_MIXED, 0,
     CLOSEST, SAYS(TWIN_BALDWIN_WEBBER, IEEE), claims_the_degenerate, false, 0, false, NULL},
    {"what of it is excused, without area, as embree", "noise", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_EMBREE, EMBREE), claims_the_degenerate, false, 0.002, false, NULL},
    {"what of it is excused, without area, as embree_robust", "noise", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_EMBREE_ROBUST, EMBREE), claims_the_degenerate, false, 0.002, false, NULL},
    {"hidden by triangles that are lines, a black box", "noise", NULL, RAYS_MIXED, 0, CLOSEST,
     SECRET, claims_a_line, false, 0.01, false, NULL},
    {"hidden by triangles that are lines, as mt", "noise", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_MT, IEEE), claims_a_line, false, 0.005, false, NULL},
    {"hidden by triangles that are lines, as woop", "noise", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_WOOP, IEEE), claims_a_line, false, 0.005, false, NULL},
    {"hidden by triangles that are lines, as pluecker", "noise", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_PLUECKER, IEEE), claims_a_line, false, 0.005, false, NULL},
    {"hidden by triangles that are lines, as baldwin_webber", "noise", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_BALDWIN_WEBBER, IEEE), claims_a_line, false, 0.005, false, NULL},
    {"phantoms that are excused, as mt", "boundary", "sphere:n=8", RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_MT, IEEE), sees_what_is_excused, false, 0.03, false, NULL},
    {"phantoms that are excused, as woop", "boundary", "sphere:n=8", RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_WOOP, IEEE), sees_what_is_excused, false, 0.02, false, NULL},
    {"phantoms that are excused, as pluecker", "boundary", "sphere:n=8", RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_PLUECKER, IEEE), sees_what_is_excused, false, 0.015, false, NULL},
    {"phantoms that are excused, as baldwin_webber", "boundary", "sphere:n=8", RAYS_MIXED, 0,
     CLOSEST, SAYS(TWIN_BALDWIN_WEBBER, IEEE), sees_what_is_excused, false, 0.035, false, NULL},
    {"drops all that is excused, as mt", "boundary", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_MT, IEEE), drops_what_is_excused, false, 0.2, false, NULL},
    {"drops all that is excused, as woop", "boundary", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_WOOP, IEEE), drops_what_is_excused, false, 0.2, false, NULL},
    {"drops all that is excused, as pluecker", "boundary", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_PLUECKER, IEEE), drops_what_is_excused, false, 0.2, false, NULL},
    {"drops all that is excused, as baldwin_webber", "boundary", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_BALDWIN_WEBBER, IEEE), drops_what_is_excused, false, 0.25, false, NULL},
    {"drops all that is excused, as embree", "boundary", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_EMBREE, EMBREE), drops_what_is_excused, false, 0.2, false, NULL},
    {"drops all that is excused, as embree_robust", "boundary", NULL, RAYS_MIXED, 0, CLOSEST,
     SAYS(TWIN_EMBREE_ROBUST, EMBREE), drops_what_is_excused, false, 0.2, false, NULL},
    {"drops all that is excused, with Embree's slabs", "slab", "grid:n=8,height=0", RAYS_PRIMARY, 0,
     CLOSEST, SAYS_EMBREE, drops_what_is_excused, false, 0.2, false, NULL},
    {"the same from 50 sizes away", "slab", "grid:n=8,height=0", RAYS_FAR, 50, CLOSEST, SAYS_EMBREE,
     drops_what_is_excused, false, 0.2, false, NULL},
    {"the largest t that is excused", "E of t", NULL, RAYS_PRIMARY, 1, CLOSEST, SECRET, stretches_t,
     false, 1, false, NULL},
    /* No ray is traced alone: nothing that a row traces is spoiled. */
    {"wrong when asked alone", "repeats", NULL, RAYS_MIXED, 0, CLOSEST, SECRET, lies_alone, false,
     0, false, NULL},
    {"right when asked alone only", "repeats", NULL, RAYS_MIXED, 0, CLOSEST, SECRET,
     lies_in_batches, true, 0, false, NULL},
    {"wrong from the second call on", "repeats", NULL, RAYS_MIXED, 1, CLOSEST, SECRET, lies_later,
     true, 0, false, NULL},
    {"wrong from the third call on", "repeats", NULL, RAYS_MIXED, 2, CLOSEST, SECRET, lies_later,
     false, 0, false, NULL},
    {"t of odd rays 2^-10 off", "samples", NULL, RAYS_PRIMARY, 0, CLOSEST, SECRET, lies_to_odd_rays,
     true, 0, false, NULL},
    {"misses one hit of 499", "samples", NULL, RAYS_PRIMARY, 499, CLOSEST, SECRET,
     lies_once_in_a_while, true, 0, false, NULL},
    {"misses one hit of 499, any hit", "samples", NULL, RAYS_PRIMARY, 499, QUERY_ANY, SECRET,
     lies_once_in_a_while, true, 0, false, NULL},
    {"misses backs of triangles", "samples", "soup:n=500", RAYS_PRIMARY, 0, CLOSEST, SECRET,
     forgets_backs, true, 0, false, NULL},
    {"misses along directions with a 0", "samples", NULL, RAYS_AXIS, 0, CLOSEST, SECRET,
     forgets_axes, true, 0, false, NULL},
    {"misses hits at tmax exactly", "border", NULL, RAYS_RANGES, 0, CLOSEST, SECRET,
     forgets_the_end, false, 0.2, false, NULL},
    {"t is always tmax", "border", NULL, RAYS_RANGES, 0, CLOSEST, SECRET, stops_at_the_end, true, 0,
     false, NULL},
    {"u and v of the ray before", "barycentrics", NULL, RAYS_PRIMARY, 0, CLOSEST, SECRET,
     takes_anothers_place, true, 0, false, NULL},
    {"t is no number", "numbers", NULL, RAYS_PRIMARY, 0, CLOSEST, SECRET, answers_no_number, true,
     0, false, NULL},
    {"t is -0 or 2^-149", "numbers", NULL, RAYS_PRIMARY, 0, CLOSEST, SECRET, answers_next_to_0,
     true, 0, false, NULL},
    {"misses filled with rubbish", "bits", NULL, RAYS_MIXED, 0, CLOSEST, SECRET, fills_misses, true,
     0, false, NULL},
    {"names the next triangle", "names", NULL, RAYS_PRIMARY, 0, CLOSEST, SECRET,
     names_the_next_triangle, true, 0, false, NULL},
    {"the same, any hit", "names", NULL, RAYS_PRIMARY, 0, QUERY_ANY, SECRET,
     names_the_next_triangle, true, 0, false, NULL},
};
const size_t outsider_count = ARRAY_COUNT(outsiders);
