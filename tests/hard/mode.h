/* The calling thread's handling of subnormals. */
#ifndef HARD_MODE_H
#define HARD_MODE_H

#if defined(__SSE2__)
#include <immintrin.h>
#endif

/* Sets flush-to-zero and denormals-are-zero; returns what mode_restore needs. On processors whose
 * mode is not known here nothing happens. */
static inline unsigned long mode_flush(void)
{
#if defined(__SSE2__)
    unsigned was = _mm_getcsr();
    _mm_setcsr(was | 0x8040u);
    return was;
#elif defined(__aarch64__)
    unsigned long was, on;
    __asm__ volatile("mrs %0, fpcr" : "=r"(was));
    on = was | 1ul << 24;
    __asm__ volatile("msr fpcr, %0" : : "r"(on));
    return was;
#else
    return 0;
#endif
}

static inline void mode_restore(unsigned long mode)
{
#if defined(__SSE2__)
    _mm_setcsr((unsigned)mode);
#elif defined(__aarch64__)
    __asm__ volatile("msr fpcr, %0" : : "r"(mode));
#else
    (void)mode;
#endif
}

#endif
