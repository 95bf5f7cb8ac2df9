/* Everything that the oracle states of a pair, against rationals. */
#ifndef TESTS_PAIR_FAULT_H
#define TESTS_PAIR_FAULT_H

#include "tests/exact/exact_gmp.h"

/* What is wrong with an answer, or NULL. */
const char *pair_fault(const struct ray *ray, const struct oracle_pair *got,
                       const struct gmp_pair *want);

/* The same of a nearest hit; `pair` is that of want->prim, if there is one. */
const char *answer_fault(const struct oracle_answer *got, const struct gmp_nearest *want,
                         const struct gmp_pair *pair);

/* Whether the set was not found by the filter alone: it has several, or its one left the filter. */
bool answer_is_exact(const struct oracle *oracle, const struct ray *ray,
                     const struct oracle_answer *answer);

/* Whether two answers agree in every number. */
bool answer_same(const struct oracle_answer *a, const struct oracle_answer *b);

#endif
