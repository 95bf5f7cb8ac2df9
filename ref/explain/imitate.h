/* Causes of answers that C does not give on the same bytes: known defects, planted one at a time
 * until one gives the engine's answers. */
#ifndef EXPLAIN_IMITATE_H
#define EXPLAIN_IMITATE_H

#include "ref/explain/explain.h"

/* Finds the defect that predicts the engine: it gives `answer` (also: not to finish) for the ray
 * and the engine's answers to other rays: some at all of the scene, then such to which a defect
 * that is still possible answers otherwise than C does, more of them while two causes are as good.
 * Sets imitation*, imitated, witness_count and cause: the defect's if it gives all of them (of an
 * engine that need not have C's bits: all but one in twenty) and EXPLAIN_TELLING of them or more
 * told of it; else what is left when no known defect predicts. Errors: STATUS_MEMORY. */
enum status explain_imitate(const struct explain_case *the, const struct explain_answer *answer,
                            struct explanation *out) MUST_USE;

/* Whether other rays showed it: none refuted it, enough of them told, and to enough others it gives
 * hits. A stack of no entries at all is never shown: that each farther child is lost has many
 * causes. */
bool explain_is_shown(const struct explain_imitation *one);

#endif
