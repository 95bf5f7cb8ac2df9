/* An engine's arithmetic, as far as it is known: all that the judge needs to bound its errors. */
#ifndef MODEL_H
#define MODEL_H

#include <stdbool.h>

/* The formula whose errors are bounded. The first five are those of ref/primitives/, the sixth is
 * that of ref/kd/accel.h; the next two are Embree's default and robust triangle tests, from their
 * published descriptions. */
enum twin_formula {
    TWIN_MT,
    TWIN_MT_RTRS,
    TWIN_WOOP,
    TWIN_PLUECKER,
    TWIN_BALDWIN_WEBBER,
    TWIN_TRI_ACCEL,
    TWIN_EMBREE,
    TWIN_EMBREE_ROBUST,
    TWIN_UNKNOWN, /* judged geometrically: by the smallest vertex displacement that excuses it */
};

/* True for the tests that are written here, each operation of which is known. */
static inline bool twin_is_own(enum twin_formula formula)
{
    return formula <= TWIN_TRI_ACCEL;
}

/* The error of one float32 operation. add, mul and div: its error is at most so many u of the exact
 * result (u = 2^-24, at least 1 each); div is also the error of a reciprocal where a formula has
 * one. Above 1 the error of a division is promised for divisors between 2^-125 and 2^125 only.
 * tiny: the largest absolute error near zero, 2^-149; or 2^-126 if subnormal operands and results
 * may be flushed to zero, each or none. Fusing a multiplication with an addition leaves out a
 * rounding, so it is always within. */
struct rounding {
    double add, mul, div;
    double tiny;
};

/* IEEE round to nearest: C, and a driver whose operator probe found every bit equal. */
#define ROUNDING_IEEE ((struct rounding){1.0, 1.0, 1.0, 0x1p-149})
/* The same with subnormal operands and results flushed to zero. */
#define ROUNDING_FLUSHED ((struct rounding){1.0, 1.0, 1.0, 0x1p-126})
/* Embree: reciprocals by an estimate (relative error at most 1.5 * 2^-12 by the processor's manual)
 * and one Newton step: 1.5^2 u + 2.5 u = 4.75 u without fused operations, less with them or with
 * the better estimate of AVX-512; 5.5 u until the instruction set is known. */
#define ROUNDING_EMBREE ((struct rounding){1.0, 1.0, 5.5, 0x1p-126})
/* Vulkan's specification without a rounding mode: either neighbour, division 2.5 ULP. */
#define ROUNDING_VULKAN ((struct rounding){2.0, 2.0, 5.0, 0x1p-126})
/* WGSL, sections "Floating Point Accuracy" and "Differences from IEEE-754": + - * to either
 * neighbour, division 2.5 ULP for divisors between 2^-126 and 2^126, subnormal operands and results
 * flushed or not. It also lets a compiler reorder the operations of an expression, for which no
 * bound is given: no shader of raydiff has two that it could (shaders/wgsl/job.wgsl). */
#define ROUNDING_WGSL ((struct rounding){2.0, 2.0, 5.0, 0x1p-126})
/* The same with RoundingModeRTE. */
#define ROUNDING_VULKAN_RTE ((struct rounding){1.0, 1.0, 5.0, 0x1p-126})

/* Embree's published constants. */
#ifndef EMBREE_BAND /* a test turns it */
/* Robust triangle test: an edge function may have the other sign by this share of their sum. */
#define EMBREE_BAND 0x1p-23
#endif
/* Default box test, b / d - o / d: error of a plane's distance, in u (|b| + |o|) / |d|. */
#define EMBREE_SLAB_ERROR 9.0
/* Smaller components of the direction are replaced by this one. */
#define EMBREE_LEAST_DIR 1e-18

/* Rounding to nearest keeps the order of the products in an edge function, which is what makes
 * Woop's test watertight; from a looser promise nothing follows. */
static inline bool rounding_is_nearest(struct rounding rounding)
{
    return rounding.add <= 1.0 && rounding.mul <= 1.0;
}

struct model {
    enum twin_formula formula;
    struct rounding rounding;
    bool bits;        /* must equal engine cpu's bits on the same packed tree */
    bool watertight;  /* no ray passes between two triangles that share an edge: no boundary band on
                         a closed fan */
    bool open;        /* tmin < t < tmax; else ends are hits too */
    bool slab;        /* Embree's default box test, b/d - o/d: see VERDICT_SLAB */
    bool any_unnamed; /* any-hit answers are hit or miss without a triangle */
    double displacement; /* TWIN_UNKNOWN: what is allowed, in units; 0: JUDGE_DISPLACEMENT_MOST */
};

#endif
