/* Why the answers of an engine to rays in a world are WRONG: the defect
 * (ref/explain/world_defect.h) whose tracer gives them, and gives the engine's other answers, too.
 * */
#ifndef WORLD_WHY_H
#define WORLD_WHY_H

#include "ref/explain/world_defect.h"
#include "ref/judge/judge_world.h"
#include "ref/two_level/world_check.h"

/* Answers and their judgements; all borrowed. */
struct world_evidence {
    const struct world *world;
    const struct tri_test *tri; /* near to what the engine runs */
    enum query query;           /* closest or any */
    const struct ray *ray;
    const struct ray_mode *mode;
    const struct hit *hit;
    const uint32_t *tag;
    const struct judgement *judgement;
    size_t count;
    /* Of an engine with trees of ours: what world_pack_check finds in them. NULL: not known. */
    const struct world_faults *faults;
};

/* So many WRONG answers, and as many others, are compared, evenly spread. */
#define WORLD_WHY_MOST 256u

/* Answers that the tracer with a defect gives as well, of those compared. */
struct world_attempt {
    uint32_t told_wrong, told_other;
};

struct world_why {
    size_t wrong; /* of all answers */
    size_t kind[WRONG_COUNT];
    uint32_t wrong_compared, other_compared;
    struct world_attempt attempt[WORLD_DEFECT_COUNT];
    enum world_cause cause;
    enum world_defect defect; /* WORLD_DEFECT_NONE: the cause is no defect's */
    size_t first;             /* index of the first WRONG answer; count if there is none */
    uint32_t at_the_rim; /* of those compared: a hit is lost that only passes the outer 2^-12 of
                                 its instance's box */
};

/* Trees that are known to be wrong are the cause. Else a defect is if its tracer gives at least 9
 * of 10 WRONG answers and 9 of 10 others; of several the one that gives most. Else a record that is
 * known to be wrong is: what its member is for. Else the boxes of instances are, if 9 of 10 WRONG
 * answers lose hits at their rim. Answers are the same if the
 * triangle and the tag are and t is within 2^-10 of itself; of any-hit queries, if both are hits or
 * misses. Errors: those of world_look_make, world_boxes_make. */
enum status world_why(const struct world_evidence *answers, struct world_why *out,
                      struct reason *reason) MUST_USE;

#endif
