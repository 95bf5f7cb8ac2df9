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
    is_moody, differs_in_batches, is_right_at_first, knows_some_directions, copies_its_neighbour,
    says_the_truth;
extern spoil_list_fn lists_one_twice, leaves_one_out, swaps_two;

#endif
