/* The ISAs of Embree in words, for its own files and their tests. */
#ifndef EMBREE_ISA_H
#define EMBREE_ISA_H

#include "ref/engines/embree_device.h"

extern const char *const embree_isa_words[EMBREE_ISAS];   /* "", "sse2", "sse42", ... */
extern const char *const embree_isa_configs[EMBREE_ISAS]; /* ",isa=sse2", of rtcNewDevice */

/* The ISA that runs, of what a verbose device says: the best of both "Targets", those that the
 * device may use and those that Embree was compiled with. EMBREE_ISA_OWN: it does not say. */
enum embree_isa embree_isa_said(const char *said);

#endif
