/* Checks of one part's answers by one member. */
#ifndef HARD_CHECK_H
#define HARD_CHECK_H

#include "tests/hard/cache.h"

/* One member playing one part. */
struct hard_play {
    struct hard_stage *stage;
    const struct hard_member *member;
    size_t index; /* of the part */
    const struct hard_part *part;
    struct hard_cache *cache;
    void *self; /* the engine, prepared */
    struct job job;
    struct model model;
    struct trace_report report;
    struct hard_result *result;
    struct reason *reason;
};

/* Notes that a property is broken: of ray `i`, or of the whole part (SIZE_MAX). */
void play_broken(struct hard_play *play, enum hard_property property, size_t i);

/* Notes that a builder, layout or engine refuses the part. It must give a reason. */
void play_refused(struct hard_play *play, const struct reason *why);

/* Traces all rays into `out`, which has room for one more: nothing may be written there.
 * Errors: those of the engine, or STATUS_DEVICE something was. */
enum status play_trace(struct hard_play *play, void *self, struct hit *out) MUST_USE;

/* Judges cache->answer and checks every property of the case. Errors: STATUS_MEMORY; those of
 * engines that trace again. */
enum status play_check(struct hard_play *play) MUST_USE;

#endif
