/* Any tracer can join: an engine "pipe:COMMAND" is a child process that reads requests and writes
 * answers. The protocol, binary, 32-bit little-endian words, version 1:
 *
 *   request  "RDRQ", version, query, vertices, triangles, rays, same, 0
 *            then, unless `same` is 1 (the scene is that of the request before), per vertex x y z
 *            and per triangle three vertex numbers from 0; then per ray ox oy oz tmin dx dy dz tmax
 *   answer   "RDRA", version, refused, count, formula, rounding, flags, 0
 *            then per ray t u v triangle; a miss is triangle 0xFFFFFFFF, whatever t u v
 *            refused 1: count bytes of text instead, why this scene is rejected
 *
 * The peer answers requests until its input ends, each when it has read all of it. Query 0 asks for
 * the nearest hit, 1 for any; tmin <= t <= tmax; t counts in multiples of the direction; u weighs
 * the triangle's second vertex, v its third. A request may have no rays, or no triangles; the first
 * has neither; its reply describes the peer:
 *
 *   formula   0 unknown, 1 mt, 2 woop, 3 Embree's default, 4 Embree's robust, 5 pluecker,
 *             6 baldwin_webber (ref/twin/twin.h)
 *   rounding  0 IEEE, 1 IEEE with subnormals flushed, 2 Vulkan, 3 Vulkan with RTE, 4 Embree
 *   flags     1: tmin < t < tmax; 2: watertight; 4: any-hits do not name their triangle
 *
 * All 0 is always right: the judge then computes by how much vertices must move to make an
 * answer right (ref/judge/judge.h). README, "Any tracer can join", has the rules for the process. */
#ifndef FUZZ_PIPE_H
#define FUZZ_PIPE_H

#include "ref/engine.h"

#define PIPE_PREFIX    "pipe:"
#define PIPE_NAME_MOST 160 /* of "pipe:COMMAND" with its terminator */

#define PIPE_VERSION 1u
#define PIPE_WORDS   8u /* of each head */

struct pipe_request {
    char magic[4];
    uint32_t version, query, vertices, triangles, rays, same, zero;
};

struct pipe_answer {
    char magic[4];
    uint32_t version, refused, count, formula, rounding, flags, zero;
};

#define PIPE_REFUSED_MOST    256u /* bytes of its text */
#define PIPE_FLAG_OPEN       1u
#define PIPE_FLAG_WATERTIGHT 2u
#define PIPE_FLAG_UNNAMED    4u

/* Turns what a peer says of itself into a model. Errors: STATUS_INPUT an unknown number. */
enum status pipe_model(uint32_t formula, uint32_t rounding, uint32_t flags, struct model *out,
                       struct reason *reason) MUST_USE;

/* The words for it, as the text form has them: "mt", "ieee"; NULL past the end. */
const char *pipe_formula_name(uint32_t formula);
const char *pipe_rounding_name(uint32_t rounding);

/* Gives the engine of the name "pipe:COMMAND", from the table of engines or new in it. The command
 * is not run before the engine is opened. Errors: STATUS_INPUT no such name, or too long;
 * STATUS_LIMIT as engine_add. */
enum status pipe_engine(const char *name, const struct engine **out,
                        struct reason *reason) MUST_USE;

#endif
