/* The text of a shader that is compiled at run time: a plugin layout's own file and raydiff's
 * shaders, which it includes. */
#ifndef GLSL_TEXT_H
#define GLSL_TEXT_H

#include "ref/base/base.h"

/* raydiff's files that a shader may include, made at build time. The last one has the name NULL. */
struct glsl_source {
    const char *name; /* "walk.glsl", "ref/abi.h": as in #include */
    const char *text;
};
extern const struct glsl_source glsl_sources[];

#define GLSL_FILES_MOST 64
#define GLSL_NAME_MOST  200
#define GLSL_TEXT_MOST  ((size_t)8 << 20)

enum glsl_use {
    GLSL_TRACE,
    GLSL_RENDER,
    GLSL_DECODE, /* writes what it decodes, see gpu/trace/decode.h */
    GLSL_USES
};

/* Owns `text`; see glsl_text_free. */
struct glsl_text {
    char *text; /* ends with 0; includes resolved, lines numbered by "#line LINE FILE" */
    size_t size, capacity;
    char file[GLSL_FILES_MOST][GLSL_NAME_MOST]; /* names of the files, indexed by FILE */
    size_t files;
};

/* Reads a whole file, with a 0 after it. The caller frees *bytes. */
typedef enum status glsl_read_fn(const char *path, char **bytes, size_t *size,
                                 struct reason *reason);

/* Makes the text of the shader that traces, renders or decodes with the layout in the file `path`.
 * Includes are raydiff's files, or else files in the folder of `path`. Errors: STATUS_INPUT
 * "FILE:LINE: rule": an include that is not found, files that include each other, over
 * GLSL_FILES_MOST or GLSL_TEXT_MOST; as `read`; STATUS_MEMORY. On error *out is zero. */
enum status glsl_text_make(const char *path, enum glsl_use use, glsl_read_fn *read,
                           struct glsl_text *out, struct reason *reason) MUST_USE;

/* Writes the first error in a compiler's log, "ERROR: FILE:LINE: text", to `reason` as "NAME:LINE:
 * text". Returns STATUS_INPUT. */
enum status glsl_text_blame(const struct glsl_text *text, const char *log, struct reason *reason);

void glsl_text_free(struct glsl_text *text);

#endif
