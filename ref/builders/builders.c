#include "ref/bvh.h"

#include "counts.h"

#include <string.h>

extern const struct builder build_median, build_rtrs, build_sah_binned, build_lbvh;

#define CORE &build_median, &build_rtrs

const struct builder *const builders[] = {CORE, NULL};

const struct builder *const builders_all[] = {
    CORE,
    &build_sah_binned,
    &build_lbvh,
    NULL,
};
_Static_assert(ARRAY_COUNT(builders_all) - 1 == BUILDER_FILES,
               "a ref/builders/build_*.c has no entry");

const struct builder *builder_find(const char *name)
{
    for (size_t i = 0; builders_all[i]; i++)
        if (strcmp(builders_all[i]->name, name) == 0)
            return builders_all[i];
    return NULL;
}
