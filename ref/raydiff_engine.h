/* Interface of a tracer that is a shared object, for
 *   raydiff check SCENE --engine ./mine.so
 * It is plain C11 and C++11 and needs nothing else of raydiff. The object exports one function,
 * raydiff_engine, which returns a table of functions. fuzz/samples/engine/ has a template in C and
 * a tracer in C++, docs/my-engine.md writes one.
 *
 *   cc -O2 -shared -fPIC -I RAYDIFF -o mine.so mine.c
 *
 * raydiff runs `./mine.so` in a process of its own, with limits of time and memory, so that a crash
 * is a finding; `inside:./mine.so` runs in raydiff's process, where nothing is between the two.
 * Functions are called by one thread at a time. In the process of its own the standard input is
 * empty, the standard output goes nowhere, and the standard error must stay silent. */
#ifndef RAYDIFF_ENGINE_H
#define RAYDIFF_ENGINE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version 1 ends before `move`, and has no MOVE; raydiff takes its tables as they are. */
#define RAYDIFF_ENGINE_VERSION 2u
#define RAYDIFF_ENGINE_NONE    0xFFFFFFFFu /* no triangle, no mesh, no custom index */

/* What functions return. With all but OK, `reason` has one line of text that tells why. */
enum raydiff_engine_status {
    RAYDIFF_ENGINE_OK = 0,
    RAYDIFF_ENGINE_REFUSED = 1, /* this scene, or it cannot run here; another may be accepted */
    RAYDIFF_ENGINE_MEMORY = 2,
    RAYDIFF_ENGINE_FAILED = 3 /* anything else, such as a lost device */
};

/* Bits of `can`. */
#define RAYDIFF_ENGINE_CLOSEST 1u  /* the nearest hit: build, trace */
#define RAYDIFF_ENGINE_ANY     2u  /* any hit: build, trace */
#define RAYDIFF_ENGINE_ALL     4u  /* all hits: build, trace_all */
#define RAYDIFF_ENGINE_WORLDS  8u  /* instances, masks, filters: build_world, trace_world */
#define RAYDIFF_ENGINE_NATIVE  16u /* ray buffers of its own: rays_make and the three behind it */
#define RAYDIFF_ENGINE_MOVE    32u /* an update of the scene when vertices have moved: move */

enum raydiff_engine_query { RAYDIFF_ENGINE_QUERY_CLOSEST = 0, RAYDIFF_ENGINE_QUERY_ANY = 1 };

#define RAYDIFF_ENGINE_REASON 256u /* bytes of every `reason`, with the final 0; empty before */

struct raydiff_engine_options {
    uint32_t bytes;   /* of this structure; later versions append */
    uint32_t threads; /* how many may trace at once; 0: as many as there are processors */
};

/* --- scenes ----------------------------------------------------------------------------------- */

/* Triangles. Triangle i has the vertices index[3i .. 3i+2], each of three floats. Arrays of a count
 * of 0 may be NULL. All is valid until the next build, move or close. */
struct raydiff_engine_mesh {
    const float *vertex;
    const uint32_t *index;
    uint32_t vertex_count, triangle_count;
};

/* A hit has tmin <= t <= tmax; t is in multiples of the direction, which need not have length 1. */
struct raydiff_engine_ray {
    float origin[3];
    float tmin;
    float direction[3];
    float tmax;
};

/* u is the weight of the triangle's second vertex, v of its third. A miss has the triangle
 * RAYDIFF_ENGINE_NONE, whatever t, u and v. */
struct raydiff_engine_hit {
    float t, u, v;
    uint32_t triangle;
};

/* --- worlds: docs/worlds.md has what masks, flags and filters mean ---------------------------- */

/* The next `triangle_count` triangles of its mesh. */
struct raydiff_engine_geometry {
    uint32_t triangle_count;
    uint32_t opaque; /* 1; 0: the filter decides which of its hits count */
    uint32_t zero[2];
};

struct raydiff_engine_world_mesh {
    struct raydiff_engine_mesh mesh;
    const struct raydiff_engine_geometry *geometry;
    uint32_t geometry_count;
};

struct raydiff_engine_instance {
    uint32_t mesh; /* RAYDIFF_ENGINE_NONE: none */
    uint32_t custom, mask, flags;
    float transform[12]; /* three rows of four: the matrix, and the translation in column 3 */
};

struct raydiff_engine_world {
    const struct raydiff_engine_world_mesh *mesh;
    const struct raydiff_engine_instance *instance;
    uint32_t mesh_count, instance_count;
    uint32_t filter_kind; /* 0 all, 1 none, 2 triangles, 3 cells: docs/formats.md */
    uint32_t filter_seed, filter_share;
};

struct raydiff_engine_world_ray {
    struct raydiff_engine_ray ray;
    uint32_t mask, flags;
};

/* A miss has the instance RAYDIFF_ENGINE_NONE and 0 in the four words behind it. */
struct raydiff_engine_world_hit {
    float t, u, v;
    uint32_t instance;
    uint32_t geometry; /* of the instance's mesh */
    uint32_t triangle; /* of the geometry */
    uint32_t side;     /* 1 the front, 0 the back */
    uint32_t custom;   /* of the instance, or RAYDIFF_ENGINE_NONE: not kept */
};

/* --- what it promises and what it holds ------------------------------------------------------- */

enum raydiff_engine_formula {
    RAYDIFF_ENGINE_UNKNOWN = 0, /* judged by how far vertices must move to make an answer right */
    RAYDIFF_ENGINE_MT = 1,      /* Moeller and Trumbore; an answer is held to the formula's proven
                                   bound, from here on */
    RAYDIFF_ENGINE_WOOP = 2,
    RAYDIFF_ENGINE_EMBREE = 3, /* its default mode */
    RAYDIFF_ENGINE_EMBREE_ROBUST = 4,
    RAYDIFF_ENGINE_PLUECKER = 5,
    RAYDIFF_ENGINE_BALDWIN_WEBBER = 6,
    RAYDIFF_ENGINE_TRI_ACCEL = 7 /* Wald 2004 */
};

enum raydiff_engine_rounding {
    RAYDIFF_ENGINE_IEEE = 0,
    RAYDIFF_ENGINE_FLUSHED = 1, /* IEEE, subnormals become 0 */
    RAYDIFF_ENGINE_VULKAN = 2,
    RAYDIFF_ENGINE_VULKAN_RTE = 3,
    RAYDIFF_ENGINE_EMBREE_ESTIMATES = 4 /* reciprocals by an estimate and one Newton step */
};

#define RAYDIFF_ENGINE_OPEN_RANGE 1u /* hits have tmin < t < tmax */
#define RAYDIFF_ENGINE_WATERTIGHT 2u /* no ray passes between triangles that share an edge */
#define RAYDIFF_ENGINE_UNNAMED    4u /* an any-hit names no triangle: any number that is no miss */

struct raydiff_engine_model {
    uint32_t formula, rounding; /* enum raydiff_engine_formula, raydiff_engine_rounding */
    uint32_t flags;             /* RAYDIFF_ENGINE_OPEN_RANGE, ... */
    /* UNKNOWN only: an own bound, how far vertices move at most, in 2^-24 of their distance; above
     * 0, at most 2^13, which is what half precision rounds by. 0: raydiff's own, 32. Another one
     * is told with the results. */
    float displacement;
};

/* What is held after the last build or trace. 0: not known, and shown as '-'. */
struct raydiff_engine_memory {
    uint64_t tree_bytes;  /* nodes */
    uint64_t scene_bytes; /* triangles, in whatever form it reads them */
    uint64_t other_bytes; /* buffers and the like */
};

/* --- the table -------------------------------------------------------------------------------- */

struct raydiff_engine {
    uint32_t version;    /* RAYDIFF_ENGINE_VERSION */
    uint32_t bytes;      /* sizeof(struct raydiff_engine) */
    const char *name;    /* a letter, then letters, digits and _, at most 31 in all */
    const char *summary; /* one line, or NULL */
    uint32_t can;        /* RAYDIFF_ENGINE_CLOSEST, ...: CLOSEST or WORLDS at least */
    uint32_t zero;

    /* Makes a tracer without a scene. */
    int (*open)(const struct raydiff_engine_options *options, void **self, char *reason);
    void (*close)(void *self);

    /* Takes a scene in place of the one before. No triangles are a scene, too. */
    int (*build)(void *self, const struct raydiff_engine_mesh *mesh, char *reason);
    /* Traces `count` rays, 0 included. */
    int (*trace)(void *self, const struct raydiff_engine_ray *ray, size_t count, uint32_t query,
                 struct raydiff_engine_hit *hit, char *reason);
    /* The hits of ray i are hit[i * capacity ..], unordered; hit_count[i] is their full number,
     * also if that is over `capacity`: then the ray is asked for again with more room. A triangle
     * is listed once; a number over twice the triangles ends the tracer. */
    int (*trace_all)(void *self, const struct raydiff_engine_ray *ray, size_t count,
                     uint32_t capacity, struct raydiff_engine_hit *hit, uint32_t *hit_count,
                     char *reason);

    int (*build_world)(void *self, const struct raydiff_engine_world *world, char *reason);
    int (*trace_world)(void *self, const struct raydiff_engine_world_ray *ray, size_t count,
                       uint32_t query, struct raydiff_engine_world_hit *hit, char *reason);

    /* Rays of scenes in a form of its own. rays_trace is timed; of rays_make and hits_read together
     * only what takes longer than half of it: they convert, and do not trace. rays_trace may be
     * called several times for the same rays. With NATIVE `trace` is still needed: it is
     * what runs in a process of its own, with the same answers. */
    int (*rays_make)(void *self, const struct raydiff_engine_ray *ray, size_t count, uint32_t query,
                     void **rays, char *reason);
    int (*rays_trace)(void *self, void *rays, char *reason);
    void (*hits_read)(void *self, const void *rays, struct raydiff_engine_hit *hit);
    void (*rays_free)(void *self, void *rays);

    /* Describe an opened tracer. NULL: all 0. *out is 0 before the call. */
    void (*model)(void *self, struct raydiff_engine_model *out);
    void (*memory)(void *self, struct raydiff_engine_memory *out);

    /* With MOVE. Called after a build or move that returned OK, in place of a build: the vertices
     * have moved; numbers of vertices and triangles are the same, and so is each index. The arrays
     * of the mesh before are no longer valid. It may refit what it has, or build anew. With all but
     * OK it holds no scene. */
    int (*move)(void *self, const struct raydiff_engine_mesh *mesh, char *reason);
};

/* The function that the shared object exports. The table is valid as long as the object is
 * loaded. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const struct raydiff_engine *
raydiff_engine(void);

#ifdef __cplusplus
}
#endif

#endif
