/* Builders of trees in stages, in the form of the tables. */
#ifndef STAGED_BUILDER_H
#define STAGED_BUILDER_H

#include "ref/staged/staged.h"

/* Least memory per triangle of staged_build and staged_write. */
#define STAGED_TRI_BYTES 200

/* As builder->build. */
enum status staged_builder(enum staged_kind kind, const struct scene *scene,
                           const struct build_options *options, struct bvh *out,
                           struct reason *reason) MUST_USE;

#endif
