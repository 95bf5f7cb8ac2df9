/* The oracle: what a ray exactly hits. The float32 numbers of a scene and a ray are taken as real
 * numbers and decided without error: a double filter, __int128 where the exponents allow it, else
 * fixed-width integers of our own. Knows scenes and rays only; never a tree, a layout or an engine
 * of the ones it judges.
 *
 * With A = v0 - o, B = v1 - o, C = v2 - o and [x,y,z] = x . (y cross z):
 *   w0 = [d,B,C], w1 = [d,C,A], w2 = [d,A,B], D = w0 + w1 + w2, T = [A,B,C], t = T / D
 * The triangle is closed: a hit is D != 0 and no two w of opposite sign. */
#ifndef ORACLE_H
#define ORACLE_H

#include "ref/abi.h"
#include "ref/scene/scene.h"

/* How the line of a ray meets a triangle, whatever the range of t. */
enum oracle_class {
    ORACLE_MISS,      /* passes outside, or parallel beside the plane */
    ORACLE_INSIDE,    /* through the interior: a certain hit */
    ORACLE_EDGE,      /* through the interior of an edge: exactly one w is 0 */
    ORACLE_VERTEX,    /* through a vertex: exactly two w are 0 */
    ORACLE_IN_PLANE,  /* lies in the plane and touches the triangle: t is an interval */
    ORACLE_ZERO_AREA, /* the vertices are collinear: never a hit, whatever the ray */
    ORACLE_CLASS_COUNT
};

/* Where the exact t lies. An interval (in plane) is WITHIN if it meets [tmin, tmax]. */
enum oracle_range {
    ORACLE_BELOW,   /* t < tmin */
    ORACLE_AT_TMIN, /* t == tmin < tmax, or tmin == t == tmax */
    ORACLE_WITHIN,  /* tmin < t < tmax */
    ORACLE_AT_TMAX, /* tmin < t == tmax */
    ORACLE_ABOVE,   /* t > tmax */
};

/* Whether t == tmin and t == tmax are hits. */
enum oracle_ends {
    ORACLE_CLOSED, /* tmin <= t <= tmax: mt, woop */
    ORACLE_OPEN,   /* tmin < t < tmax: mt_rtrs, the specification of Vulkan's ray query */
};

/* One ray and one triangle, decided exactly. */
struct oracle_pair {
    enum oracle_class class;
    enum oracle_range range; /* meaningless for MISS and ZERO_AREA */
    int edge[3];             /* signs of w0, w1, w2: -1, 0, 1; w_i is opposite vertex i */
    int det;                 /* sign of D */
    double t_lo, t_hi;       /* enclose t, in range with a relative width of at most 2^-40 or within
                          0 .. FRACTION_LEAST or FRACTION_MOST .. INFINITY or their negatives; in
                          plane: the overlap, cut by the range if it meets it; else infinite */
    double margin;  /* min w_i / D, the smallest barycentric: 0 on an edge and in plane; of a
                          hit known to 2^-18 of itself; negative for a miss, -INFINITY if D is 0 */
    bool by_filter; /* double sufficed */
};

/* INSIDE, EDGE or VERTEX. */
static inline bool oracle_is_hit(const struct oracle_pair *pair)
{
    return pair->class == ORACLE_INSIDE || pair->class == ORACLE_EDGE ||
           pair->class == ORACLE_VERTEX;
}

/* Whether a hit, or an interval in the plane, counts under `ends`. */
static inline bool oracle_in_range(const struct oracle_pair *pair, enum oracle_ends ends)
{
    return pair->range == ORACLE_WITHIN ||
           (ends == ORACLE_CLOSED &&
            (pair->range == ORACLE_AT_TMIN || pair->range == ORACLE_AT_TMAX));
}

/* The nearest hit of a ray in its range. */
struct oracle_answer {
    uint32_t prim;      /* smallest index of the exact nearest set; ABI_NO_PRIM: a miss */
    uint32_t tie_count; /* size of the nearest set: triangles at exactly the same t */
    double t_lo, t_hi;  /* enclose the nearest t */
    double t_next;      /* lower bound of the next hit's t beyond the set; INFINITY if none */
    float margin;       /* smallest margin of the nearest set, as oracle_pair's */
    uint8_t class;      /* enum oracle_class of prim: INSIDE, EDGE, VERTEX; MISS for a miss */
    uint8_t flags;      /* ORACLE_SAW_* */
};

/* In plane: some triangle touches the ray in its plane, in range and not behind the nearest hit.
 * Exact: one of the nearest set left the double filter, or there are several. */
#define ORACLE_SAW_IN_PLANE 1u
#define ORACLE_SAW_EXACT    2u
#define ORACLE_REFUSED      4u /* NaN or infinity in the ray, or tmin > tmax: a miss */

/* How the triangles of a ray are found. */
enum oracle_path {
    ORACLE_AUTO,  /* brute up to ORACLE_BRUTE_MOST triangles, else tree */
    ORACLE_BRUTE, /* every triangle */
    ORACLE_TREE,  /* the oracle's own tree: boxes in double precision with proven padding */
};
#define ORACLE_BRUTE_MOST 65536u

struct oracle; /* of one scene, or of one world (ref/oracle/oracle_world.h) */

/* Work done. */
struct oracle_stats {
    uint64_t pairs;     /* ray-triangle pairs tested */
    uint64_t undecided; /* of them, those that left the double filter */
    uint64_t wide;      /* of them, those that left __int128 too */
};

/* Makes the oracle of `scene`, which is borrowed and must have passed scene_check, with its tree
 * (some 0.7 us and 150 bytes per triangle); calls below are const and safe from several threads.
 * Errors: STATUS_UNSUPPORTED the float environment is not IEEE (oracle_environment); STATUS_MEMORY.
 */
enum status oracle_make(const struct scene *scene, struct oracle **out,
                        struct reason *reason) MUST_USE;
void oracle_free(struct oracle *oracle); /* NULL is fine */

/* The scene that the oracle was made of; NULL if it was a world. */
const struct scene *oracle_scene(const struct oracle *oracle);

/* Checks what the filter relies on, on the calling thread: round to nearest, subnormals kept
 * (neither FTZ nor DAZ), no contraction, FLT_EVAL_METHOD 0. The functions below correct the modes
 * of their thread (a library may have left FTZ and DAZ set) and restore them. Errors:
 * STATUS_UNSUPPORTED with what is wrong. */
enum status oracle_environment(struct reason *reason) MUST_USE;

/* Exact nearest hits of `count` rays in the oracle's scene on `threads` threads (0: all). Any
 * finite ray is decided, whatever its scale; a zero direction misses everything.
 *   stats   may be NULL; added to
 * The answer is the same on any path and any number of threads; ORACLE_TREE is the fastest, about
 * 1 us a ray on a mesh of 10^4 triangles. Errors: STATUS_MEMORY. */
enum status oracle_closest(const struct oracle *oracle, enum oracle_path path,
                           enum oracle_ends ends, const struct ray *ray, size_t count,
                           unsigned threads, struct oracle_answer *out, struct oracle_stats *stats,
                           struct reason *reason) MUST_USE;

/* Decides one pair. The ray must be finite (tmax may be infinite), prim < tri_count. */
void oracle_pair(const struct oracle *oracle, const struct ray *ray, uint32_t prim,
                 struct oracle_pair *out);

/* Sign of t_a - t_b, exactly; both must be INSIDE, EDGE or VERTEX for this ray. */
int oracle_compare(const struct oracle *oracle, const struct ray *ray, uint32_t a, uint32_t b);

/* One triangle along a ray. */
struct oracle_crossing {
    uint32_t prim;
    struct oracle_pair pair;
};

/* Of the oracle's scene, every triangle of class INSIDE, EDGE, VERTEX or IN_PLANE whose exact t (or
 * interval) meets the range of the ray, ends included, and whose t_lo <= t_most; sorted by exact t
 * (in plane: by t_lo), then by index. *list is grown with array_reserve and kept by the caller for
 * the next ray. Errors: STATUS_MEMORY. */
enum status oracle_crossings(const struct oracle *oracle, const struct ray *ray, double t_most,
                             struct oracle_crossing **list, size_t *capacity, size_t *count,
                             struct reason *reason) MUST_USE;

/* Writes the exact t of a hit as a reduced fraction "num/den" in decimal, or "num/den*2^k". At most
 * `text_bytes` with the terminator; returns false if it did not fit or the pair is no hit. */
bool oracle_rational(const struct oracle *oracle, const struct ray *ray, uint32_t prim, char *text,
                     size_t text_bytes);

#define ORACLE_T_TEXT 96

/* Writes the exact t of a hit for people: "= 0.25" if a decimal of at most 17 digits is exact,
 * "= 1/3, about 0.3333333333333" if a short fraction is, else "about 0.7071067811865". Without a
 * hit "is none". */
void oracle_t_text(const struct oracle *oracle, const struct ray *ray, uint32_t prim,
                   char text[ORACLE_T_TEXT]);

/* "miss", "inside", "edge", "vertex", "in_plane", "zero_area". */
const char *oracle_class_name(enum oracle_class class);

#endif
