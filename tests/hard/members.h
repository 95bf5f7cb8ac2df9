/* All members that a hard case is played on: every combination of the tables, and the case's own
 * members that are wrong on purpose. A case of worlds is played on what traces worlds. */
#ifndef HARD_MEMBERS_H
#define HARD_MEMBERS_H

#include "tests/hard/run.h"

typedef void hard_visit(void *user, const struct hard_case *one, const struct hard_member *member);

/* The members of the tables that take part, each list NULL-terminated; borrowed. */
struct hard_tables {
    const struct layout *const *layout;
    const struct builder *const *builder;
    const struct box_test *const *box;
    const struct tri_test *const *tri;
    bool chosen; /* by the user: then no member that a case brings to show a defect */
};

/* Those of layouts[], builders[], box_tests[] and tri_tests[]. */
struct hard_tables hard_tables_all(void);

/* Whether a NULL-terminated table has the layout. */
bool hard_table_has(const struct layout *const *table, const struct layout *layout);

/* Calls `visit` for each, in an order that makes the most of a stage: neighbours share the tree,
 * then the layout, then box and triangle test. */
void hard_each_member(const struct hard_case *one, const struct hard_tables *tables,
                      hard_visit *visit, void *user);

/* The defect of the case that this member must show, or NULL. */
const struct hard_defect *hard_defect_of(const struct hard_case *one,
                                         const struct hard_member *member);

#endif
