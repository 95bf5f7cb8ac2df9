#define _DEFAULT_SOURCE /* madvise */
#include "ref/fast/fast_frame.h"

#include "ref/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#if defined(__linux__)
#include <sys/mman.h>
#endif

#define HUGE_PAGE  ((size_t)1 << 21)
#define HUGE_LEAST ((size_t)1 << 20) /* smaller arrays use small pages */

void frame_set(struct fast_tree *tree, const struct box *bounds)
{
    float most = 0;
    tree->bounds = *bounds;
    for (int k = 0; k < 3; k++) {
        double extent = (double)bounds->hi[k] - (double)bounds->lo[k];
        int exponent;
        double part = frexp(extent / FRAME_MOST, &exponent);
        float step = (float)ldexp(floor(part * 128) + 1, exponent - 7);
        tree->lo[k] = bounds->lo[k];
        tree->step[k] = extent == 0 ? 0 : step < FLT_MIN ? FLT_MIN : step;
        tree->extent[k] = tree->step[k] * (FRAME_MOST + 1);
        most = tree->extent[k] > most ? tree->extent[k] : most;
    }
    /* Rays within this distance miss all absent children (docs/numerics.md, "Boxes", fast). */
    tree->reach = most > 0x1p-60f ? most * 0x1p16f : 0;
}

uint16_t frame_down(const struct fast_tree *tree, int k, float b)
{
    double lo = (double)tree->lo[k], step = (double)tree->step[k];
    if (step == 0)
        return 0;
    double code = floor(((double)b - lo) / step);
    code = code < 0 ? 0 : code > FRAME_MOST ? FRAME_MOST : code;
    while (code > 0 && lo + code * step > (double)b)
        code--;
    return (uint16_t)code;
}

uint16_t frame_up(const struct fast_tree *tree, int k, float b)
{
    double lo = (double)tree->lo[k], step = (double)tree->step[k];
    if (step == 0)
        return 0;
    double code = ceil(((double)b - lo) / step);
    code = code < 0 ? 0 : code > FRAME_MOST ? FRAME_MOST : code;
    while (code < FRAME_MOST && lo + code * step < (double)b)
        code++;
    return (uint16_t)code;
}

void *frame_pages(uint64_t bytes)
{
    size_t unit = bytes < HUGE_LEAST ? FRAME_LINE : HUGE_PAGE;
    if (bytes > SIZE_MAX - unit)
        return NULL;
    size_t whole = ((size_t)bytes + unit - 1) / unit * unit;
    void *made = memory_fits(whole) ? aligned_alloc(unit, whole) : NULL;
    if (!made)
        return NULL;
#if defined(__linux__)
    if (unit == HUGE_PAGE)
        (void)madvise(made, whole, MADV_HUGEPAGE); /* on failure pages are small */
#endif
    memset(made, 0, whole);
    return made;
}
