/* Quotients with one divisor: are there a divisor and numerators in their scatters that give an
 * answer? For the replays (ref/twin/twin_replay.h). */
#ifndef QUOTIENTS_H
#define QUOTIENTS_H

#include "ref/twin/scatter.h"

/* A numerator and the answered quotient, or a range of them. */
struct quotients_part {
    struct scatter number;
    double lo, hi;
};

/* A divisor and its numerators. */
struct quotients {
    struct scatter divisor;
    struct quotients_part part[3];
    int parts;
    bool estimated; /* divisions are promised for some divisors only */
    double share;   /* relative error of a quotient */
    double tiny;    /* absolute */
    double above;   /* the divisor is larger than that */
    /* Where weights of one sign make a mean: the quotients of part 0 are between these, but for
     * `pad` over the divisor. */
    double mean_lo, mean_hi, pad;
};

/* True unless no divisor of that sign gives all quotients. */
bool quotients_fit(const struct quotients *given, bool negative);

/* The same of either sign. */
bool quotients_fit_either(const struct quotients *given);

#endif
