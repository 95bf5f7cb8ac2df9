/* Versions of the engines and drivers that showed a finding. */
#ifndef FUZZ_VERSIONS_H
#define FUZZ_VERSIONS_H

#include "ref/engine.h"

/* Writes "raydiff VERSION" and a line "NAME: WHAT" for each engine that is not the program's own
 * code, unless an earlier one has the same WHAT; as many lines as fit, '\n' between them, as in
 * struct finding_file. */
void fuzz_versions(const struct engine *const *engine, size_t count,
                   const struct engine_options *options, char *text, size_t text_bytes);

#endif
