/* The memory that a traversal reads for a ray, as lines of a simulated cache. */
#ifndef TOUCH_H
#define TOUCH_H

#include "bench/measure/cache_sim.h"
#include "ref/dual/dual.h"
#include "ref/engine.h"
#include "ref/fast/fast.h"
#include "ref/kd/kd.h"
#include "ref/store.h"

enum touch_array {
    TOUCH_NODES,
    TOUCH_ITEMS,    /* the words of the storage */
    TOUCH_INDICES,  /* of the scene's triangles, 12 bytes each */
    TOUCH_VERTICES, /* of the scene, 12 bytes each, or 36 bytes a triangle */
    TOUCH_ARRAYS
};

/* Receives a read of `bytes` bytes from `offset` of an array. */
typedef void touch_read_fn(void *reader, enum touch_array array, uint64_t offset, uint64_t bytes);

/* A packed tree whose reads are recorded. Owns `leaf`: free with touch_free. Nodes, items and the
 * scene's arrays have separate page-aligned addresses. */
struct touch {
    struct packed packed; /* the traced tree, with hooks instead of layout and storage */
    struct layout layout;
    struct tri_store store;
    const struct packed *real;
    const struct scene *scene;
    struct cache_sim *cache;
    touch_read_fn *read; /* called instead of the cache, with `reader`; NULL after touch_make */
    void *reader;
    /* Vertices are read as nine floats per triangle in the scene's order, as on the GPU, instead of
     * by index. */
    bool gathered;
    uint32_t *leaf; /* for storages that hold vertices: where leaves begin, sorted */
    size_t leaf_count;
};

/* Prepares recording of `packed`. Everything is borrowed; do not move *out.
 * `cache` may be NULL if `read` is set before anything is traced. Errors: STATUS_MEMORY. */
enum status touch_make(const struct packed *packed, const struct scene *scene, bool gathered,
                       struct cache_sim *cache, struct touch *out, struct reason *reason) MUST_USE;

/* Traces a ray like trace_ray and reads into the cache: the record of every visited node (for a
 * leaf without one its parent's, since it is decoded from there), and the item, index and vertices
 * of every tested triangle, or the whole leaf if the storage holds vertices. Errors: those of
 * trace_ray. */
enum status touch_ray(struct touch *touch, const struct job *job, const struct ray *ray,
                      struct hit *hit) MUST_USE;

/* Returns the record that decoding the node `ref` reads, of a packed tree that has nodes. *way: so
 * many records behind it are read as well. */
uint32_t touch_record(const struct packed *packed, uint32_t ref, uint32_t *way);

void touch_free(struct touch *touch);

/* The same for the tree of engine fast or fast_small, using fast_watched. */
void touch_fast(const struct fast_tree *tree, const struct ray *ray, bool any,
                struct cache_sim *cache, struct hit *hit);

/* The same for the tree of engine kd, nearest hits. */
void touch_kd(const struct kd_tree *tree, const struct ray *ray, struct cache_sim *cache,
              struct hit *hit);

/* The same for the tree of engine dual_split that was made of the packed tree `touch` records, for
 * job->tri, nearest hits. */
void touch_dual(struct touch *touch, const struct dual_tree *tree, const struct job *job,
                const struct ray *ray, struct hit *hit);

#endif
