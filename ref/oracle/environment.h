/* The floating-point environment that the oracle computes in. For the oracle's own files. */
#ifndef ORACLE_ENVIRONMENT_H
#define ORACLE_ENVIRONMENT_H

#include "ref/base/float_mode.h"

/* Sets round to nearest, no FTZ, no DAZ on this thread, whatever the caller or a library (Embree)
 * has set; returns the argument for environment_leave. */
static inline unsigned long environment_enter(void)
{
    unsigned long saved = float_mode();
    float_mode_set(saved & ~(unsigned long)FLOAT_MODES);
    return saved;
}

static inline void environment_leave(unsigned long saved)
{
    float_mode_set((float_mode() & ~(unsigned long)FLOAT_MODES) | (saved & FLOAT_MODES));
}

#endif
