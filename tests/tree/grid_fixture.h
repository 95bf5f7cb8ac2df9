/* What test_grid.c and test_grid_members.c share; includes cmocka.h. */
#ifndef GRID_FIXTURE_H
#define GRID_FIXTURE_H

#include "ref/layouts/grid.h"
#include "ref/base/rng.h"
#include "ref/trace/trace.h"
#include "ref/packed/packed_check.h"
#include "tests/support/tree_fixture.h"
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <string.h>

static bool is_subnormal(double x)
{
    return x != 0 && fabs(x) < (double)FLT_MIN;
}

#endif
