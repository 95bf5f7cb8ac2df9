#include "ref/fast/careful.h"

#include "ref/fast/block.h"
#include "ref/fast/small_tree.h"

static void tell(const struct careful *way, const void *at, size_t bytes)
{
    if (way->read)
        way->read(way->reader, at, bytes);
}

/* A child of a node, of either form of tree. */
struct careful_child {
    uint32_t ref; /* 0: none */
    struct box box;
};

static struct careful_child child_of(const struct fast_tree *tree, uint32_t node, uint32_t i)
{
    const struct fast_node *from = tree->small ? NULL : &tree->node[node];
    const struct fast_small_node *small = tree->small ? &tree->small[node] : NULL;
    struct careful_child child = {0};
    if (from)
        child.ref = from->ref[i];
    else if (i < small_children(small))
        child.ref = small_ref(small, i);
    for (int k = 0; k < 3 && child.ref; k++) {
        const double lo = (double)tree->lo[k], step = (double)tree->step[k];
        const uint32_t lower = from ? from->bound[0][k][i] : small_code(small, 0, k, i);
        const uint32_t upper = from ? from->bound[1][k][i] : small_code(small, 1, k, i);
        child.box.lo[k] = (float)(lo + step * lower);
        child.box.hi[k] = (float)(lo + step * upper);
    }
    return child;
}

/* Returns true if the ray ends at the hit. */
static bool take(struct careful *way, const struct hit *hit, uint32_t tag)
{
    if (way->query == QUERY_ALL) {
        if (way->found < way->capacity) {
            way->list[way->found] = *hit;
            if (way->tags)
                way->tags[way->found] = tag;
        }
        way->found++;
        return false;
    }
    way->best = *hit;
    way->tag = tag;
    way->tbest = hit->t;
    return way->query == QUERY_ANY;
}

static bool is_nearer(const struct careful *way, const struct hit *hit)
{
    return way->query == QUERY_ALL || way->best.prim == ABI_NO_PRIM || hit->t < way->best.t;
}

/* Returns true if the traversal is finished. */
static bool visit_small(struct careful *way, uint32_t ref)
{
    const uint32_t *block = way->tree->block + (ref & ~FAST_LEAF);
    const uint32_t numbers = small_row(*block, 3), width = small_prim_width(*block);
    tell(way, block, (numbers + 31) / 32 * sizeof *block);
    for (uint32_t i = 0; i < small_tris(*block); i++) {
        float v[3][3];
        struct hit hit;
        small_tri(block, i, v);
        if (!tri_test_run(ABI_TRI_WOOP, &way->tri, v, &hit) || !is_nearer(way, &hit))
            continue;
        hit.prim = small_prim(block, i);
        const uint32_t at = numbers + width * i, end = at + width;
        if (way->query != QUERY_ALL && end > at)
            tell(way, block + at / 32, ((end + 31) / 32 - at / 32) * sizeof *block);
        if (take(way, &hit, 0))
            return true;
    }
    return false;
}

/* Returns true if the traversal is finished. */
static bool visit_tiny(struct careful *way, uint32_t ref)
{
    const struct tiny_form *form = &way->tree->tiny;
    const uint32_t *block = way->tree->block + (ref & ~FAST_LEAF);
    const uint32_t gaps = tiny_row(form, *block, 3);
    tell(way, block, (gaps + 31) / 32 * sizeof *block);
    for (uint32_t i = 0; i < tiny_tris(*block); i++) {
        float v[3][3];
        struct hit hit;
        uint32_t end;
        tiny_tri(form, block, i, v);
        if (!tri_test_run(ABI_TRI_WOOP, &way->tri, v, &hit) || !is_nearer(way, &hit))
            continue;
        hit.prim = tiny_prim(form, block, i, &end);
        if (way->query != QUERY_ALL && end > gaps)
            tell(way, block + gaps / 32, ((end + 31) / 32 - gaps / 32) * sizeof *block);
        if (take(way, &hit, 0))
            return true;
    }
    return false;
}

/* Returns true if the traversal is finished. */
static bool visit_leaf(struct careful *way, uint32_t ref)
{
    if (way->tree->small)
        return way->tree->is_tiny ? visit_tiny(way, ref) : visit_small(way, ref);
    const uint32_t *word = way->tree->block + (ref & (FAST_LEAF_WORDS - 1));
    uint32_t vertices = (ref >> FAST_LEAF_COUNT & 15u) + 1;
    tell(way, word, (BLOCK_CORNERS + 3 * vertices) * sizeof *word);
    for (uint32_t i = 0; i < BLOCK_TRIS; i++) {
        float v[3][3];
        struct hit hit;
        uint32_t tag = 0;
        for (int c = 0; c < 3; c++)
            block_corner(word, vertices, i, c, v[c]);
        if (!tri_test_run(ABI_TRI_WOOP, &way->tri, v, &hit) || !is_nearer(way, &hit))
            continue;
        hit.prim = block_prim(word, vertices, i);
        if (way->in && !candidate_counts(way->in, way->tri.d, &hit, &tag))
            continue;
        if (way->query != QUERY_ALL)
            tell(way, &word[BLOCK_CORNERS + 3 * vertices + i], sizeof *word);
        if (take(way, &hit, tag))
            return true;
    }
    return false;
}

static void walk(struct careful *way)
{
    const struct fast_tree *tree = way->tree;
    uint32_t ref[FAST_STACK + FAST_WIDTH];
    float entry[FAST_STACK + FAST_WIDTH];
    uint32_t depth = 0;
    ref[depth] = 0;
    entry[depth++] = way->tbest;
    while (depth > 0) {
        uint32_t now = ref[--depth];
        if (entry[depth] > way->tbest)
            continue;
        if (now & FAST_LEAF) {
            if (way->leaf(way, now))
                return;
            continue;
        }
        const size_t bytes = fast_node_bytes(tree);
        const char *node = tree->small ? (const char *)tree->small : (const char *)tree->node;
        uint32_t base = depth;
        tell(way, node + bytes * now, bytes);
        for (uint32_t i = 0; i < FAST_WIDTH; i++) {
            const struct careful_child child = child_of(tree, now, i);
            float at;
            if (child.ref == 0 || !slab_watertight(&way->slab, &child.box, way->tbest, &at))
                continue;
            uint32_t place = depth++; /* nearest on top, as in the kernels */
            for (; place > base && entry[place - 1] < at; place--) {
                entry[place] = entry[place - 1];
                ref[place] = ref[place - 1];
            }
            entry[place] = at;
            ref[place] = child.ref;
        }
    }
}

void careful_walk(struct careful *way, const struct fast_tree *tree, const struct ray *ray)
{
    way->tree = tree;
    way->slab = slab_ray_make(ray);
    way->tri = tri_ray_make(ray);
    if (tree->node_count == 0)
        return;
    slab_ray_place(&way->slab, &tree->bounds);
    walk(way);
}

/* The best hit of a ray through one tree, or its list. */
static void trace(struct careful *way, const struct fast_tree *tree, const struct ray *ray,
                  enum query query)
{
    careful_start(way, ray, query);
    careful_walk(way, tree, ray);
}

void careful_start(struct careful *way, const struct ray *ray, enum query query)
{
    way->leaf = visit_leaf;
    way->query = query;
    way->best = (struct hit){.prim = ABI_NO_PRIM};
    way->tbest = ray->tmax;
}

void fast_careful(const struct fast_tree *tree, const struct ray *ray, bool any, struct hit *hit)
{
    struct careful way = {.list = NULL};
    trace(&way, tree, ray, any ? QUERY_ANY : QUERY_CLOSEST);
    *hit = way.best;
}

void fast_watched(const struct fast_tree *tree, const struct ray *ray, bool any, fast_read_fn *read,
                  void *reader, struct hit *hit)
{
    struct careful way = {.read = read, .reader = reader};
    trace(&way, tree, ray, any ? QUERY_ANY : QUERY_CLOSEST);
    *hit = way.best;
}

uint32_t fast_all(const struct fast_tree *tree, const struct ray *ray, uint32_t capacity,
                  struct hit *hit)
{
    struct careful way = {.list = hit, .capacity = capacity};
    trace(&way, tree, ray, QUERY_ALL);
    return way.found;
}
