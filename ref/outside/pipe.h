/* Any tracer can join: an engine "pipe:COMMAND" is a child process that reads requests and writes
 * answers. The protocol, version 1, is binary, in 32-bit little-endian words:
 *
 *   request  "RDRQ", version, query, vertices, triangles, rays, same, 0
 *            then, unless `same` is 1 (the scene is that of the request before), per vertex x y z
 *            and per triangle three vertex numbers from 0; then per ray ox oy oz tmin dx dy dz tmax
 *   answer   "RDRA", version, refused, count, formula, rounding, flags, 0
 *            then per ray t u v triangle; a miss is triangle 0xFFFFFFFF, whatever t u v
 *            refused 1: count bytes of text instead, why this scene is rejected
 *
 * The peer answers requests until its input ends. It reads a whole request before it answers.
 * Query 0 is the nearest hit, 1 any hit, with tmin <= t <= tmax. t is in multiples of the
 * direction; u is the weight of the triangle's second vertex, v of its third. A request may have no
 * rays or no triangles. The first has neither, and its answer describes the peer's arithmetic:
 *
 *   formula   0 unknown, 1 mt, 2 woop, 3 Embree's default, 4 Embree's robust, 5 pluecker,
 *             6 baldwin_webber, 7 tri_accel (ref/twin/twin.h)
 *   rounding  0 IEEE, 1 IEEE with subnormals flushed, 2 Vulkan, 3 Vulkan with RTE, 4 Embree
 *   flags     1: tmin < t < tmax; 2: watertight; 4: any-hits do not name their triangle
 *
 *             8: it traces worlds, too; 16: it lists all hits; 32: it tells what it holds;
 *             64: it takes updates
 *
 * All 0 is always valid: the judge then computes how far vertices must move to make an answer right
 * (ref/judge/judge.h). docs/my-engine.md has the rules for the process.
 *
 * A peer with flag 16 is asked for lists: version 1, query 2, and the last word of a request with
 * rays is a capacity. Behind the head stands per ray how many triangles it meets in its range, then
 * of each ray in turn that many hits t u v triangle, unordered, but no more than the capacity.
 *
 * A peer with flag 32 puts six words behind the head of each answer but the first and refusals:
 * three numbers of bytes, each its lower half and its upper half, of its nodes, of triangles in the
 * form that it reads, and of all else that it holds; 0: not known.
 *
 * A peer with flag 64 may be sent `same` 2 in version 1: the scene of the request before, with
 * other vertices. Behind the head stand per vertex x y z, then the rays; numbers of vertices and
 * triangles are those of the scene, and so are the triangles. It may refit what it has, or build
 * anew.
 *
 * A peer with flag 8 is sent worlds (ref/world/world.h), in version 2, whose words have the same
 * first eight:
 *
 *   request  "RDRQ", 2, query, meshes, instances, rays, same, 0
 *            then, unless `same` is 1:
 *              filter: kind (0 all, 1 none, 2 triangles, 3 cells), seed, share, 0
 *              per mesh: vertices, triangles, geometries, 0; per vertex x y z; per triangle three
 *                vertex numbers of the mesh; per geometry triangles, opaque (0 or 1), 0, 0. The
 *                geometries take the triangles of their mesh in turn
 *              per instance: mesh (0xFFFFFFFF none), custom index, mask, flags, and M and T as 12
 *                floats, row by row
 *            then per ray ox oy oz tmin dx dy dz tmax, mask, flags
 *   answer   "RDRA", 2, refused, count, formula, rounding, flags, 0
 *            then per ray t u v instance geometry triangle side custom; or `count` bytes of text
 *
 * `geometry` counts in the mesh, `triangle` in the geometry; side is 1 where the front is seen, 0
 * where the back is; custom is the custom index of the instance, or 0xFFFFFFFF from a peer that
 * keeps none. A miss is instance 0xFFFFFFFF, and the four words after it are 0. Flags of instances
 * and rays have the values of ref/abi_world.h. How a filter decides stands in docs/formats.md. A
 * peer's transforms are its own, so that its formula is unknown here, whatever it declares. With
 * flag 4 the hit of an any-hit, or of a ray that ends at its first hit, is any instance number, and
 * the words after it are not read.
 *
 * Version 3 is between engine webgpu and the program that it starts (gpu/webgpu/peer.js):
 *
 *   request  "RDRQ", 3, query, words, 0, records, same, 0
 *            then, unless `same` is 1, so many words: a shader and the data that it reads
 *            then the records that it works on
 *   answer   "RDRA", 3, refused, count, 0, 2, 0, 0
 *            then a record for each; or `count` bytes of text */
#ifndef FUZZ_PIPE_H
#define FUZZ_PIPE_H

#include "ref/engine.h"

#define PIPE_PREFIX    "pipe:"
#define PIPE_NAME_MOST 160 /* of "pipe:COMMAND" with its terminator */

#define PIPE_VERSION        1u
#define PIPE_VERSION_WORLD  2u
#define PIPE_VERSION_SHADER 3u
#define PIPE_WORDS          8u /* of each header */

struct pipe_request {
    char magic[4];
    uint32_t version, query, vertices, triangles, rays, same, zero;
};

struct pipe_answer {
    char magic[4];
    uint32_t version, refused, count, formula, rounding, flags, zero;
};

/* Values of `same`, but 0. */
#define PIPE_SAME       1u
#define PIPE_SAME_MOVED 2u

#define PIPE_REFUSED_MOST    256u /* bytes of the text of a refusal */
#define PIPE_FLAG_OPEN       1u
#define PIPE_FLAG_WATERTIGHT 2u
#define PIPE_FLAG_UNNAMED    4u
/* What it can do; no part of its arithmetic. */
#define PIPE_FLAG_WORLDS 8u
#define PIPE_FLAG_LISTS  16u
#define PIPE_FLAG_MEMORY 32u
#define PIPE_FLAG_MOVES  64u
#define PIPE_FLAGS_CAN   (PIPE_FLAG_WORLDS | PIPE_FLAG_LISTS | PIPE_FLAG_MEMORY | PIPE_FLAG_MOVES)

#define PIPE_QUERY_LISTS 2u

struct pipe_memory {
    uint64_t tree, scene, other;
};

/* Converts a peer's description of its arithmetic to a model; PIPE_FLAGS_CAN are no part of it.
 * Errors: STATUS_INPUT an unknown number. */
enum status pipe_model(uint32_t formula, uint32_t rounding, uint32_t flags, struct model *out,
                       struct reason *reason) MUST_USE;

/* Names of formulas and roundings in the text form, such as "mt" and "ieee"; NULL past the end. */
const char *pipe_formula_name(uint32_t formula);
const char *pipe_rounding_name(uint32_t rounding);

/* Sets what a peer of unknown formula promises: vertices move by at most so many units
 * (ref/twin/model.h); 0 promises nothing. Errors: STATUS_INPUT negative, not finite, over
 * PIPE_DISPLACEMENT_MOST, or beside a known formula. A tracer that may move vertices as it likes is
 * never wrong: the most is what vertices in half precision move by, 2^-11 of their distance. */
#define PIPE_DISPLACEMENT_MOST 0x1p13f
enum status pipe_displacement(float units, struct model *model, struct reason *reason) MUST_USE;

/* Checks a list that a tracer from outside gave: hit[0 ..] with room for `capacity`. t, u and v may
 * be anything, and a triangle may be listed twice: the judge finds that. Errors: STATUS_INPUT
 * "names triangle 7 of 3", "has a miss ...", "has 70 hits on 3 triangles": over twice as many. */
enum status pipe_list_check(const struct hit *hit, uint32_t count, uint32_t capacity,
                            uint32_t triangles, struct reason *reason) MUST_USE;

/* Enters what a tracer from outside says that it holds. */
static inline void pipe_memory_report(uint64_t tree, uint64_t scene, uint64_t other,
                                      struct trace_report *report)
{
    report->node_bytes = tree;
    report->scene_bytes = scene;
    report->memory_bytes = tree + scene + other;
}

/* Whether a name is that of an engine in a process of its own: "pipe:COMMAND", or "FILE.so", a
 * shared object (ref/raydiff_engine.h) in a process that this program's file runs as
 * `PROGRAM PIPE_HOST_FLAG FILE.so MEGABYTES THREADS` (ref/guest/guest_host.h), with the same
 * protocol. There the last word of the first answer is its displacement, a float, and a refusal of
 * the first request is that of the tracer altogether. */
bool pipe_is_peer(const char *name);
#define PIPE_HOST_FLAG "--host-engine"

/* Finds the engine "pipe:COMMAND" or "FILE.so" in the table of engines, or adds it. Nothing is run
 * before the engine is opened. Errors: STATUS_INPUT not such a name, or too long; STATUS_LIMIT as
 * engine_add. */
enum status pipe_engine(const char *name, const struct engine **out,
                        struct reason *reason) MUST_USE;

/* Returns where in "pipe:COMMAND,cpu,embree" the engines behind the command begin, at their comma,
 * or NULL if what follows the last comma is no engine of the table. A comma that the command needs
 * can be quoted: "pipe:tracer --on 'gpu,cpu'" has no engines behind. */
const char *pipe_engines_behind(const char *name);

#endif
