#define _POSIX_C_SOURCE 200809L
#include "bench/cmd_bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct spread spread_of(double *value, size_t count)
{
    qsort(value, count, sizeof *value, by_value);
    double middle = count % 2 ? value[count / 2] : 0.5 * (value[count / 2 - 1] + value[count / 2]);
    return (struct spread){middle, value[0], value[count - 1]};
}

size_t bench_scenes(const struct bench *bench, const char *const *own,
                    const char *out[BENCH_SCENES])
{
    size_t count = 0;
    for (size_t i = 0; i < bench->scene_count; i++)
        out[count++] = bench->scene[i];
    for (size_t i = 0; bench->scene_count == 0 && own[i] && count < BENCH_SCENES; i++) {
        if (strchr(own[i], '/') && access(own[i], R_OK) != 0)
            printf("%s: left out, not fetched (make scenes)\n", own[i]);
        else
            out[count++] = own[i];
    }
    return count;
}
