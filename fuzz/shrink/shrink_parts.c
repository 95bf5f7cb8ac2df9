/* Passes that leave things out: rays, triangles, vertices. */
#include "fuzz/shrink/shrink_inner.h"

#include <stdlib.h>
#include <string.h>

static uint32_t ray_count(const struct fuzz_trial *trial)
{
    return trial->ray_count;
}

static uint32_t tri_count(const struct fuzz_trial *trial)
{
    return trial->scene.tri_count;
}

/* What is left of `count` things of `size` bytes if [first, first + removed) goes; with `keep`
 * that alone stays. */
static uint32_t cut(void *array, uint32_t count, size_t size, uint32_t first, uint32_t removed,
                    bool keep)
{
    char *bytes = array;
    uint32_t behind = count - first - removed;
    if (keep) {
        memmove(bytes, bytes + first * size, removed * size);
        return removed;
    }
    memmove(bytes + first * size, bytes + (first + removed) * size, behind * size);
    return count - removed;
}

enum { KEEP, REMOVE, CUTS };

static bool cut_rays(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    if (trial->world.is)
        cut(trial->world.mode, trial->ray_count, sizeof *trial->world.mode, first, count,
            variant == KEEP);
    trial->ray_count =
        cut(trial->ray, trial->ray_count, sizeof *trial->ray, first, count, variant == KEEP);
    return true;
}

/* With fewer triangles the same may need smaller leaves or another builder: what it needs is a tree
 * of some depth, mostly. */
enum { LEAF_LESS, LEAF_ONE, FIRST_BUILDER, SECOND_BUILDER, TREES };

static bool change_tree(struct fuzz_trial *trial, uint32_t how)
{
    if (how == LEAF_LESS)
        trial->build.leaf -= trial->build.leaf > 1;
    else if (how == LEAF_ONE)
        trial->build.leaf = 1;
    else
        trial->builder = builders[how - FIRST_BUILDER];
    return trial->builder != NULL;
}

/* Removes vertices that no triangle has; the others keep their order. */
static void drop_unused(struct fuzz_trial *trial)
{
    struct scene *scene = &trial->scene;
    uint32_t *to = alloc_zeroed(scene->vertex_count, sizeof *to), used = 0;
    if (!to)
        return; /* they stay: nothing depends on it */
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++)
        to[scene->index[i]] = 1;
    for (uint32_t i = 0; i < scene->vertex_count; i++)
        if (to[i]) {
            memmove(scene->vertex + 3 * (size_t)used, scene->vertex + 3 * (size_t)i, 12);
            to[i] = used++;
        }
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++)
        scene->index[i] = to[scene->index[i]];
    scene->vertex_count = used;
    free(to);
}

static bool cut_triangles(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                          uint32_t variant)
{
    struct scene *scene = &trial->scene;
    scene->tri_count = cut(scene->index, scene->tri_count, 3 * sizeof *scene->index, first, count,
                           variant == KEEP);
    shrink_cut_geometries(&trial->world, first, count, variant == KEEP);
    drop_unused(trial);
    return true;
}

void shrink_cut_triangles(struct fuzz_trial *trial, uint32_t first, uint32_t count)
{
    cut_triangles(trial, first, count, REMOVE);
}

static bool cut_and_change(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                           uint32_t variant)
{
    return change_tree(trial, variant / CUTS) && cut_triangles(trial, first, count, variant % CUTS);
}

/* Numbers vertices in the order in which triangles name them. */
static void renumber(struct fuzz_trial *trial)
{
    struct scene *scene = &trial->scene;
    uint32_t *to = alloc_zeroed(scene->vertex_count, sizeof *to), used = 0;
    float *vertex = alloc_zeroed(scene->vertex_count, 12);
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count && to && vertex; i++) {
        uint32_t *corner = &scene->index[i];
        if (to[*corner] == 0) { /* holds one more */
            memcpy(vertex + 3 * (size_t)used, scene->vertex + 3 * (size_t)*corner, 12);
            to[*corner] = ++used;
        }
        *corner = to[*corner] - 1;
    }
    if (to && vertex) {
        memcpy(scene->vertex, vertex, 12 * (size_t)used);
        scene->vertex_count = used;
    }
    free(to);
    free(vertex);
}

enum { UNUSED, RENUMBER, TIDINGS };

static bool tidy_vertices(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                          uint32_t variant)
{
    (void)first, (void)count;
    if (variant == UNUSED)
        drop_unused(trial);
    else
        renumber(trial);
    return true;
}

/* Any two of few triangles: a builder that halves their number may need both removed. */
#define PAIRED_TRIANGLES 32u

static uint32_t triangle_pairs(const struct fuzz_trial *trial)
{
    uint32_t n = trial->scene.tri_count;
    return n <= PAIRED_TRIANGLES ? n * n : 0;
}

static bool cut_two(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    uint32_t n = trial->scene.tri_count, low = first / n, high = first % n;
    if (low >= high)
        return false;
    (void)variant;
    return cut_triangles(trial, high, count, REMOVE) && cut_triangles(trial, low, count, REMOVE);
}

/* A chunk of triangles becomes the triangle before or behind it: if only their number matters,
 * equal ones are easier to read. */
static bool repeat_triangle(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                            uint32_t variant)
{
    struct scene *scene = &trial->scene;
    uint32_t behind = first + count, from = variant == 0 ? first - 1 : behind;
    if (variant == 0 ? first == 0 : behind >= scene->tri_count)
        from = variant == 0 ? first : behind - 1; /* the chunk's own first or last */
    uint32_t corner[3];
    memcpy(corner, scene->index + 3 * (size_t)from, sizeof corner);
    for (uint32_t i = first; i < behind; i++)
        memcpy(scene->index + 3 * (size_t)i, corner, sizeof corner);
    drop_unused(trial);
    return true;
}

/* Pairs of vertices: beyond this many there are too many to try. */
#define PAIRED_MOST 256u

static uint32_t pair_count(const struct fuzz_trial *trial)
{
    uint32_t n = trial->scene.vertex_count;
    return n <= PAIRED_MOST ? n * n : 0;
}

/* Vertex j becomes vertex i. */
static bool merge_vertices(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                           uint32_t variant)
{
    struct scene *scene = &trial->scene;
    uint32_t n = scene->vertex_count, i = first % n, j = first / n;
    (void)count, (void)variant;
    if (i == j)
        return false;
    for (size_t k = 0; k < 3 * (size_t)scene->tri_count; k++)
        if (scene->index[k] == j)
            scene->index[k] = i;
    drop_unused(trial);
    return true;
}

const struct shrink_pass shrink_rays = {"rays", SHRINK_CHUNKS, ray_count, CUTS, cut_rays};
const struct shrink_pass shrink_ends = {"ends", SHRINK_ENDS, tri_count, CUTS, cut_triangles};
const struct shrink_pass shrink_triangles = {"triangles", SHRINK_CHUNKS, tri_count, CUTS,
                                             cut_triangles};
const struct shrink_pass shrink_trees = {"trees", SHRINK_CHUNKS, tri_count, CUTS *TREES,
                                         cut_and_change};
const struct shrink_pass shrink_pairs = {"pairs", SHRINK_SINGLY, triangle_pairs, 1, cut_two};
const struct shrink_pass shrink_repeat = {"repeat", SHRINK_CHUNKS, tri_count, 2, repeat_triangle};
const struct shrink_pass shrink_tidy = {"tidy", SHRINK_SINGLY, shrink_one, TIDINGS, tidy_vertices};
const struct shrink_pass shrink_merge = {"merge", SHRINK_SINGLY, pair_count, 1, merge_vertices};
