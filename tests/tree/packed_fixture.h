/* What test_packed.c and test_packed_make.c share; includes cmocka.h. */
#ifndef PACKED_FIXTURE_H
#define PACKED_FIXTURE_H

#include "ref/layout.h"
#include "ref/base/rng.h"
#include "ref/packed/packed_check.h"
#include "tests/support/tree_fixture.h"
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

/* 16 triangles, 8 leaves of two, balanced: 15 nodes, 23 records where leaves take two. Nodes 0
 * (1, 8), 1 (2, 5), 2 (3, 4), ... leaves 3, 4, 6, 7, 10, 11, 13, 14. */
struct packed_fixture {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct packed_faults faults;
    struct reason reason;
};

#endif
