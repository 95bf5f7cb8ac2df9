/* Shared by framer.c and framer_slab.c; private to them. */
#ifndef FRAMER_PRIVATE_H
#define FRAMER_PRIVATE_H

#include "gpu/frame/frame_dispatch.h"
#include "gpu/frame/framer.h"
#include "gpu/shaders/pipelines.h"

struct framer {
    struct vk *vk;
    bool brute, prepared;
    struct frame_job job; /* what it borrows is valid until the next prepare */
    struct frame_dispatch dispatch;
    struct pipelines pipelines;
    struct vk_buffer *buffer[FRAME_BINDINGS];
    uint32_t batch;  /* tiles of a submission */
    uint32_t serial; /* serial number of the last slab */
};

/* Rows of the picture that are drawn at once. */
struct slab {
    uint32_t first_row, rows;
};

/* Draws a slab in as many submissions as needed. `dispatch` has everything except the position in
 * the picture. Errors: as vk_dispatch and vk_pipeline_make. */
enum status framer_slab(struct framer *framer, const struct frame_dispatch *dispatch,
                        const struct slab *slab, struct trace_report *report,
                        struct reason *reason) MUST_USE;

#endif
