/* libraydiff: is what a ray tracer answers right? Exact answers for rays into triangles, verdicts
 * on answers with the reason, rays that are hard for a scene, and the smallest failing case.
 *
 *   cc test.c $(pkg-config --cflags --libs libraydiff)       the shared library
 *   cc test.c $(pkg-config --cflags --libs raydiff)          the static one
 *
 * Plain C11, or C++11. The library prints nothing, never ends the program, reads no file but what
 * the system tells of free memory, and keeps no state of its own: everything belongs to a handle.
 * Any functions may run at the same time, on one oracle, too, which only raydiff_oracle_free
 * changes. They may be called in any floating-point mode of the thread (a program compiled with
 * -ffast-math flushes subnormals) and leave it as it was.
 *
 * Arrays that are given are read during the call and not kept. Rays are 8 floats each:
 *
 *   ox oy oz tmin dx dy dz tmax      the points o + t d, tmin <= t <= tmax
 *
 * t counts in multiples of d, which need not have length 1. tmax may be infinite. A count of 0 is
 * allowed everywhere, with NULL for the array. Triangles are counted from 0.
 *
 * A function that can fail returns enum raydiff_error and writes one line into *why (NULL: it is
 * not written), empty if all is well. Errors are listed in the order of checking. Outputs are zero
 * on error. */
#ifndef RAYDIFF_H
#define RAYDIFF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RAYDIFF_VERSION_MAJOR 0
#define RAYDIFF_VERSION_MINOR 2
#define RAYDIFF_VERSION_PATCH 0

/* The number in the name of the shared library, libraydiff.so.1. It grows when a program would have
 * to be compiled again. */
#define RAYDIFF_ABI 1

#if defined(__GNUC__)
#define RAYDIFF_PUBLIC __attribute__((visibility("default")))
#else
#define RAYDIFF_PUBLIC
#endif

/* The version of the library that runs: major << 16 | minor << 8 | patch. */
RAYDIFF_PUBLIC uint32_t raydiff_version(void);

enum raydiff_error {
    RAYDIFF_ERROR_NONE = 0,
    RAYDIFF_ERROR_MEMORY = 1,      /* out of memory */
    RAYDIFF_ERROR_INPUT = 2,       /* what was given breaks a rule, which the line names */
    RAYDIFF_ERROR_LIMIT = 3,       /* it is larger than a stated limit */
    RAYDIFF_ERROR_UNSUPPORTED = 4, /* the processor or its settings cannot compute exactly */
    RAYDIFF_ERROR_STOPPED = 5,     /* a callback ended the work */
    RAYDIFF_ERROR_INTERNAL = 6     /* the library contradicts itself: a bug of raydiff */
};

struct raydiff_why {
    char line[320];
};

#define RAYDIFF_NOTHING 0xFFFFFFFFu /* the triangle of a miss */

/* --- triangles -------------------------------------------------------------------------------- */

struct raydiff_oracle; /* triangles, and all that is needed to decide rays into them exactly */

/* Makes the oracle of triangles.
 *   vertex  3 * vertex_count finite floats; copied
 *   index   3 * triangle_count numbers of vertices, each below vertex_count; copied
 * A triangle may be degenerate: without an area it is never hit. The caller frees *out with
 * raydiff_oracle_free.
 * Errors: INPUT an array is NULL; a vertex that is not finite; a triangle with a vertex that is
 * not there (the line names the first one); LIMIT more than 2^32 - 2 triangles; MEMORY;
 * UNSUPPORTED. */
RAYDIFF_PUBLIC enum raydiff_error
raydiff_oracle_make(const float *vertex, uint32_t vertex_count, const uint32_t *index,
                    uint32_t triangle_count, struct raydiff_oracle **out, struct raydiff_why *why);

RAYDIFF_PUBLIC void raydiff_oracle_free(struct raydiff_oracle *oracle); /* NULL is fine */

/* --- worlds: meshes, placed by instances ------------------------------------------------------ */

struct raydiff_mesh {
    const float *vertex; /* as of raydiff_oracle_make */
    const uint32_t *index;
    uint32_t vertex_count, triangle_count;
};

/* A placed mesh. */
struct raydiff_instance {
    float
        transform[12]; /* 3 rows of 4: p is placed at M p + T, T being the last column; finite, and
                            det M is not 0 */
    uint32_t mesh;
    uint32_t mask; /* 8 bits: a ray meets the instance if its own mask has a bit in common */
};

/* Makes the oracle of a world, which all functions below take, but for raydiff_check_tree. Its
 * triangles are placed ones: triangle k of the mesh of instance i has number first + k, where first
 * is the number of triangles of all instances before i (raydiff_placed). Their vertices are M p + T
 * of real numbers, exactly; t counts in multiples of the ray's direction in the world. All meshes
 * are opaque; nothing is culled.
 *   mesh, instance  copied. Many instances of a mesh cost little
 * Errors: INPUT an array is NULL; the first mesh or instance with something wrong, and the rule;
 * LIMIT more than 2^32 - 2 placed triangles; MEMORY; UNSUPPORTED. */
RAYDIFF_PUBLIC enum raydiff_error
raydiff_oracle_make_world(const struct raydiff_mesh *mesh, uint32_t mesh_count,
                          const struct raydiff_instance *instance, uint32_t instance_count,
                          struct raydiff_oracle **out, struct raydiff_why *why);

/* Where triangle `number` is: its instance, and its number in the mesh; of triangles without
 * instances 0 and `number`. Errors: INPUT an argument is NULL; there is no such triangle. */
RAYDIFF_PUBLIC enum raydiff_error raydiff_placed(const struct raydiff_oracle *oracle,
                                                 uint32_t number, uint32_t *instance,
                                                 uint32_t *triangle, struct raydiff_why *why);

/* The number of the first triangle of an instance, or with `instance` their count the number of all
 * triangles; RAYDIFF_NOTHING without such an instance, or oracle. Triangles without instances are
 * those of instance 0. */
RAYDIFF_PUBLIC uint32_t raydiff_first_of(const struct raydiff_oracle *oracle, uint32_t instance);

/* --- exact answers ---------------------------------------------------------------------------- */

/* How a ray meets a triangle. The triangle is closed: its edges and vertices belong to it. */
enum raydiff_class {
    RAYDIFF_CLASS_MISS = 0,
    RAYDIFF_CLASS_INSIDE = 1,
    RAYDIFF_CLASS_EDGE = 2,    /* exactly through an edge */
    RAYDIFF_CLASS_VERTEX = 3,  /* exactly through a vertex */
    RAYDIFF_CLASS_IN_PLANE = 4 /* the ray lies in the plane and touches the triangle; no hit */
};

/* "miss", "inside", "edge", "vertex", "in_plane"; NULL for another number. */
RAYDIFF_PUBLIC const char *raydiff_class_name(uint32_t number);

/* The nearest hit of a ray. */
struct raydiff_nearest {
    uint32_t triangle; /* the first of those at the nearest t; RAYDIFF_NOTHING: a miss */
    uint32_t ties;     /* how many triangles are at exactly that t; 0 of a miss */
    uint32_t kind;     /* enum raydiff_class, of `triangle` */
    uint32_t refused;  /* 1: the ray has a NaN, an infinite origin, direction or tmin, or tmin >
                          tmax; it counts as a miss */
    double t_lo, t_hi; /* enclose the exact t, relatively at most 2^-40 apart; 0 of a miss */
    double t_next;     /* no other hit is nearer than this; infinite if there is none, or of a
                          miss */
};

/* Decides `count` rays, whatever their scale, in integer arithmetic where doubles do not suffice.
 * Something is hit at all (an any-hit) exactly if `triangle` is not RAYDIFF_NOTHING.
 *   ray      8 * count floats
 *   mask     of a world: the mask of each ray, at most 255; NULL: 255 each
 *   threads  0: all that OpenMP gives
 *   out      room for `count`
 * The result depends on the triangles and the ray alone.
 * Errors: INPUT an argument is NULL; a mask over 255, or masks without a world; MEMORY. */
RAYDIFF_PUBLIC enum raydiff_error
raydiff_exact(const struct raydiff_oracle *oracle, const float *ray, const uint32_t *mask,
              size_t count, uint32_t threads, struct raydiff_nearest *out, struct raydiff_why *why);

/* One of all hits of a ray. */
struct raydiff_crossing {
    uint32_t triangle;
    uint32_t kind;     /* enum raydiff_class: not MISS */
    double t_lo, t_hi; /* enclose the exact t; in plane: the part of the ray in the triangle */
};

/* Finds every triangle that one ray meets in its range, ends included: sorted by exact t (in plane:
 * by t_lo), then by number. In a world its mask is 255.
 *   ray       8 floats
 *   capacity  the most that are written to `out`, which may be NULL if it is 0
 *   found     receives how many there are, which may be more
 * Errors: INPUT an argument is NULL; the ray is one that raydiff_exact refuses; MEMORY. */
RAYDIFF_PUBLIC enum raydiff_error raydiff_exact_all(const struct raydiff_oracle *oracle,
                                                    const float *ray, size_t capacity,
                                                    struct raydiff_crossing *out, size_t *found,
                                                    struct raydiff_why *why);

/* Writes the exact t of a triangle that a ray hits: a fraction in lowest terms, "1/3", or
 * "num/den*2^k".
 *   text  room for `bytes`, the terminator included
 * Errors: INPUT an argument is NULL, the ray is one that raydiff_exact refuses, there is no such
 * triangle, or the ray does not hit it; LIMIT the text is too long for `bytes` (2048 always
 * suffice). */
RAYDIFF_PUBLIC enum raydiff_error raydiff_exact_text(const struct raydiff_oracle *oracle,
                                                     const float *ray, uint32_t triangle,
                                                     char *text, size_t bytes,
                                                     struct raydiff_why *why);

/* --- judging ---------------------------------------------------------------------------------- */

/* What a tracer answered to a ray. u weighs the triangle's second vertex, v its third. Of a miss
 * (triangle RAYDIFF_NOTHING) t, u and v are not read. */
struct raydiff_answer {
    float t, u, v;
    uint32_t triangle;
};

/* How answers are judged. All zero: nearest hits of an unknown formula. */
struct raydiff_judging {
    /* The formula of the triangle test, not in a world: "mt", "woop", "embree", "embree_robust",
     * "pluecker", "baldwin_webber", "tri_accel"; answers are then held to its proven bounds. NULL
     * or "unknown": by how far vertices must move to make an answer right. */
    const char *formula;
    /* The arithmetic of a known formula: NULL or "ieee", "flushed" (subnormals are 0), "vulkan",
     * "vulkan_rte", "embree". It does not matter for an unknown one, but must be one of these. */
    const char *rounding;
    const uint32_t *mask; /* in a world: the mask of each ray, at most 255; NULL: 255 each */
    float displacement;   /* unknown formula: what an answer may need, in units of 2^-24 of the
                           vertex' distance from the ray's origin; 0: 32, and more where the worst
                           published test needs it; finite */
    bool any;             /* answers are any hit, not the nearest one */
    bool open;            /* the tracer's range is tmin < t < tmax; else ends are hits, too */
    bool watertight;      /* the tracer promises that no ray passes between two triangles that share
                           an edge */
    bool unnamed; /* its any-hits name no triangle: any number but RAYDIFF_NOTHING is a hit */
    bool demand_watertight; /* count hits lost inside closed fans of triangles as faults, whatever
                               the tracer promises */
};

enum raydiff_verdict {
    RAYDIFF_VERDICT_RIGHT = 0,    /* the nearest triangle (any: one that is hit), or a miss */
    RAYDIFF_VERDICT_TIE = 1,      /* one of several at exactly the same nearest t */
    RAYDIFF_VERDICT_NEAR_TIE = 2, /* behind the nearest by no more than rounding */
    RAYDIFF_VERDICT_BOUNDARY = 3, /* so near an edge that rounding decides */
    RAYDIFF_VERDICT_BORDER = 4,   /* so near tmin or tmax that rounding decides */
    RAYDIFF_VERDICT_IN_PLANE = 5, /* the ray lies in the triangle's plane */
    RAYDIFF_VERDICT_SLAB = 6,     /* formula embree: its box test cannot see the hit */
    RAYDIFF_VERDICT_NOISE = 7,    /* seen so edge-on that t is noise */
    RAYDIFF_VERDICT_OUT_OF_CONTRACT = 8, /* numbers for which no test promises anything: see
                                            docs/verdicts.md */
    RAYDIFF_VERDICT_WRONG = 9,           /* a bug: see enum raydiff_fault */
    RAYDIFF_VERDICTS = 10
};

enum raydiff_fault {
    RAYDIFF_FAULT_NOT = 0,         /* the verdict is not WRONG */
    RAYDIFF_FAULT_MISSED = 1,      /* a hit was lost */
    RAYDIFF_FAULT_PHANTOM = 2,     /* a triangle where nothing is hit, or that is not there */
    RAYDIFF_FAULT_TRIANGLE = 3,    /* a triangle that is not hit, where another one is */
    RAYDIFF_FAULT_DISTANCE = 4,    /* t is too far off, or out of the range */
    RAYDIFF_FAULT_BARYCENTRIC = 5, /* u or v is too far off */
    RAYDIFF_FAULT_NOT_FINITE = 6,  /* t, u or v is NaN or infinite */
    RAYDIFF_FAULT_MASKED = 11,     /* worlds: of an instance that the ray does not meet */
    RAYDIFF_FAULT_INSTANCE = 14,   /* worlds: the same triangle of another instance is hit */
    RAYDIFF_FAULTS = 16            /* further numbers are of other judges of raydiff */
};

/* "right", "tie", "near_tie", ..., "wrong"; "not", "missed", ..., as in raydiff's JSON; NULL for
 * another number. docs/verdicts.md has a paragraph on each. */
RAYDIFF_PUBLIC const char *raydiff_verdict_name(uint32_t number);
RAYDIFF_PUBLIC const char *raydiff_fault_name(uint32_t number);

/* The verdict on one answer. */
struct raydiff_judged {
    uint32_t verdict;    /* enum raydiff_verdict */
    uint32_t fault;      /* enum raydiff_fault */
    uint32_t expected;   /* the exactly nearest triangle, or RAYDIFF_NOTHING */
    uint32_t lost;       /* a hit that should not have been lost, if that is another one; or
                          RAYDIFF_NOTHING */
    double t_lo, t_hi;   /* enclose the exact t of `expected`; 0 of a miss */
    double over;         /* known formula: error of t, in parts of what is allowed; else 0 */
    double displacement; /* unknown formula: the smallest displacement of vertices that makes the
                            answer right, in the units of raydiff_judging; else 0 */
};

/* Sums over all answers of a call. */
struct raydiff_counts {
    uint64_t answers;
    uint64_t hits;                      /* answers that name a triangle */
    uint64_t verdict[RAYDIFF_VERDICTS]; /* answers of each */
    uint64_t fault[RAYDIFF_FAULTS];     /* of verdict[RAYDIFF_VERDICT_WRONG] */
    uint64_t beside_edges; /* unknown formula: hits lost beside edges that are more than rounding
                              loses, each excused alone */
    uint64_t in_fans;      /* with demand_watertight: hits lost inside closed fans */
    uint64_t faults;       /* verdict[RAYDIFF_VERDICT_WRONG] + beside_edges + in_fans: 0 if the
                              tracer is right */
    double over, displacement; /* the largest of all answers */
    bool vacuous; /* no fault, but so few hits (below one in 1000 answers) that nothing is
                     proven */
};

/* Judges `count` answers, each alone against the exact truth, as `raydiff judge` does.
 *   how      NULL: all zero
 *   ray      8 * count floats
 *   answer   `count` of them
 *   threads  0: all that OpenMP gives
 *   out      room for `count`, or NULL
 *   counts   NULL: not counted
 * The verdict on an answer does not depend on the others, nor on threads. Setting up costs as much
 * as looking at each triangle once, so that many answers are best given together.
 * Errors: INPUT an argument is NULL; a mask over 255, or masks without a world; a formula or a
 * rounding that there is not (the line names a near one); a displacement that is negative, not
 * finite, or of a known formula; a formula in a world, where transforms are the tracer's own; LIMIT
 * the inverse of a transform is beyond float32; MEMORY. */
RAYDIFF_PUBLIC enum raydiff_error
raydiff_judge(const struct raydiff_oracle *oracle, const struct raydiff_judging *how,
              const float *ray, const struct raydiff_answer *answer, size_t count, uint32_t threads,
              struct raydiff_judged *out, struct raydiff_counts *counts, struct raydiff_why *why);

#define RAYDIFF_REASON_BYTES 512

/* Judges one answer and writes the reason as a line: verdict and kind of fault, the ray and the
 * answer in hexadecimal floats, and what is expected, as `raydiff judge` prints it.
 *   ray   8 floats; of how->mask the first is read
 *   text  room for RAYDIFF_REASON_BYTES
 * Errors: as raydiff_judge. */
RAYDIFF_PUBLIC enum raydiff_error raydiff_reason(const struct raydiff_oracle *oracle,
                                                 const struct raydiff_judging *how,
                                                 const float *ray,
                                                 const struct raydiff_answer *answer, char *text,
                                                 struct raydiff_why *why);

/* --- packed trees ----------------------------------------------------------------------------- */

/* What is wrong with a packed tree. All zero: it is sound. */
struct raydiff_faults {
    uint32_t loose_boxes;      /* boxes that do not contain everything below them */
    uint32_t bad_references;   /* children out of range */
    uint32_t cycles;           /* nodes reached more than once */
    uint32_t lost_triangles;   /* in no leaf */
    uint32_t double_triangles; /* namings of a triangle beyond its first */
    uint32_t bad_triangles;    /* items that are no triangle, and leaves with too many of them */
    uint32_t too_deep;         /* 1: a path needs more stack than the file states */
    uint32_t bad_vertices;     /* stored vertices that differ from the triangle's in a bit */
};

/* Checks a tree packed in a layout of raydiff, in the file format of `raydiff precompute --layout`
 * (docs/formats.md), as `raydiff precompute --verify` does.
 *   bytes   `size` of them
 *   faults  may be NULL
 * Returns RAYDIFF_ERROR_NONE for a tree that can be traversed: it is right if *why is empty, else
 * *why has its first fault.
 * Errors: INPUT an argument is NULL, the oracle is of a world, no such file, or no tree of these
 * triangles that can be traversed (the line names the rule; *faults is zero); MEMORY. */
RAYDIFF_PUBLIC enum raydiff_error raydiff_check_tree(const struct raydiff_oracle *oracle,
                                                     const void *bytes, size_t size,
                                                     struct raydiff_faults *faults,
                                                     struct raydiff_why *why);

/* --- hard rays -------------------------------------------------------------------------------- */

/* Name of ray set `number`, as `raydiff list rays` has them: "mixed", which is all others by turns,
 * then "primary", "random", "vertices", "edges", ...; NULL past the last. */
RAYDIFF_PUBLIC const char *raydiff_rays_name(uint32_t number);

/* Makes rays that are hard for these triangles: through edges, vertices and corners, along axes,
 * from surfaces, with ends at a hit.
 *   set   a name of raydiff_rays_name; NULL: "mixed"
 *   seed  the same seed gives the same rays, on every machine
 *   ray   room for 8 * count floats
 * Errors: INPUT an argument is NULL; there is no such set (the line names a near one); no camera
 * ray hits the triangles (bounce); MEMORY. */
RAYDIFF_PUBLIC enum raydiff_error raydiff_hard_rays(const struct raydiff_oracle *oracle,
                                                    const char *set, uint64_t seed, size_t count,
                                                    float *ray, struct raydiff_why *why);

/* --- shrinking -------------------------------------------------------------------------------- */

/* A ray and some triangles, for the callback of raydiff_shrink; valid during the call. */
struct raydiff_case {
    const float *vertex;   /* 3 * vertex_count */
    const uint32_t *index; /* 3 * triangle_count */
    uint32_t vertex_count, triangle_count;
    const float *ray; /* 8 */
};

/* Returns 1 if the tracer still fails on the case, 0 if not, below 0 to end the shrinking. */
typedef int raydiff_fails(void *user, const struct raydiff_case *what);

struct raydiff_small; /* a case that owns its arrays */

/* Shrinks a failing case: fewer triangles and vertices, then shorter numbers, as long as `fails`
 * returns 1. It is called on the calling thread, first with the case itself. Deterministic if
 * `fails` is.
 *   what  the ray and the triangles; copied
 *   calls the most calls of `fails`, after the first, where a call with n triangles counts
 *         1 + n / 64; 0: 100000
 * If *what does not fail, *out is a copy of it. The caller frees *out with raydiff_small_free.
 * Errors: INPUT an argument is NULL; triangles as in raydiff_oracle_make; LIMIT more than 131072
 * triangles, or three times as many vertices; MEMORY; STOPPED `fails` returned a number below
 * 0. */
RAYDIFF_PUBLIC enum raydiff_error raydiff_shrink(const struct raydiff_case *what,
                                                 raydiff_fails *fails, void *user, uint64_t calls,
                                                 struct raydiff_small **out,
                                                 struct raydiff_why *why);

/* The case; borrowed from `small`. */
RAYDIFF_PUBLIC struct raydiff_case raydiff_small_case(const struct raydiff_small *small);

RAYDIFF_PUBLIC void raydiff_small_free(struct raydiff_small *small); /* NULL is fine */

#ifdef __cplusplus
}
#endif

#endif
