/* Refits of wide layouts: an invocation begins at a record without child records, and writes boxes
 * of child slots. What includes this file defines RECORD_WORDS or RECORD_AT, MAGNITUDE_MOST, bits
 * of the largest bound, read_slots and write_boxes. */
#ifndef BUILD_REFIT_WIDE_GLSL
#define BUILD_REFIT_WIDE_GLSL

#include "build_refit.glsl"
#include "build_axis.glsl"

#ifndef RECORD_AT /* the first word of a node */
#define RECORD_AT(ref) (RECORD_WORDS * (ref))
#endif

uint slot_first[8];        /* child record, or first item */
uint slot_count[8];        /* items; 0: a record */
uint slot_box[BOX_WORDS];  /* as in build_axis.glsl */

/* Decodes the slots of the record whose first word that is; returns bit s for each that is
 * there. */
uint read_slots(uint at);
/* Writes the boxes of those slots. */
void write_boxes(uint at, uint there);

void bound_slot(uint s)
{
    begin();
    if (slot_count[s] == 0u)
        grow_node(slot_first[s]);
    for (uint i = 0u; i < slot_count[s]; i++)
        grow_triangle(item_word[slot_first[s] + i]);
    for (uint k = 0u; k < 3u; k++) {
        slot_box[6u * s + k] = low[k];
        slot_box[6u * s + 3u + k] = high[k];
    }
}

void do_inner(uint ref)
{
    uint at = RECORD_AT(ref), there = read_slots(at);
    for (uint s = 0u; s < 8u; s++)
        if (((there >> s) & 1u) != 0u)
            bound_slot(s);
    begin();
    for (uint s = 0u; s < 8u; s++)
        for (uint k = 0u; k < 3u && ((there >> s) & 1u) != 0u; k++)
            grow(k, slot_box[6u * s + k], slot_box[6u * s + 3u + k]);
    for (uint k = 0u; k < 3u; k++) {
        box_word[6u * ref + k] = low[k];
        box_word[6u * ref + 3u + k] = high[k];
        if (max(low[k] & 0x7FFFFFFFu, high[k] & 0x7FFFFFFFu) > MAGNITUDE_MOST)
            atomicAdd(state[ABI_REFIT_BEYOND], 1u);
    }
    write_boxes(at, there);
}

void do_first(uint ref)
{
    do_inner(ref);
}

#endif
