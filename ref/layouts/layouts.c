#include "ref/layout.h"

#include "counts.h"

#include <string.h>

extern const struct layout layout_f32, layout_rf16;
extern const struct layout layout_rtrs_direct, layout_rtrs_rf, layout_rtrs_rf_paper;
extern const struct layout layout_cwbvh80;

#define CORE &layout_f32, &layout_rf16, &layout_rtrs_direct, &layout_rtrs_rf, &layout_rtrs_rf_paper

/* Members of families beside the first: a family is one file. */
#define MORE_OF_FAMILIES 0

const struct layout *const layouts[] = {CORE, NULL};
static const struct layout *const all[] = {CORE, &layout_cwbvh80, NULL};
const struct layout *const *const layouts_all = all;
_Static_assert(ARRAY_COUNT(all) - 1 - MORE_OF_FAMILIES == LAYOUT_FILES,
               "a ref/layouts/layout_*.c has no entry");
_Static_assert(TRACE_SHADERS == LAYOUT_FILES,
               "a layout has no shaders/trace_*.comp, or one too many");

const struct layout *layout_find(const char *name)
{
    for (size_t i = 0; layouts_all[i]; i++)
        if (strcmp(layouts_all[i]->name, name) == 0)
            return layouts_all[i];
    return NULL;
}
