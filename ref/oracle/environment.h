/* The floating-point environment that the oracle computes in. For the oracle's own files. */
#ifndef ORACLE_ENVIRONMENT_H
#define ORACLE_ENVIRONMENT_H

#if defined(__SSE2__)
#include <xmmintrin.h>

/* Sets round to nearest, no FTZ, no DAZ on this thread, whatever a caller or a library (Embree) has
 * left there; returns what to give environment_leave. */
static inline unsigned environment_enter(void)
{
    unsigned saved = _mm_getcsr();
    if (saved & 0xE040u) /* FTZ, rounding (two bits), DAZ */
        _mm_setcsr(saved & ~0xE040u);
    return saved;
}

static inline void environment_leave(unsigned saved)
{
    if (saved & 0xE040u)
        _mm_setcsr((_mm_getcsr() & ~0xE040u) | (saved & 0xE040u));
}
#else
#include <fenv.h>

static inline fenv_t environment_enter(void)
{
    fenv_t saved;
    fegetenv(&saved);
    fesetenv(FE_DFL_ENV);
    return saved;
}

static inline void environment_leave(fenv_t saved)
{
    fesetenv(&saved);
}
#endif

#endif
