/* Eight twins at a time, by vectors. For the twins. */
#ifndef TWIN_LANES_H
#define TWIN_LANES_H

#include "ref/twin/model.h"

#include <stdbool.h>

#define TWIN_LANES 8

/* A number of each pair. Axes are in the order of the formula (twin_axes). */
struct twin_input {
    float o[3][TWIN_LANES], d[3][TWIN_LANES], v[3][3][TWIN_LANES];
};

/* The results of the formula: x and e of struct bounded. */
enum { TWIN_EDGE, TWIN_DET = 3, TWIN_T, TWIN_U, TWIN_V, TWIN_OUTPUTS };
struct twin_output {
    double x[TWIN_OUTPUTS][TWIN_LANES], e[TWIN_OUTPUTS][TWIN_LANES];
    double band[TWIN_LANES], t_running[TWIN_LANES];
};

struct twin_kernel {
    const char *name; /* "avx2", "avx512" */
    bool (*runs)(void);
    void (*evaluate)(enum twin_formula formula, const struct rounding *rounding,
                     const struct twin_input *in, struct twin_output *out);
};

#if defined(__x86_64__)
#define TWIN_VECTORS 2
extern const struct twin_kernel twin_avx2, twin_avx512;
#endif

#endif
