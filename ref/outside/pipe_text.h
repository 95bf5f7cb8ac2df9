/* The text form of requests and answers, for shells, awk and tracers that cannot be run here. Words
 * are separated by blanks; '#' begins a comment. Numbers are hexadecimal floats (0x1.8p+1),
 * decimals, inf or nan.
 *
 *   request   raydiff 1                 version; optional
 *             from ...                  its origin; copy it to the answer
 *             query closest             or any
 *             v X Y Z                   a vertex
 *             t A B C                   a triangle of vertices before it, numbered from 0
 *             r OX OY OZ TMIN DX DY DZ TMAX
 *             end                       nothing follows
 *   answer    formula mt ieee           names of ref/outside/pipe.h; default unknown ieee
 *             flags open watertight unnamed      those that hold
 *             h T U V TRIANGLE          one line per ray, in order: a hit,
 *             m                         or a miss
 *             refused TEXT              instead of these lines
 *             end                       optional
 *
 * Of worlds it is version 2, which the first line states, in requests and in answers:
 *
 *   request   raydiff 2
 *             from ... modes=MODES ...
 *             query closest             or any
 *             filter KIND SEED SHARE    all, none, triangles or cells; all if there is no such line
 *             mesh                      v, t and g lines until the next i or r line are its own
 *             v X Y Z                   a vertex
 *             t A B C                   a triangle of the mesh's vertices, numbered from 0
 *             g TRIANGLES opaque        a geometry of the mesh's next triangles; or filtered
 *             i MESH CUSTOM MASK FLAGS M00 M01 M02 T0 M10 ... T2        an instance; MESH -: none
 *             r OX OY OZ TMIN DX DY DZ TMAX MASK FLAGS
 *             end
 *   answer    raydiff 2
 *             h T U V INSTANCE GEOMETRY TRIANGLE front [CUSTOM]         or back
 *             m, formula, flags, refused, end                           as above
 *
 * GEOMETRY counts in the mesh, TRIANGLE in the geometry; CUSTOM is left out by a tracer that keeps
 * no custom indices. */
#ifndef FUZZ_PIPE_TEXT_H
#define FUZZ_PIPE_TEXT_H

#include "ref/abi.h"
#include "ref/primitives/primitives.h"
#include "ref/scene/scene.h"
#include "ref/world/world.h"

#include <stdio.h>

#define PIPE_SPEC_MOST 256

/* How scene or world and rays were generated, to generate them again. */
struct pipe_from {
    uint64_t hash; /* pipe_hash */
    uint64_t seed, count;
    char rays[32];             /* ray set */
    char modes[16];            /* of a world: what rays may meet; else empty */
    char spec[PIPE_SPEC_MOST]; /* scene or world; empty: no such line */
};

/* The content of a file, request or answer. Owns its arrays (pipe_text_free). */
struct pipe_text {
    struct pipe_from from;
    uint32_t version; /* 2: of a world */
    enum query query;
    struct scene scene; /* zero: without v and t lines */
    struct world world; /* version 2: has passed world_finish; without mesh and i lines empty */
    struct ray *ray;
    struct ray_mode *mode; /* version 2: one per ray, else NULL */
    struct hit *hit;       /* version 2: names placed triangles; 0 without a world in the limits */
    uint32_t *tag;         /* version 2: one per hit, 0 without such a world; else NULL */
    size_t ray_count, hit_count;
    uint64_t last_line;                /* number of the last line */
    uint32_t formula, rounding, flags; /* of the answer */
    char refused[128];                 /* empty: not refused */
};

/* Limits that answers are checked against. */
struct pipe_limits {
    size_t rays;               /* hits expected; SIZE_MAX: not known */
    uint32_t triangles;        /* of a scene; UINT32_MAX: not known */
    const struct world *world; /* that answers are about; NULL: a scene, or not known */
};

/* The limits with which any text is read. */
static inline struct pipe_limits pipe_limits_none(void)
{
    return (struct pipe_limits){.rays = SIZE_MAX, .triangles = UINT32_MAX};
}

/* Parses `bytes`, where bytes[size] is 0; `name` is for messages. Errors: STATUS_INPUT "NAME:LINE:
 * rule"; STATUS_MEMORY. */
enum status pipe_text_parse(const char *name, const char *bytes, size_t size,
                            const struct pipe_limits *limits, struct pipe_text *out,
                            struct reason *reason) MUST_USE;
void pipe_text_free(struct pipe_text *text); /* does nothing if zero */

/* A hash of scene, rays and query: FNV-1a, 64 bits. pipe_hash_world is 0 without memory. */
uint64_t pipe_hash(const struct scene *scene, const struct ray *ray, size_t ray_count,
                   enum query query);
uint64_t pipe_hash_world(const struct world *world, const struct ray *ray,
                         const struct ray_mode *mode, size_t ray_count, enum query query);

/* Writes a request. `from` may be NULL: no such line. `decimal`: writes the shortest decimals that
 * read back as the same bits. The caller checks the stream for errors. */
void pipe_text_write(FILE *stream, const struct pipe_from *from, const struct scene *scene,
                     const struct ray *ray, size_t ray_count, enum query query, bool decimal);
void pipe_text_write_world(FILE *stream, const struct pipe_from *from, const struct world *world,
                           const struct ray *ray, const struct ray_mode *mode, size_t ray_count,
                           enum query query, bool decimal);

/* "all", "none", "triangles", "cells"; NULL past the end. */
const char *pipe_filter_name(uint32_t kind);

#endif
