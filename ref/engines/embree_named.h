/* Modes of Embree as engines: "embree:ISA:FORM:QUALITY:robust:compact:UPDATE", as in
 * "embree:avx2:8" or "embree:sse2:high:robust". Words in any order, each of them optional:
 *   sse2, sse42 (or sse4.2), avx, avx2, avx512   the ISA of the device; else Embree chooses
 *   1, 4, 8, 16                                  rtcIntersect1 and rtcOccluded1, or packets
 *   low, medium, high                            the quality of the build; else medium
 *   robust, compact                              flags of the scene
 *   dynamic, refit                               its flag for scenes that change; and meshes that
 *                                                are refitted when they do
 * An engine is called by its words in that order without those that change nothing. "embree:1" is
 * embree, "embree:robust" is embree_robust. Modes of single rays trace worlds. */
#ifndef EMBREE_NAMED_H
#define EMBREE_NAMED_H

#include "ref/engines/embree_device.h"

#define EMBREE_PREFIX    "embree:"
#define EMBREE_NAME_MOST 48

/* True for names that begin so. */
bool embree_is_named(const char *name);

/* Reads such a name. Errors: STATUS_INPUT a word that is none of these, or two of a kind. */
enum status embree_named_parse(const char *name, struct embree_mode *out,
                               struct reason *reason) MUST_USE;

/* The name of the engine in the table with the same formula, "embree" or "embree_robust"; NULL if
 * that is no name of a mode. */
const char *embree_named_plain(const char *name);

/* Writes how the engine of a mode is called. */
void embree_named_write(const struct embree_mode *mode, char name[EMBREE_NAME_MOST]);

/* Finds the engine of that name in the table of engines, or adds it. Errors: those of
 * embree_named_parse and embree_isa_check; STATUS_LIMIT more than ENGINES_EMBREE_MOST. */
enum status embree_named(const char *name, const struct engine **out,
                         struct reason *reason) MUST_USE;

/* Adds every mode that names its ISA, can run here and has a name of that pattern (fnmatch), such
 * as "embree:avx2*". Errors: STATUS_UNSUPPORTED no mode of that pattern can run here; STATUS_INPUT
 * there is no mode of that pattern; STATUS_LIMIT. */
enum status embree_named_all(const char *pattern, struct reason *reason) MUST_USE;

/* The mode of an engine that was added here, or NULL. */
const struct embree_mode *embree_mode_of(const struct engine *engine);

#endif
