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
 *             end                       optional */
#ifndef FUZZ_PIPE_TEXT_H
#define FUZZ_PIPE_TEXT_H

#include "ref/abi.h"
#include "ref/primitives/primitives.h"
#include "ref/scene/scene.h"

#include <stdio.h>

#define PIPE_SPEC_MOST 256

/* How scene and rays were generated, to generate them again. */
struct pipe_from {
    uint64_t hash; /* pipe_hash */
    uint64_t seed, count;
    char rays[32];             /* ray set */
    char spec[PIPE_SPEC_MOST]; /* scene; empty: no such line */
};

/* The content of a file, request or answer. Owns its arrays (pipe_text_free). */
struct pipe_text {
    struct pipe_from from;
    enum query query;
    struct scene scene; /* zero: without v and t lines */
    struct ray *ray;
    struct hit *hit;
    size_t ray_count, hit_count;
    uint64_t last_line;                /* number of the last line */
    uint32_t formula, rounding, flags; /* of the answer */
    char refused[128];                 /* empty: not refused */
};

/* Limits that answers are checked against. */
struct pipe_limits {
    size_t rays;        /* hits expected; SIZE_MAX: not known */
    uint32_t triangles; /* UINT32_MAX: not known */
};

/* Parses `bytes`, where bytes[size] is 0; `name` is for messages. Errors: STATUS_INPUT "NAME:LINE:
 * rule"; STATUS_MEMORY. */
enum status pipe_text_parse(const char *name, const char *bytes, size_t size,
                            const struct pipe_limits *limits, struct pipe_text *out,
                            struct reason *reason) MUST_USE;
void pipe_text_free(struct pipe_text *text); /* does nothing if zero */

/* A hash of scene, rays and query: FNV-1a, 64 bits. */
uint64_t pipe_hash(const struct scene *scene, const struct ray *ray, size_t ray_count,
                   enum query query);

/* Writes a request. `from` may be NULL: no such line. `decimal`: writes the shortest decimals that
 * read back as the same bits. The caller checks the stream for errors. */
void pipe_text_write(FILE *stream, const struct pipe_from *from, const struct scene *scene,
                     const struct ray *ray, size_t ray_count, enum query query, bool decimal);

#endif
