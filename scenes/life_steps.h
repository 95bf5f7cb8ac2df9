/* Steps of a life cycle: how the vertices of a scene move, or the instances of a world
 * (scenes/world_steps.h), and what is done with its tree then. */
#ifndef LIFE_STEPS_H
#define LIFE_STEPS_H

#include "ref/packed/life.h"
#include "ref/scene/scene.h"

/* All give finite coordinates. A vertex whose moved coordinate would not be finite keeps it. */
enum life_motion {
    MOTION_STILL,  /* nothing moves */
    MOTION_JITTER, /* scene_move, by 2^-(seed mod 12) extents */
    MOTION_ONE,    /* the same of one vertex alone, by up to one extent */
    MOTION_MIRROR, /* one coordinate of all vertices is negated: twice is nothing */
    MOTION_SWAP,   /* two triangles change places: twice is nothing, unless they share a vertex */
    MOTION_FAR,    /* all vertices by 2^(1 + seed mod 24) extents along an axis */
    MOTION_POINT,  /* all vertices to where one of them is */
    MOTION_ZERO,   /* some coordinates, or all, become 0 or -0 */
    MOTION_SUBNORMAL, /* some coordinates, or all, become subnormal */
    MOTIONS_OF_VERTICES,
    /* Of instances, in worlds alone. */
    MOTION_DRIFT = MOTIONS_OF_VERTICES, /* each is moved, by up to 2^-(seed mod 12) extents */
    MOTION_TURN,                        /* each is turned about its own origin */
    MOTION_REFLECT,  /* one coordinate of all that is placed is negated: twice is nothing */
    MOTION_SCALE,    /* each by a power of two from 1/8 to 8 */
    MOTION_EXCHANGE, /* two of them exchange all but their numbers: twice is nothing */
    MOTION_GATHER,   /* all to the origin of one of them */
    MOTION_AWAY,     /* all by 2^(1 + seed mod 24) extents along an axis */
    MOTION_MASKS,    /* the bits of each mask go around, by 1 to 7 places */
    MOTION_HIDE,     /* half of them: mask 0, or 255 where it is 0 already */
    MOTIONS
};

/* Whether a motion needs instances. */
static inline bool motion_is_of_worlds(enum life_motion motion)
{
    return motion >= MOTIONS_OF_VERTICES;
}

struct step {
    enum life_act act;
    enum life_motion motion;
    uint64_t seed; /* of the motion */
};

#define STEP_TEXT_MOST  48u                                /* bytes, the end included */
#define STEPS_TEXT_MOST (LIFE_STEPS_MOST * STEP_TEXT_MOST) /* likewise */

/* "jitter". */
const char *motion_name(enum life_motion motion);

/* Moves the vertices; a motion of instances moves none. The result depends on the scene, the motion
 * and the seed alone, and is the same on every machine. Normals are not changed. */
void motion_apply(const struct step *step, struct scene *scene);

/* Writes "refit:jitter:3"; the seed is left out if it is 0, and then a motion that is still. */
void step_write(const struct step *step, char text[STEP_TEXT_MOST]);

/* The same of several, with commas between. */
void steps_write(const struct step *step, uint32_t count, char text[STEPS_TEXT_MOST]);

/* Reads such a text. Errors: STATUS_INPUT which word is none, or there are more than
 * LIFE_STEPS_MOST steps. */
enum status steps_parse(const char *text, struct step out[LIFE_STEPS_MOST], uint32_t *count,
                        struct reason *reason) MUST_USE;

/* Whether steps can be those of a scene. Errors: STATUS_INPUT the motion of instances. */
enum status steps_of_scene(const struct step *step, uint32_t count, struct reason *reason) MUST_USE;

/* Moves `count` scenes on from the first: scene[i + 1] is scene[i] after step[i]. The vertices of
 * each are its own, everything else is the first's (steps_free). Errors: STATUS_MEMORY; then there
 * is nothing to free. */
enum status steps_scenes(const struct scene *first, const struct step *step, uint32_t count,
                         struct scene out[LIFE_STEPS_MOST + 1], struct reason *reason) MUST_USE;

/* The same backwards, for steps that end in `last`: scene[i] is scene[i + 1] after the motion of
 * step[i], and scene[count] is `last`. */
enum status steps_scenes_back(const struct scene *last, const struct step *step, uint32_t count,
                              struct scene out[LIFE_STEPS_MOST + 1],
                              struct reason *reason) MUST_USE;

/* Frees what these made. */
void steps_free(struct scene scene[LIFE_STEPS_MOST + 1], uint32_t count);

#endif
