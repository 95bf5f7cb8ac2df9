/* Modes of Embree that are only measured. They are not in the table of engines, as their hits are
 * those of the default mode. */
#ifndef EMBREE_MODES_H
#define EMBREE_MODES_H

#include "ref/engine.h"

/* NULL-terminated. embree_16: rays in packets of 16, in the order given (rtcIntersect16,
 * rtcOccluded16); embree_high: built with RTC_BUILD_QUALITY_HIGH. Both for closest and any. */
extern const struct engine *const embree_modes[];

#endif
