#include "ref/bvh.h"

#include "counts.h"

#include <string.h>

extern const struct builder build_median, build_rtrs;

const struct builder *const builders[] = {
    &build_median,
    &build_rtrs,
    NULL,
};
_Static_assert(ARRAY_COUNT(builders) - 1 == BUILDER_FILES, "a ref/builders/build_*.c has no entry");

const struct builder *builder_find(const char *name)
{
    for (size_t i = 0; builders[i]; i++)
        if (strcmp(builders[i]->name, name) == 0)
            return builders[i];
    return NULL;
}
