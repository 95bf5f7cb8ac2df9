/* What an operation on float32 numbers may come to, by rational numbers: for tests of scatters. */
#ifndef SCATTER_TRUTH_H
#define SCATTER_TRUTH_H

#include "ref/twin/scatter.h"

enum scatter_op { SCATTER_ADD, SCATTER_SUB, SCATTER_MUL, SCATTER_DIV, SCATTER_OPS };

#define TRUTH_MOST 4096

/* All results that are legal, ascending, each once. */
struct scatter_truth {
    double value[TRUTH_MOST];
    int count;
    bool small;    /* one of them is neither 0 nor surely normal */
    bool beyond;   /* a divisor may be 0, or a result may not be finite */
    double lo, hi; /* of the exact results, each rounded outward */
};

/* Of all numbers that two lists have. An operand below 2^-126 may be 0 where `k` flushes. A result
 * is the nearest float32; one of the two around it if the error may be more than half a unit in the
 * last place. A product may also stay as it is where `k` fuses. */
void scatter_truth_make(const struct liberty *k, enum scatter_op op, const struct scatter *a,
                        const struct scatter *b, struct scatter_truth *out);

#endif
