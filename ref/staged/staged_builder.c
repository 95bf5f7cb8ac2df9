#include "ref/staged/staged_builder.h"

#include "ref/build/grow.h"

enum status staged_builder(enum staged_kind kind, const struct scene *scene,
                           const struct build_options *options, struct bvh *out,
                           struct reason *reason)
{
    struct staged staged;
    *out = (struct bvh){0};
    enum status status = build_check(scene, options, reason);
    if (!status)
        status = staged_build(kind, scene, &staged, NULL, reason);
    if (status)
        return status;
    status = staged_write(&staged, options->leaf, out, reason);
    staged_free(&staged);
    return status;
}
