/* What all blocks of ref/fast/tiny_block.h share. */
#ifndef TINY_FORM_H
#define TINY_FORM_H

#include "ref/scene/quantise.h"

struct tiny_form {
    struct grid grid;   /* of the scene's vertices: the coarsest */
    uint32_t prim_bits; /* of a triangle's number */
};

#endif
