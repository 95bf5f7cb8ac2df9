/* A finding as a program that needs no raydiff: C, or an Amber script, that makes the same bytes,
 * runs the same driver, and checks the answer. The right answers come from the exact truth and the
 * proven bounds of the formula, as everywhere; the engine's own answer is not used. */
#ifndef FUZZ_EXPORT_H
#define FUZZ_EXPORT_H

#include "fuzz/findings/finding_file.h"
#include "ref/engine.h"

#include <stdio.h>

enum export_form {
    EXPORT_C,     /* a program; exit code 0: right, 1: the bug shows, 2: it cannot run */
    EXPORT_AMBER, /* a script of github.com/google/amber; Vulkan's compute shaders only */
    EXPORT_TEXT,  /* scene or world, and rays, as in ref/outside/pipe_text.h; right answers in
                     comments */
    EXPORT_FORMS
};

/* Their names, of which the last is NULL. */
extern const char *const export_form_names[EXPORT_FORMS + 1];

#define EXPORT_ALL_RAYS UINT32_MAX

struct export_options {
    enum export_form form;
    const struct engine *engine; /* NULL: the signature's; of a clean file vulkan */
    const struct layout *layout; /* NULL: the signature's, else f32 */
    uint32_t ray;                /* this one only; EXPORT_ALL_RAYS: all of the file */
    struct engine_options engines;
    const char *name; /* how the written file is called in its own comment, or NULL */
};

/* Remarks for the user. */
struct export_said {
    char text[400]; /* lines with '\n' between them; empty: nothing */
};

/* Writes the finding. The engine traces the rays once, if it can run here and is not known to crash
 * or hang: its answer is shown in the comment, and the tolerance is that of its driver's measured
 * arithmetic. Otherwise the tolerance is the specification's. The caller checks `to` for write
 * errors.
 * Errors: STATUS_INPUT a trial of a world in another form than text; there is nothing to export,
 * with what to do instead; the ray is not there; STATUS_LIMIT too large, or the layout or the
 * engine cannot hold the trial; STATUS_UNSUPPORTED; STATUS_MEMORY; STATUS_INTERNAL. */
enum status export_write(const struct finding_file *file, const struct export_options *options,
                         FILE *to, struct export_said *said, struct reason *reason) MUST_USE;

#endif
