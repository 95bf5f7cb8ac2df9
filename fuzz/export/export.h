/* A finding for somebody without raydiff: a C program, or an Amber script, that makes the same
 * bytes, asks the same driver the same question, and says whether the answer is right. What is
 * right comes from the exact truth and the proven bounds of the formula, as everywhere; nothing of
 * the engine's own answer enters. */
#ifndef FUZZ_EXPORT_H
#define FUZZ_EXPORT_H

#include "fuzz/findings/finding_file.h"
#include "ref/engine.h"

#include <stdio.h>

enum export_form {
    EXPORT_C,     /* a program; exit code 0: right, 1: the bug shows, 2: it cannot run */
    EXPORT_AMBER, /* a script of github.com/google/amber; Vulkan's compute shaders only */
    EXPORT_TEXT,  /* scene and rays as in ref/outside/pipe_text.h, what is right in comments */
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

/* What the writer learned, for the user. */
struct export_said {
    char text[400]; /* lines with '\n' between them; empty: nothing */
};

/* Writes the finding. The engine is asked once, if it can run here and is not known to crash or
 * hang, so that its answer can stand in the comment, and the tolerance fits its driver's measured
 * arithmetic; where it cannot run, the specification's holds. Whether `to` took all of it is for
 * the caller to ask.
 * Errors: STATUS_INPUT there is nothing to export, with what to do instead; the ray is not there;
 * STATUS_LIMIT too large, or the layout or the engine cannot hold the trial; STATUS_UNSUPPORTED;
 * STATUS_MEMORY; STATUS_INTERNAL. */
enum status export_write(const struct finding_file *file, const struct export_options *options,
                         FILE *to, struct export_said *said, struct reason *reason) MUST_USE;

#endif
