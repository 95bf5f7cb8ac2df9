#include "ref/dump/dump_instances.h"

#include "ref/dump/dump_check.h"
#include "ref/world/placed.h"

#include <math.h>
#include <stdlib.h>

static const struct scene *mesh_of(const struct tree_dump *dump, uint32_t item)
{
    return &dump->below[dump->instance[item].below].scene;
}

/* --- the least box ---------------------------------------------------------------------------- */

static struct box least_box(const struct tree_dump *dump, uint32_t item)
{
    const struct dump_instance *instance = &dump->instance[item];
    const struct scene *mesh = mesh_of(dump, item);
    struct box box = box_empty();
    for (size_t i = 0; i < mesh->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            placed_grow(instance->m[k], mesh->vertex + 3 * i, &box.lo[k], &box.hi[k]);
    for (int k = 0; k < 3 && mesh->vertex_count == 0; k++)
        box.lo[k] = box.hi[k] = instance->m[k][3];
    return box;
}

/* Three corners that reach all sides. */
static void put_corners(const struct box *box, float v[9])
{
    for (int k = 0; k < 3; k++) {
        v[k] = box->lo[k];
        v[3 + k] = k == 2 ? box->lo[k] : box->hi[k];
        v[6 + k] = k == 0 ? box->lo[k] : box->hi[k];
    }
}

enum status dump_place(struct tree_dump *dump, struct reason *reason)
{
    const uint32_t count = dump->tri_count;
    bool whole = count > 0 && count <= UINT32_MAX / 3;
    for (uint32_t i = 0; i < count; i++)
        whole = whole && dump->instance[i].below != DUMP_NO_TREE;
    if (!whole)
        return STATUS_OK;
    if (scene_make(3 * count, count, &dump->scene))
        return fail(reason, STATUS_MEMORY, "no memory for the boxes of %u instances", count);
#pragma omp parallel for schedule(dynamic, 16) if (count > 16)
    for (long long i = 0; i < (long long)count; i++) {
        const struct box box = least_box(dump, (uint32_t)i);
        put_corners(&box, dump->scene.vertex + 9 * i);
    }
    for (size_t i = 0; i < 3 * (size_t)count; i++)
        dump->scene.index[i] = (uint32_t)i;
    for (size_t i = 0; i < 9 * (size_t)count; i++)
        whole = whole && float_is_finite(dump->scene.vertex[i]);
    if (!whole)
        scene_free(&dump->scene);
    return STATUS_OK;
}

/* --- what boxes lack -------------------------------------------------------------------------- */

static float bound_of(const struct box *box, unsigned side)
{
    return side < 3 ? box->lo[side] : box->hi[side - 3];
}

/* The vertex that reaches furthest, or NULL if none reaches beyond the bound; *lacks, in units of
 * 2^*exponent, by how far it does. */
static const float *furthest(const struct scene *mesh, const float row[4], unsigned side,
                             float bound, struct oracle_wide *lacks, int *exponent)
{
    const float *found = NULL;
    struct fraction most = {0}, one = {0};
    wide_set(1, &one.den);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const float *vertex = mesh->vertex + 3 * i;
        if (placed_compare(row, vertex, bound) * (side < 3 ? -1 : 1) <= 0)
            continue;
        placed_difference(row, vertex, bound, &one.num, &one.scale);
        one.num.sign = 1;
        if (found && fraction_compare(&one, &most) <= 0)
            continue;
        found = vertex;
        most = one;
    }
    *lacks = most.num;
    *exponent = most.scale;
    return found;
}

/* The sum of the sizes that the bound is made of. */
static void size_of(const struct scene *mesh, const float row[4], struct oracle_wide *out,
                    int *exponent)
{
    float sizes[4], most[3] = {0, 0, 0};
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
        most[i % 3] = fmaxf(most[i % 3], fabsf(mesh->vertex[i]));
    for (int k = 0; k < 4; k++)
        sizes[k] = fabsf(row[k]);
    placed_difference(sizes, most, 0, out, exponent);
}

/* Measures a side. Returns whether it lacks something. */
static bool measure_side(const struct tree_dump *dump, uint32_t item, unsigned side, float bound,
                         struct dump_lack *out)
{
    const float *row = dump->instance[item].m[side % 3];
    const struct box needs = scene_tri_bounds(&dump->scene, item);
    struct fraction *exact = &out->exact, whole = {0};
    int exponent, size_exponent;
    double low, high;
    if (isnan(bound) || isinf(bound) ||
        !furthest(mesh_of(dump, item), row, side, bound, &exact->num, &exponent))
        return false;
    size_of(mesh_of(dump, item), row, &exact->den, &size_exponent);
    if (exact->den.sign == 0) {
        wide_set(1, &exact->den);
        size_exponent = -149;
    }
    exact->scale = exponent - size_exponent + 24;
    fraction_enclose(exact, &low, &high);
    out->u = low + (high - low) / 2;
    whole.num = exact->num;
    wide_set(1, &whole.den);
    whole.scale = exponent;
    fraction_enclose(&whole, &low, &high);
    out->lacks = low + (high - low) / 2;
    out->item = item;
    out->side = side;
    out->bound = bound;
    out->steps = dump_steps(bound, bound_of(&needs, side));
    return true;
}

static enum status measure_box(const struct tree_dump *dump, uint32_t item, const struct box *box,
                               size_t *capacity, struct dump_lacks *out)
{
    struct dump_lack lack;
    const uint32_t before = out->sides;
    out->judged += mesh_of(dump, item)->vertex_count > 0;
    for (unsigned side = 0; side < 6; side++) {
        if (!measure_side(dump, item, side, bound_of(box, side), &lack))
            continue;
        if (array_reserve(&out->side, capacity, (size_t)out->sides + 1, sizeof *out->side))
            return STATUS_MEMORY;
        out->side[out->sides] = (struct dump_side){item, side, lack.bound};
        if (out->sides++ == 0 || fraction_compare(&lack.exact, &out->most.exact) > 0)
            out->most = lack;
        if (lack.steps > out->most_steps)
            out->most_steps = lack.steps;
    }
    out->small += out->sides > before;
    return STATUS_OK;
}

/* Only leaves that a box leads to have a box. */
enum status dump_measure(const struct tree_dump *dump, struct dump_lacks *out,
                         struct reason *reason)
{
    bool *led = alloc_zeroed(dump->node_count, sizeof *led);
    size_t capacity = 0;
    enum status status = led ? STATUS_OK : STATUS_MEMORY;
    *out = (struct dump_lacks){0};
    for (size_t i = 0; i < dump->child_count && !status; i++)
        if (dump->child[i] < dump->node_count)
            led[dump->child[i]] = true;
    for (size_t i = 0; i < dump->node_count && !status; i++) {
        const struct dump_node *node = &dump->node[i];
        if (led[i] && node->leaf && node->count == 1)
            status = measure_box(dump, dump->item[node->first], &node->box, &capacity, out);
    }
    free(led);
    if (!status)
        return STATUS_OK;
    free(out->side);
    *out = (struct dump_lacks){0};
    return fail(reason, status, "no memory to measure %zu boxes", dump->node_count);
}
