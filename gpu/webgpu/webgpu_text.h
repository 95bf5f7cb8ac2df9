/* The text of the WGSL shaders (shaders/wgsl/), put together for a job. */
#ifndef WEBGPU_TEXT_H
#define WEBGPU_TEXT_H

#include "ref/engine.h"

/* The files of shaders/wgsl/, core.js and peer.js, made at build time. The last one has the name
 * NULL. */
struct wgsl_source {
    const char *name; /* "walk.wgsl" */
    const char *text;
};
extern const struct wgsl_source wgsl_sources[];

/* Returns the text of that file, or NULL. */
const char *wgsl_find(const char *name);

/* True if there is WGSL for the layout. */
bool webgpu_takes(const struct layout *layout);

/* Returns the text of the shader that traces the job, which has a packed tree. The caller frees it;
 * NULL: no memory. Errors: STATUS_UNSUPPORTED the layout or the storage has no WGSL, or the query
 * lists; STATUS_LIMIT the tree needs a deeper stack than there is; STATUS_MEMORY. */
enum status webgpu_text(const struct job *job, char **out, struct reason *reason) MUST_USE;

/* The same for the probe of operators. */
enum status webgpu_probe_text(char **out, struct reason *reason) MUST_USE;

#endif
