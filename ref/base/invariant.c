#include "ref/base/invariant.h"

#include <stdio.h>
#include <stdlib.h>

void invariant_broken(const char *truth, const char *file, int line)
{
    fprintf(stderr, "raydiff: %s:%d: '%s' does not hold: a bug of raydiff\n", file, line, truth);
    abort();
}
