/* Which engines and drivers a finding was seen with. */
#ifndef FUZZ_VERSIONS_H
#define FUZZ_VERSIONS_H

#include "ref/engine.h"

/* Writes "raydiff VERSION" and a line "NAME: WHAT" for each engine that is not the program's own
 * code alone, but not for one that says the same as one before it; as much as fits; lines are
 * parted by '\n', as in struct finding_file. */
void fuzz_versions(const struct engine *const *engine, size_t count,
                   const struct engine_options *options, char *text, size_t text_bytes);

#endif
