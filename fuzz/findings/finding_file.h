/* The text file of a finding or of a regression: one trial, and the expected result. Numbers are
 * hexadecimal floats with decimals beside them; they read back to the bit.
 *
 *   raydiff trial 1
 *   expect cpu.rtrs_rf_paper.missed.rounded_inward    or: expect clean
 *   origin seed 7 index 12 version 1 stream gen       optional; stream gen or mut
 *   recipe soup of 32                                 optional, for people
 *   with raydiff 0.1.0                                any number: seen with these versions
 *   builder median leaf 4 eps 0x1.47ae14p-6
 *   box robust
 *   tri mt
 *   query closest
 *   store compact                                     optional; indexed
 *   optimize 4                                        optional; passes of reinsertion, or:
 *   rotate 4                                          passes of rotations
 *   presplit 0x1p-2                                   optional; parts cut before the build
 *   move 0x1p-3 seed 7                                optional; since the tree was built
 *   steps refit:jitter:3,rebuild:mirror               optional; scenes/life_steps.h
 *   vertices 3
 *   0x0p+0 0x0p+0 0x0p+0                              # 0.0 0.0 0.0
 *   ...
 *   triangles 1
 *   0 1 2
 *   rays 1
 *   0x1p-2 0x1p-2 -0x1p+0 0x0p+0 0x0p+0 0x1p+0 0x0p+0 inf    origin, direction, tmin, tmax
 *   end
 *
 * The same of a world (ref/world/world.h) has version 2. It does not move, but may have
 * steps, also of instances. Between
 * triangles and rays it has geometries, which take the triangles in turn, and instances: mesh (-:
 * none), custom index, mask, flags, and the transform, row by row. A ray has its mask and flags
 * behind tmax.
 *
 *   raydiff trial 2
 *   filter triangles seed 7 share 128                 optional; all seed 0 share 128
 *   ...
 *   geometries 2
 *   mesh 0 triangles 1 opaque                         or: filtered
 *   mesh 1 triangles 0 opaque
 *   instances 1
 *   0 0 255 0 0x1p+0 0x0p+0 0x0p+0 0x0p+0 ...
 *   rays 1
 *   0x1p-2 0x1p-2 -0x1p+0 0x0p+0 0x0p+0 0x1p+0 0x0p+0 inf 255 0
 *   end
 *
 * The lines before `vertices` come in any order, each once; `vertices`, `triangles`, a
 * world's `geometries` and `instances`, `rays` and `end` in this order. A # starts a comment,
 * except in `recipe`, `with` and `steps`, which are the rest of their line. Numbers may be decimal
 * too; in rays "inf" and "nan:0x7fc00000" with all its bits. */
#ifndef FUZZ_FINDING_FILE_H
#define FUZZ_FINDING_FILE_H

#include "fuzz/play/signature.h"
#include "fuzz/play/trial.h"
#include "ref/files/folder.h"

#define FINDING_FILE_VERSION 1
#define FINDING_FILE_WORLD   2 /* version of a world's */
/* Bytes of the largest file: more than any trial needs. */
#define FINDING_FILE_MOST ((size_t)96 << 20)

#define FINDING_VERSIONS_MOST 1024

struct finding_file {
    struct fuzz_trial trial;
    bool has_signature;                   /* false: a trial that must be clean */
    struct fuzz_signature signature;      /* what it shows */
    char versions[FINDING_VERSIONS_MOST]; /* of the engines and drivers that showed it, a line each,
                                             '\n' between them */
};

/* Writes `path` whole or not at all. What is no printable ASCII in recipe and versions is written
 * as '?'. Errors: STATUS_INPUT cannot write, or the signature is none; STATUS_MEMORY. */
enum status finding_file_write(const struct finding_file *file, const char *path,
                               struct reason *reason) MUST_USE;

/* The same of the file `name` of a folder. */
enum status finding_file_put(const struct finding_file *file, const struct folder *folder,
                             const char *name, struct reason *reason) MUST_USE;

/* The same into memory: *bytes has a 0 after the last byte; the caller frees it. Errors:
 * STATUS_INPUT the signature is none; STATUS_MEMORY. */
enum status finding_file_print(const struct finding_file *file, char **bytes, size_t *size,
                               struct reason *reason) MUST_USE;

/* Reads and checks (fuzz_trial_check). Errors: STATUS_INPUT "PATH:LINE: rule"; STATUS_LIMIT;
 * STATUS_MEMORY. *out is zero on error. */
enum status finding_file_read(const char *path, struct finding_file *out,
                              struct reason *reason) MUST_USE;

/* The same of the file `name` of a folder. */
enum status finding_file_get(const struct folder *folder, const char *name,
                             struct finding_file *out, struct reason *reason) MUST_USE;

/* The same of bytes in memory, for fuzzing the reader and for pipes; `name` stands in messages, and
 * bytes[size] is 0. Allocates at most 4 times `size` and a constant. */
enum status finding_file_parse(const char *name, const char *bytes, size_t size,
                               struct finding_file *out, struct reason *reason) MUST_USE;

void finding_file_free(struct finding_file *file);

#endif
