/* Ways of using Embree that are measured beside others but no engines of the table: what they
 * answer is Embree's default mode's. */
#ifndef EMBREE_MODES_H
#define EMBREE_MODES_H

#include "ref/engine.h"

/* NULL-terminated: embree_16, rays in packets of 16 as they come (rtcIntersect16, rtcOccluded16);
 * embree_high, built in quality RTC_BUILD_QUALITY_HIGH. Both for closest and any. */
extern const struct engine *const embree_modes[];

#endif
