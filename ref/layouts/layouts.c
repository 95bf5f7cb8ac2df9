#include "ref/layout.h"

#include "counts.h"

#include <string.h>

extern const struct layout layout_f32, layout_rf16;
extern const struct layout layout_rtrs_direct, layout_rtrs_rf, layout_rtrs_rf_paper;

const struct layout *const layouts[] = {
    &layout_f32, &layout_rf16, &layout_rtrs_direct, &layout_rtrs_rf, &layout_rtrs_rf_paper, NULL,
};
const struct layout *const *const layouts_all = layouts;
_Static_assert(ARRAY_COUNT(layouts) - 1 == LAYOUT_FILES, "a ref/layouts/layout_*.c has no entry");
_Static_assert(TRACE_SHADERS == LAYOUT_FILES,
               "a layout has no shaders/trace_*.comp, or one too many");

const struct layout *layout_find(const char *name)
{
    for (size_t i = 0; layouts_all[i]; i++)
        if (strcmp(layouts_all[i]->name, name) == 0)
            return layouts_all[i];
    return NULL;
}
