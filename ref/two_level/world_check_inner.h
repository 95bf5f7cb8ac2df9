/* A check of a packed world in progress; for ref/two_level/world_check.c and part_check.c. */
#ifndef WORLD_CHECK_INNER_H
#define WORLD_CHECK_INNER_H

#include "ref/two_level/world_check.h"

struct world_check {
    const struct world *world;
    const struct packed_world *packed;
    struct world_faults faults;
    struct reason *reason;
    enum status status; /* STATUS_INPUT once a fault is reported; STATUS_MEMORY */
};

/* Reports a fault; the first is described. */
void world_check_report(struct world_check *check, enum world_rule rule, const char *format, ...)
    PRINTF_LIKE(3, 4);

/* True if the box of an entry contains triangle `prim` of its instance's mesh, placed; else the
 * fault is counted and reported. */
bool world_check_placed(struct world_check *check, uint32_t entry, uint32_t prim);

/* Checks the parts of opened instances: that each tree of a part is a tree of the triangles that it
 * names, that the box of each part contains them, that the parts of an instance have each triangle
 * of its mesh once, that share and reach suffice. The numbers of entries and trees are checked
 * before. Returns STATUS_OK or STATUS_MEMORY. */
enum status world_check_parts(struct world_check *check) MUST_USE;

#endif
