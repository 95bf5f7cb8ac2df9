/* Names of modes of Embree as tests read them. Include it after cmocka. */
#ifndef TESTS_EMBREE_MODE_NAMES_H
#define TESTS_EMBREE_MODE_NAMES_H

#include "ref/engines/embree_named.h"

/* Rays a call, as a mode has them; 0: one. */
static const unsigned widths[] = {0, 4, 8, 16};

/* The mode of a name, which must be one. */
static struct embree_mode parsed(const char *name)
{
    struct embree_mode mode;
    struct reason reason = {""};
    if (embree_named_parse(name, &mode, &reason))
        fail_msg("%s", reason.text);
    return mode;
}

static void expect_equal(const struct embree_mode *a, const struct embree_mode *b)
{
    assert_int_equal(a->isa, b->isa);
    assert_int_equal(a->packet, b->packet);
    assert_int_equal(a->quality, b->quality);
    assert_int_equal(a->robust, b->robust);
    assert_int_equal(a->compact, b->compact);
}

#endif
