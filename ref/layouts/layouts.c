#include "ref/layouts/grid.h"

#include "ref/layout.h"

#include "counts.h"

#include <string.h>

extern const struct layout layout_f32, layout_rf16;
extern const struct layout layout_rtrs_direct, layout_rtrs_rf, layout_rtrs_rf_paper;
extern const struct layout layout_cwbvh80, layout_half4, layout_hpb64, layout_obb8;
extern const struct layout layouts_amd64[5], layouts_tiny8[3], layouts_gfx12[2];
#define DECLARE(width, format, FORMAT, frame, FRAME)                                               \
    extern const struct layout GRID_SYMBOL(width, format, frame);
GRID_MEMBERS(DECLARE)

#define CORE &layout_f32, &layout_rf16, &layout_rtrs_direct, &layout_rtrs_rf, &layout_rtrs_rf_paper

#define AMD64                                                                                      \
    &layouts_amd64[0], &layouts_amd64[1], &layouts_amd64[2], &layouts_amd64[3], &layouts_amd64[4]
#define TINY8 &layouts_tiny8[0], &layouts_tiny8[1], &layouts_tiny8[2]
#define GFX12 &layouts_gfx12[0], &layouts_gfx12[1]

/* All built-in layouts. */
#define POINT(width, format, FORMAT, frame, FRAME) &GRID_SYMBOL(width, format, frame),

#define OWN                                                                                        \
    CORE, &layout_cwbvh80, &layout_half4, AMD64, TINY8, GFX12, &layout_hpb64, &layout_obb8,        \
        GRID_MEMBERS(POINT)

/* Layouts without a file layout_NAME of their own: the grid family, with one shader per width, and
 * the members of other families besides the first. */
#define ONE(width, format, FORMAT, frame, FRAME) +1
#define GRID_COUNT                               (0 GRID_MEMBERS(ONE))
#define GRID_SHADERS                             3
#define MORE_OF_FAMILIES                         (4 + 2 + 1)

const struct layout *const layouts[] = {CORE, NULL};
const struct layout *const layouts_auto[] = {&layout_rf16, &layout_cwbvh80, &layout_f32, NULL};
#define OWN_COUNT ARRAY_COUNT(((const struct layout *const[]){OWN}))
_Static_assert(OWN_COUNT - MORE_OF_FAMILIES - GRID_COUNT == LAYOUT_FILES,
               "a ref/layouts/layout_*.c has no entry");
_Static_assert(LAYOUT_SHADERS == LAYOUT_FILES + GRID_SHADERS,
               "a layout has no shaders/layouts/layout_*.glsl, or one too many");

static const struct layout *all[OWN_COUNT + LAYOUTS_ADDED_MOST + 1] = {OWN};
static size_t added;

const struct layout *const *const layouts_all = all;

enum status layout_add(const struct layout *layout, struct reason *reason)
{
    if (layout_find(layout->name))
        return fail(reason, STATUS_INPUT, "there is a layout '%s' already", layout->name);
    if (added == LAYOUTS_ADDED_MOST)
        return fail(reason, STATUS_LIMIT, "%s: more than %d layouts beside the program's own",
                    layout->name, LAYOUTS_ADDED_MOST);
    all[OWN_COUNT + added++] = layout;
    return STATUS_OK;
}

const struct layout *layout_find(const char *name)
{
    for (size_t i = 0; layouts_all[i]; i++)
        if (strcmp(layouts_all[i]->name, name) == 0)
            return layouts_all[i];
    return NULL;
}
