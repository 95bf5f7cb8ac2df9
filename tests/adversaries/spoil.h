/* How answers are spoilt, see tests/adversaries/cheats.h. */
#ifndef TESTS_ADVERSARIES_SPOIL_H
#define TESTS_ADVERSARIES_SPOIL_H

#include "tests/adversaries/cheats.h"

typedef void spoil_fn(const struct lie *lie, size_t i, struct hit *hit);
typedef void spoil_list_fn(const struct lie *lie, size_t i, struct hit *hit, uint32_t *count,
                           uint32_t capacity);

extern spoil_fn drops_the_band, drops_by_class, drops_all_but_a_few, drops_all, pushes_t,
    steps_past_the_end, steps_before_the_begin, shifts_u, swaps_u_and_v, negates_zeros,
    takes_the_other_of_a_tie, sees_phantoms, takes_the_next, sees_the_degenerate, says_hit,
    says_triangle_0, answers_nonsense_out_of_contract, slides_in_the_plane, loses_thin_slabs,
    is_unstable, differs_in_batches, is_right_at_first, knows_some_directions, copies_its_neighbour,
    says_the_truth;
/* outsiders.c */
extern spoil_fn drops_what_is_excused, sees_what_is_excused, claims_the_degenerate, stretches_t,
    lies_alone, lies_in_batches, lies_later, lies_to_odd_rays, lies_once_in_a_while, forgets_backs,
    forgets_axes, forgets_the_end, stops_at_the_end, takes_anothers_place, answers_no_number,
    answers_next_to_0, fills_misses, names_the_next_triangle, claims_a_line;
extern spoil_list_fn lists_one_twice, leaves_one_out, swaps_two, leaves_out_the_band,
    keeps_the_nearest, leaves_out_the_ends;

#endif
