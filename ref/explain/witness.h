/* Other rays of a scene, and what an engine answers to them: a defect that is planted to imitate
 * the engine has to give these answers too. */
#ifndef EXPLAIN_WITNESS_H
#define EXPLAIN_WITNESS_H

#include "ref/explain/explain.h"

struct witnesses {
    struct ray ray[EXPLAIN_WITNESSES];
    struct explain_answer answer[EXPLAIN_WITNESSES]; /* without flags */
    uint32_t count; /* EXPLAIN_WITNESSES, or 0: there is nobody to ask */
};

/* Makes the rays of round `round` and asks the engine. */
void witnesses_ask(const struct explain_case *the, uint32_t round, struct witnesses *w);

#endif
