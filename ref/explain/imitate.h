/* Causes of answers that C does not give on the same bytes: known defects, planted one at a time
 * until one gives the engine's answers. */
#ifndef EXPLAIN_IMITATE_H
#define EXPLAIN_IMITATE_H

#include "ref/explain/explain.h"

/* Finds the defect that gives `answer` (also: not to finish) for the ray and, of several, the
 * engine's answers to the most witnesses (other rays at the scene, more of them while two causes
 * are equal); the earliest in the table if they stay so. Sets imitation*, imitated, witness_count
 * and cause: the defect's if it gives all witnesses (of an engine that need not have C's bits: all
 * but one in twenty), else what is left when no known defect fits. Errors: STATUS_MEMORY. */
enum status explain_imitate(const struct explain_case *the, const struct explain_answer *answer,
                            struct explanation *out) MUST_USE;

#endif
