/* Causes of answers that C does not give on the same bytes: known defects, planted one at a time
 * until one gives the engine's answers. */
#ifndef EXPLAIN_IMITATE_H
#define EXPLAIN_IMITATE_H

#include "ref/explain/explain.h"

/* Finds the defect that predicts the engine: it gives `answer` (which may be not to finish) to the
 * ray and the engine's answers to other rays: first any of the scene, then those to which a defect
 * that is still possible answers otherwise than C, and more of them while two causes are equally
 * good. Sets imitation*, imitated, witness_count and cause: the defect's if it gives all of them
 * (for an engine that need not have C's bits: all but one in twenty) and at least EXPLAIN_TELLING
 * of them are evidence; else the cause for engines that no known defect predicts. Errors:
 * STATUS_MEMORY. */
enum status explain_imitate(const struct explain_case *the, const struct explain_answer *answer,
                            struct explanation *out) MUST_USE;

/* Whether other rays showed it: none refuted it, enough of them are evidence, and to enough it
 * gives hits. A stack without entries is never shown: the loss of each farther child has many
 * causes. */
bool explain_is_shown(const struct explain_imitation *one);

#endif
