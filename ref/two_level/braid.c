#include "ref/two_level/braid.h"

#include "ref/tree/subtree.h"
#include "ref/world/object_ray.h"
#include "ref/world/placed.h"

#include <math.h>
#include <stdlib.h>

/* What sums and products of doubles may lack, and the conversion to float. */
#define OUTWARD (1 + 0x1p-20)

struct braid_entry {
    struct world_part of;
    bool whole;               /* it cannot be opened: the last of all */
    double gain;              /* else braid_gain */
    struct box box, child[2]; /* of itself; of the children of its node, if it can be opened */
};

/* Entries that may be opened are a heap, the largest first, at the beginning of the array; those
 * that stay are at its end. */
struct braiding {
    const struct world *world;
    const struct bvh *bottom;
    struct box *mesh; /* the box of each mesh */
    bool of_vertices;
    struct braid_entry *entry;
    uint32_t room, open, stay;
    float share, reach;
};

/* --- the heap --------------------------------------------------------------------------------- */

static bool comes_first(const struct braid_entry *a, const struct braid_entry *b)
{
    if (a->whole != b->whole)
        return b->whole;
    if (a->gain != b->gain)
        return a->gain > b->gain;
    if (a->of.instance != b->of.instance)
        return a->of.instance < b->of.instance;
    return a->of.node < b->of.node;
}

static void heap_push(struct braiding *b, const struct braid_entry *entry)
{
    uint32_t at = b->open++;
    for (; at > 0 && comes_first(entry, &b->entry[(at - 1) / 2]); at = (at - 1) / 2)
        b->entry[at] = b->entry[(at - 1) / 2];
    b->entry[at] = *entry;
}

static struct braid_entry heap_pop(struct braiding *b)
{
    const struct braid_entry top = b->entry[0], last = b->entry[--b->open];
    uint32_t at = 0;
    for (uint32_t child; (child = 2 * at + 1) < b->open; at = child) {
        if (child + 1 < b->open && comes_first(&b->entry[child + 1], &b->entry[child]))
            child++;
        if (!comes_first(&b->entry[child], &last))
            break;
        b->entry[at] = b->entry[child];
    }
    if (b->open > 0)
        b->entry[at] = last;
    return top;
}

/* --- what may be opened ----------------------------------------------------------------------- */

static float rounded_up(double x)
{
    return nextafterf((float)(x * OUTWARD), INFINITY);
}

static double longest_side(const struct box *box)
{
    double side = 0;
    for (int k = 0; k < 3; k++)
        side = fmax(side, (double)box->hi[k] - (double)box->lo[k]);
    return side;
}

/* Sets K, N and the largest number of the inverse. Returns false if there is no inverse. */
static bool norms_of(const float m[3][4], double *kappa, double *norm, double *inverse)
{
    float w[9];
    *kappa = *norm = *inverse = 0;
    if (transform_inverse(m, w, NULL))
        return false;
    for (int i = 0; i < 3; i++) {
        double row = 0, product = 0;
        for (int j = 0; j < 3; j++) {
            row += fabs((double)m[i][j]);
            *inverse = fmax(*inverse, fabs((double)w[3 * i + j]));
            for (int k = 0; k < 3; k++)
                product += fabs((double)m[i][j] * (double)w[3 * j + k]);
        }
        *norm = fmax(*norm, row);
        *kappa = fmax(*kappa, product);
    }
    return true;
}

/* As braid_needs; `mesh` is the box of the instance's mesh. */
static bool needs_of(const struct instance *instance, const struct box *mesh, const struct box *box,
                     float *share, float *reach)
{
    double kappa, norm, inverse, far = 0;
    *share = *reach = 0;
    if (!norms_of(instance->m, &kappa, &norm, &inverse))
        return false;
    for (int k = 0; k < 3; k++) {
        far = fmax(far, fabs((double)instance->m[k][3]));
        far = fmax(far, fmax(fabs((double)box->lo[k]), fabs((double)box->hi[k])));
    }
    far = fmax(far, norm * longest_side(mesh));
    if (!(kappa <= BRAID_KAPPA_MOST && norm <= BRAID_LARGEST && inverse <= BRAID_LARGEST &&
          far <= BRAID_LARGEST && far >= BRAID_LEAST))
        return false;
    *share = rounded_up(BRAID_SHARE * kappa);
    *reach = rounded_up(far);
    return true;
}

bool braid_needs(const struct world *world, uint32_t instance, const struct box *box, float *share,
                 float *reach)
{
    const struct box mesh = scene_bounds(world_scene(world, instance));
    return needs_of(&world->instance[instance], &mesh, box, share, reach);
}

/* True if the entry may be opened; share and reach then cover its instance. Those of a part were
 * set when its instance was opened. */
static bool may_open(struct braiding *b, const struct braid_entry *entry)
{
    const struct instance *instance = &b->world->instance[entry->of.instance];
    float share = 0, reach = 0;
    if (entry->whole)
        return false;
    if (entry->of.node == 0 &&
        !needs_of(instance, &b->mesh[instance->mesh], &entry->box, &share, &reach))
        return false;
    share = fmaxf(share, b->share);
    reach = fmaxf(reach, b->reach);
    if (!(2.0 * (double)share * (double)reach <= BRAID_WIDTH_MOST * longest_side(&entry->box)))
        return false;
    b->share = share;
    b->reach = reach;
    return true;
}

/* The box of the triangles below a node, placed. */
static struct box box_of(const struct braiding *b, struct world_part part)
{
    const struct instance *instance = &b->world->instance[part.instance];
    const struct bvh *bvh = &b->bottom[instance->mesh];
    const struct scene *scene = b->world->mesh[instance->mesh].scene;
    const struct subtree_range range = subtree_range(bvh, part.node);
    struct box box = box_empty();
    for (uint32_t i = range.first; i < range.end; i++) {
        float v[3][3];
        scene_tri(scene, bvh->prim[i], v);
        for (int c = 0; c < 3; c++)
            if (b->of_vertices)
                for (int k = 0; k < 3; k++)
                    placed_grow(instance->m[k], v[c], &box.lo[k], &box.hi[k]);
            else
                box_add_point(&box, v[c]);
    }
    return b->of_vertices ? box : placed_box_bounds(instance->m, &box);
}

/* --- opening ---------------------------------------------------------------------------------- */

static void push(struct braiding *b, uint32_t instance, uint32_t node, const struct box *box)
{
    const struct bvh *bvh = &b->bottom[b->world->instance[instance].mesh];
    const struct bvh_node *at = &bvh->node[node];
    struct braid_entry entry = {
        .of = {instance, node}, .whole = bvh_is_split(bvh) || at->item_count > 0, .box = *box};
    if (!entry.whole) {
        entry.child[0] = box_of(b, (struct world_part){instance, at->fst});
        entry.child[1] = box_of(b, (struct world_part){instance, at->snd});
        entry.gain = braid_gain(box, entry.child);
    }
    heap_push(b, &entry);
}

static void open_entries(struct braiding *b)
{
    while (b->open > 0) {
        const struct braid_entry entry = heap_pop(b);
        const uint32_t instance = entry.of.instance;
        if (b->open + b->stay + 2 > b->room || !may_open(b, &entry)) {
            b->entry[b->room - ++b->stay] = entry;
            continue;
        }
        const struct bvh *bvh = &b->bottom[b->world->instance[instance].mesh];
        push(b, instance, bvh->node[entry.of.node].fst, &entry.child[0]);
        push(b, instance, bvh->node[entry.of.node].snd, &entry.child[1]);
    }
}

static int part_order(const void *left, const void *right)
{
    const struct world_part *a = &((const struct braid_entry *)left)->of;
    const struct world_part *b = &((const struct braid_entry *)right)->of;
    int order = order_numbers(a->instance, b->instance);
    return order ? order : order_numbers(a->node, b->node);
}

/* Copies the entries that are parts. */
static enum status take_parts(struct braiding *b, struct world_parts *out, struct box **part_box)
{
    struct braid_entry *entry = b->entry + (b->room - b->stay);
    uint32_t count = 0;
    for (uint32_t i = 0; i < b->stay; i++)
        count += entry[i].of.node > 0;
    if (count == 0)
        return STATUS_OK;
    qsort(entry, b->stay, sizeof *entry, part_order);
    out->part = alloc_zeroed(count, sizeof *out->part);
    *part_box = alloc_zeroed(count, sizeof **part_box);
    if (!out->part || !*part_box)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < b->stay; i++)
        if (entry[i].of.node > 0) {
            out->part[out->count] = entry[i].of;
            (*part_box)[out->count++] = entry[i].box;
        }
    out->share = b->share;
    out->reach = b->reach;
    return STATUS_OK;
}

static uint32_t active_count(const struct world *world)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < world->instance_count; i++)
        count += world_is_active(world, i);
    return count;
}

enum status braid_make(const struct world *world, const struct bvh *bottom, const struct box *box,
                       enum world_boxes how, uint32_t braid, struct world_parts *out,
                       struct box **part_box, struct reason *reason)
{
    const uint64_t active = active_count(world), entries = active * braid;
    struct braiding b = {.world = world, .bottom = bottom};
    *out = (struct world_parts){.part = NULL};
    *part_box = NULL;
    if (braid <= 1 || active == 0)
        return STATUS_OK;
    b.of_vertices = world_boxes_are_of_vertices(world, how);
    b.room = (uint32_t)(entries < BRAID_ENTRIES ? entries : BRAID_ENTRIES);
    b.room = b.room < active ? (uint32_t)active : b.room;
    b.entry = alloc_zeroed(b.room, sizeof *b.entry);
    b.mesh = alloc_zeroed(world->mesh_count, sizeof *b.mesh);
    enum status status = b.entry && b.mesh ? STATUS_OK : STATUS_MEMORY;
    if (!status) {
        for (uint32_t i = 0; i < world->mesh_count; i++)
            b.mesh[i] = scene_bounds(world->mesh[i].scene);
        for (uint32_t i = 0; i < world->instance_count; i++)
            if (world_is_active(world, i))
                push(&b, i, 0, &box[i]);
        open_entries(&b);
        status = take_parts(&b, out, part_box);
    }
    free(b.entry);
    free(b.mesh);
    if (status) {
        world_parts_free(out);
        free(*part_box);
        *part_box = NULL;
        return fail(reason, status, "no memory to open %u instances", (uint32_t)active);
    }
    return STATUS_OK;
}

void world_parts_free(struct world_parts *parts)
{
    free(parts->part);
    *parts = (struct world_parts){.part = NULL};
}
