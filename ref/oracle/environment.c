#include "ref/oracle/environment.h"

#include "ref/oracle/oracle.h"

#include <float.h>

#ifdef __FAST_MATH__
#error "the oracle's filter needs IEEE arithmetic"
#endif

enum status oracle_environment(struct reason *reason)
{
    /* volatile: computed at run time, not by the compiler. */
    volatile double tiny = DBL_MIN, near_one = 1 + 0x1p-30, tail = 1 + 0x1p-29;
    volatile double half = 0.5, one = 1, tie = 0x1p-53;
    if (FLT_EVAL_METHOD != 0)
        return fail(reason, STATUS_UNSUPPORTED,
                    "oracle: float expressions are evaluated in a wider type (FLT_EVAL_METHOD %d)",
                    (int)FLT_EVAL_METHOD);
    /* Not by fegetround, which on x86 may look at the x87 unit alone. */
    if (one + tie != one || one + (tie + tie / 2) == one || -one - tie != -one)
        return fail(reason, STATUS_UNSUPPORTED, "oracle: the rounding mode is not to nearest");
    /* Either the product is flushed or the comparison takes it as zero. */
    if (tiny * half == 0)
        return fail(reason, STATUS_UNSUPPORTED, "oracle: subnormals are taken as zero (FTZ, DAZ)");
    /* (1 + 2^-30)^2 = 1 + 2^-29 + 2^-60, which rounds to the tail unless it is fused. */
    double x = near_one, fused = x * x - tail;
    if (fused != 0)
        return fail(reason, STATUS_UNSUPPORTED, "oracle: multiply and subtract are contracted");
    return STATUS_OK;
}
