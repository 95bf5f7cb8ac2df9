#include "ref/build/presplit.h"

#include "ref/build/room.h"

#include <math.h>
#include <string.h>

/* Planes lie at multiples of 2^-GRID_BITS of the longest side of the scene's box. */
#define GRID_BITS 30u
#define NO_LEVEL  GRID_BITS

/* The scale is a float of so many bits, without sign: more would hardly change a budget. */
#define SCALE_LOWEST 0x800u

struct plane_grid {
    float lo[3];
    double side; /* of the cube that has all triangles; 0: there are no planes */
};

/* A plane, and how coarse the grid is that has it; NO_LEVEL: none. */
struct plane {
    int axis;
    uint32_t level;
    float at;
};

static struct plane_grid grid_of(const struct scene *scene)
{
    struct box all = box_empty();
    struct plane_grid grid = {.side = 0};
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        struct box one = scene_tri_bounds(scene, i);
        box_add_box(&all, &one);
    }
    for (int k = 0; k < 3; k++) {
        double side = (double)all.hi[k] - (double)all.lo[k];
        grid.lo[k] = all.lo[k];
        grid.side = side > grid.side ? side : grid.side;
    }
    return grid;
}

/* The coarsest plane between two coordinates, neither included. */
static struct plane plane_between(const struct plane_grid *grid, int axis, float lo, float hi)
{
    const double cells = (double)(1u << GRID_BITS), unit = grid->side / cells;
    struct plane plane = {.axis = axis, .level = NO_LEVEL};
    double from = ((double)lo - (double)grid->lo[axis]) / unit;
    double to = ((double)hi - (double)grid->lo[axis]) / unit;
    if (!(lo < hi && unit > 0 && from >= 0 && to <= cells))
        return plane;
    uint32_t below = (uint32_t)from, last = (uint32_t)to;
    if ((double)last == to) /* a plane at the upper end is none between */
        last--;
    if (last <= below)
        return plane;
    uint32_t bit = 31 - (uint32_t)__builtin_clz(below ^ last);
    plane.at = (float)((double)grid->lo[axis] + unit * (double)(last >> bit << bit));
    if (lo < plane.at && plane.at < hi)
        plane.level = GRID_BITS - 1 - bit;
    return plane;
}

/* The coarsest plane that cuts a box; among equally coarse ones that across the longest side. */
static struct plane plane_of(const struct plane_grid *grid, const struct box *box)
{
    struct plane best = {.level = NO_LEVEL};
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        struct plane plane = plane_between(grid, k, box->lo[k], box->hi[k]);
        double side = (double)box->hi[k] - (double)box->lo[k];
        if (plane.level < best.level || (plane.level == best.level && side > longest)) {
            best = plane;
            longest = side;
        }
    }
    return best;
}

/* The cube root of a positive number, by Newton's method from at most 1/8 beside it. */
static double cube_root(double x)
{
    int exponent, thirds;
    double m = frexp(x, &exponent);
    thirds = (exponent > 0 ? exponent + 2 : exponent) / 3;
    m = ldexp(m, exponent - 3 * thirds); /* from 1/8 to 1 */
    double y = 0.5 + 0.5 * m;
    for (int i = 0; i < 5; i++)
        y = (y + y + m / (y * y)) / 3;
    return ldexp(y, thirds);
}

/* Half the area of the boxes of infinitely many parts: those of its shadows on three planes. */
static double ideal_half_area(float v[3][3])
{
    double a[3], b[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        a[k] = (double)v[1][k] - (double)v[0][k];
        b[k] = (double)v[2][k] - (double)v[0][k];
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        sum += fabs(a[i] * b[j] - a[j] * b[i]);
    }
    return 0.5 * sum;
}

/* 0 if nothing cuts the triangle or nothing would be saved. */
static double priority_of(const struct plane_grid *grid, const struct scene *scene, uint32_t prim)
{
    float v[3][3];
    struct box box = scene_tri_bounds(scene, prim);
    struct plane plane = plane_of(grid, &box);
    if (plane.level == NO_LEVEL)
        return 0;
    scene_tri(scene, prim, v);
    double spare = (box_half_area(&box) - ideal_half_area(v)) / grid->side / grid->side;
    return spare > 0 && spare < INFINITY ? cube_root(ldexp(spare, -(int)plane.level)) : 0;
}

/* Cuts of a triangle; more than the budget count as one more than that. */
static uint32_t cuts_of(double priority, float scale, uint32_t budget)
{
    double cuts = priority * (double)scale;
    return cuts < (double)budget + 1 ? (uint32_t)cuts : budget + 1;
}

static uint64_t cuts_of_all(const double *priority, uint32_t count, float scale, uint32_t budget,
                            uint32_t threads)
{
    uint64_t sum = 0;
#pragma omp parallel for schedule(static) reduction(+ : sum) num_threads(threads) if (threads > 1)
    for (uint32_t i = 0; i < count; i++)
        sum += cuts_of(priority[i], scale, budget);
    return sum;
}

/* The largest scale that keeps the budget, by bits: positive floats are ordered as their bits. */
static float scale_of(const double *priority, uint32_t count, uint32_t budget, uint32_t threads)
{
    uint32_t bits = 0;
    for (uint32_t bit = 0x40000000u; bit >= SCALE_LOWEST; bit >>= 1) {
        float scale = float_from_bits(bits | bit);
        if (scale < INFINITY &&
            cuts_of_all(priority, count, scale, budget, threads) <= (uint64_t)budget)
            bits |= bit;
    }
    return float_from_bits(bits);
}

static double longest_side(const struct box *box)
{
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, (double)box->hi[k] - (double)box->lo[k]);
    return longest;
}

/* Cuts a part so many times, and writes what it becomes; returns how many parts these are. No
 * deeper than the grid has levels in three axes, because each plane is finer than those before. */
static uint32_t cut_often(const struct plane_grid *grid, float v[3][3], const struct part *part,
                          uint32_t cuts, struct part *out)
{
    struct part piece[2];
    struct plane plane = {.level = NO_LEVEL};
    if (cuts > 0)
        plane = plane_of(grid, &part->box);
    int sides = plane.level < NO_LEVEL ? part_cut(v, part, plane.axis, plane.at, piece) : 0;
    if (sides == 0) {
        *out = *part;
        return 1;
    }
    if (sides < 3)
        return cut_often(grid, v, &piece[sides - 1], cuts, out);
    double side = longest_side(&piece[0].box), both = side + longest_side(&piece[1].box);
    double share = both > 0 ? side / both : 0.5;
    uint32_t first = (uint32_t)((double)(cuts - 1) * share + 0.5);
    uint32_t made = cut_often(grid, v, &piece[0], first, out);
    return made + cut_often(grid, v, &piece[1], cuts - 1 - first, out + made);
}

/* Writes the parts of triangle i from first[i] on, and moves them together. Returns how many there
 * are; first[i + 1] - first[i] is the room for those of triangle i. */
static uint32_t cut_all(const struct scene *scene, const struct plane_grid *grid,
                        const uint32_t *first, uint32_t *made, uint32_t threads, struct part *part)
{
    uint32_t all = 0, count = scene->tri_count;
#pragma omp parallel for schedule(dynamic, 256) num_threads(threads) if (threads > 1)
    for (uint32_t i = 0; i < count; i++) {
        const struct part whole = {scene_tri_bounds(scene, i), i};
        float v[3][3];
        scene_tri(scene, i, v);
        made[i] = cut_often(grid, v, &whole, first[i + 1] - first[i] - 1, part + first[i]);
    }
    for (uint32_t i = 0; i < count; i++) {
        memmove(part + all, part + first[i], made[i] * sizeof *part);
        all += made[i];
    }
    return all;
}

double presplit_most(uint32_t tri_count, const struct build_options *options)
{
    double share = (double)options->presplit;
    share = share > 0 ? fmin(share, (double)BUILD_PRESPLIT_MOST) : 0;
    return (double)tri_count + floor(share * (double)tri_count);
}

/* Sets first[i] to the triangles before i and their cuts. Errors: STATUS_MEMORY. */
static enum status room_for_each(const struct scene *scene, const struct plane_grid *grid,
                                 uint32_t budget, uint32_t threads, uint32_t *first)
{
    uint32_t count = scene->tri_count;
    double *priority = room_make(count, sizeof *priority);
    if (!priority)
        return STATUS_MEMORY;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (uint32_t i = 0; i < count; i++)
        priority[i] = priority_of(grid, scene, i);
    float scale = scale_of(priority, count, budget, threads);
    first[0] = 0;
    for (uint32_t i = 0; i < count; i++)
        first[i + 1] = first[i] + 1 + cuts_of(priority[i], scale, budget);
    room_free(priority);
    return STATUS_OK;
}

enum status presplit_make(const struct scene *scene, const struct build_options *options,
                          uint32_t threads, struct part **out, uint32_t *count,
                          struct reason *reason)
{
    double most = presplit_most(scene->tri_count, options);
    *out = NULL;
    *count = 0;
    if (most > (double)((uint32_t)1 << 31))
        return fail(reason, STATUS_LIMIT,
                    "a tree holds at most 2^31 items, %u triangles and %.0f more are asked for; "
                    "use a smaller --presplit",
                    scene->tri_count, most - (double)scene->tri_count);
    struct plane_grid grid = grid_of(scene);
    uint32_t *first = room_make((size_t)scene->tri_count + 1, sizeof *first);
    uint32_t *made = room_make(scene->tri_count, sizeof *made);
    struct part *part = room_make((size_t)most, sizeof *part);
    enum status status = STATUS_MEMORY;
    if (first && made && part)
        status = room_for_each(scene, &grid, (uint32_t)most - scene->tri_count, threads, first);
    if (!status)
        *count = cut_all(scene, &grid, first, made, threads, part);
    room_free(first);
    room_free(made);
    if (status)
        room_free(part);
    else
        *out = part;
    return status;
}

/* --- afterwards ------------------------------------------------------------------------------- */

#define SEVERAL UINT32_MAX

/* Sets only[i] to the triangle that is alone below node i, or SEVERAL, and end[i] to the node
 * behind its subtree. */
static void find_alone(const struct bvh *bvh, uint32_t *only, uint32_t *end)
{
    for (uint32_t i = bvh->node_count; i-- > 0;) {
        const struct bvh_node *node = &bvh->node[i];
        if (node->item_count == 0) {
            only[i] = only[node->fst] == only[node->snd] ? only[node->fst] : SEVERAL;
            end[i] = end[node->snd];
            continue;
        }
        const uint32_t *prim = bvh->prim + node->item_first;
        only[i] = prim[0];
        for (uint32_t k = 1; k < node->item_count; k++)
            only[i] = prim[k] == prim[0] ? only[i] : SEVERAL;
        end[i] = i + 1;
    }
}

/* Writes a leaf over the tree, with one triangle or those that it lists. */
static void write_leaf(struct bvh *bvh, const struct bvh_node *from, uint32_t at, uint32_t only,
                       uint32_t *seen, uint32_t *items)
{
    struct bvh_node leaf = {.bounds = from->bounds, .item_first = *items};
    if (only != SEVERAL) {
        bvh->prim[(*items)++] = only;
    } else {
        for (uint32_t k = 0; k < from->item_count; k++) {
            uint32_t prim = bvh->prim[from->item_first + k];
            if (seen[prim] != at + 1)
                bvh->prim[(*items)++] = prim;
            seen[prim] = at + 1;
        }
    }
    leaf.item_count = *items - leaf.item_first;
    bvh->node[at] = leaf;
}

/* Writes the remaining nodes and items over the tree; only[i] becomes node i's new index. */
static void write_merged(struct bvh *bvh, uint32_t *only, const uint32_t *end, uint32_t *seen)
{
    uint32_t count = 0, items = 0;
    for (uint32_t i = 0; i < bvh->node_count;) {
        struct bvh_node node = bvh->node[i];
        uint32_t alone = only[i], next = alone == SEVERAL ? i + 1 : end[i];
        only[i] = count;
        if (alone != SEVERAL || node.item_count > 0) {
            write_leaf(bvh, &node, count, alone, seen, &items);
        } else {
            node.item_first = items;
            bvh->node[count] = node;
        }
        count++;
        i = next;
    }
    for (uint32_t i = 0; i < count; i++) {
        struct bvh_node *node = &bvh->node[i];
        node->fst = node->item_count ? 0 : i + 1;
        node->snd = node->item_count ? 0 : only[node->snd];
    }
    bvh->node_count = count;
    bvh->prim_count = items;
}

enum status presplit_merge(struct bvh *bvh, uint32_t tri_count)
{
    uint32_t *only = room_make(bvh->node_count, sizeof *only);
    uint32_t *end = room_make(bvh->node_count, sizeof *end);
    uint32_t *seen = room_make(tri_count, sizeof *seen);
    bool enough = only && end && seen;
    if (enough) {
        memset(seen, 0, tri_count * sizeof *seen);
        find_alone(bvh, only, end);
        write_merged(bvh, only, end, seen);
        bvh->tri_count = tri_count;
    }
    room_free(only);
    room_free(end);
    room_free(seen);
    return enough ? STATUS_OK : STATUS_MEMORY;
}
