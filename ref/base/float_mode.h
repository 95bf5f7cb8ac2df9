/* Rounding mode and treatment of subnormals in the calling thread: its control register. */
#ifndef REF_FLOAT_MODE_H
#define REF_FLOAT_MODE_H

/* FLOAT_MODES: all bits that affect results of ordinary floats. FLOAT_FLUSH: subnormal operands and
 * results become 0; 0 on unsupported processors. FLOAT_UP, FLOAT_DOWN: rounding; nearest is 0. */
#if defined(__SSE2__)
#include <immintrin.h>

enum { FLOAT_DOWN = 0x2000, FLOAT_UP = 0x4000, FLOAT_FLUSH = 0x8040, FLOAT_MODES = 0xE040 };

/* Returns the register; change a copy and pass it to float_mode_set. */
static inline unsigned long float_mode(void)
{
    return _mm_getcsr();
}

static inline void float_mode_set(unsigned long mode)
{
    _mm_setcsr((unsigned)mode);
}
#elif defined(__aarch64__)
/* FPCR (Arm Architecture Reference Manual): FIZ and AH, present on newer processors, are bits 0 and
 * 1, RMode 22 and 23, FZ 24. */
enum {
    FLOAT_UP = 0x400000,
    FLOAT_DOWN = 0x800000,
    FLOAT_FLUSH = 0x1000000,
    FLOAT_MODES = 0x1C00003
};

static inline unsigned long float_mode(void)
{
    unsigned long mode;
    __asm__ volatile("mrs %0, fpcr" : "=r"(mode) : : "memory");
    return mode;
}

static inline void float_mode_set(unsigned long mode)
{
    __asm__ volatile("msr fpcr, %0" : : "r"(mode) : "memory");
}
#else
#include <fenv.h>

enum {
    FLOAT_DOWN = FE_DOWNWARD,
    FLOAT_UP = FE_UPWARD,
    FLOAT_FLUSH = 0,
    FLOAT_MODES = FE_DOWNWARD | FE_UPWARD | FE_TONEAREST | FE_TOWARDZERO
};

static inline unsigned long float_mode(void)
{
    return (unsigned long)fegetround();
}

static inline void float_mode_set(unsigned long mode)
{
    fesetround((int)mode);
}
#endif

#endif
