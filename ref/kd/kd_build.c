/* The builder of k-d trees, O(n log n) of Wald and Havran 2006: the events of all parts are sorted
 * once; a child takes those of its parts in order, and sorts only those of parts that the plane
 * cuts.
 *
 * What holds for every node: each point of a triangle that lies in the node's voxel lies in the box
 * of one of the node's parts of that triangle, or it lies in the plane of a cut above and in the
 * voxel on its other side, whose node has it. For a part that reaches both sides is cut by
 * clip_inside, which leaves out nothing of the triangle in a side's voxel, and one that only
 * touches the plane, or lies in it, stays whole on one side; a ray that meets the plane there meets
 * the voxels of both sides (ref/kd/kd_trace.c). */
#include "ref/kd/kd.h"

#include "ref/base/memory.h"
#include "ref/build/room.h"
#include "ref/kd/kd_plane.h"

#include <math.h>
#include <stdlib.h>

#define TRI_BYTES 190u /* least memory of a build per triangle: a set, its children, their sides */
#define GIGA      1000000000.0
/* What a node's number, an item's and a count have room for. */
#define NODES_MOST ((size_t)1 << 30)

enum { LEFT, RIGHT, BOTH };

struct kd_builder {
    const struct scene *scene;
    struct kd_node *node;
    uint32_t *item;
    size_t node_count, item_count, node_room, item_room;
    uint32_t depth_most, depth;
};

static void set_free(struct kd_set *set)
{
    room_free(set->part);
    for (int k = 0; k < 3; k++)
        room_free(set->event[k]);
    *set = (struct kd_set){0};
}

/* Room for `count` parts and their events. Errors: STATUS_MEMORY. */
static enum status set_make(uint32_t count, struct kd_set *set)
{
    bool made;
    *set = (struct kd_set){.part = room_make(count, sizeof *set->part)};
    made = set->part;
    for (int k = 0; k < 3; k++) {
        set->event[k] = room_make(2 * (size_t)count, sizeof *set->event[k]);
        made = made && set->event[k];
    }
    if (made)
        return STATUS_OK;
    set_free(set);
    return STATUS_MEMORY;
}

static int by_number(const void *a, const void *b)
{
    return order_numbers(*(const kd_event *)a, *(const kd_event *)b);
}

/* --- a plane cuts a set ----------------------------------------------------------------------- */

/* A node's set while it is divided. */
struct division {
    const struct kd_set *set;
    struct box voxel[2];
    struct kd_set child[2];
    uint32_t whole[2], both; /* parts that stay whole on a side, and those that the plane cuts */
    uint8_t *side;           /* of each part: LEFT, RIGHT or BOTH */
    uint32_t *to;            /* of a whole one: its number in the child */
    uint32_t *cut[2];        /* the numbers of parts of cut ones, in each child */
    uint32_t cuts[2];
    kd_event *fresh; /* of parts of cut ones, along one axis */
};

static uint32_t put(struct kd_set *child, const struct part *part)
{
    child->part[child->count] = *part;
    return child->count++;
}

/* A part that only touches the plane stays whole; one that lies in it goes where it costs less. */
static void choose_sides(struct division *d, const struct kd_plane *plane)
{
    for (uint32_t i = 0; i < d->set->count; i++) {
        const struct part *part = &d->set->part[i];
        float lo = part->box.lo[plane->axis], hi = part->box.hi[plane->axis];
        if (lo == plane->at && hi == plane->at)
            d->side[i] = plane->flat_right ? RIGHT : LEFT;
        else
            d->side[i] = hi <= plane->at ? LEFT : lo >= plane->at ? RIGHT : BOTH;
        d->both += d->side[i] == BOTH;
        d->whole[0] += d->side[i] == LEFT;
        d->whole[1] += d->side[i] == RIGHT;
    }
}

/* Puts the parts of a cut triangle into the children that it reaches. */
static void put_cut(struct division *d, const struct scene *scene, const struct part *from)
{
    float v[3][3];
    scene_tri(scene, from->prim, v);
    for (int side = 0; side < 2; side++) {
        struct part part = *from;
        for (int k = 0; k < 3; k++) {
            part.box.lo[k] = fmaxf(part.box.lo[k], d->voxel[side].lo[k]);
            part.box.hi[k] = fminf(part.box.hi[k], d->voxel[side].hi[k]);
        }
        clip_inside(v, &part.box);
        if (clip_is_empty(&part.box))
            continue;
        for (int k = 0; k < 3; k++) { /* no -0: places are compared by their bits */
            part.box.lo[k] += 0.0f;
            part.box.hi[k] += 0.0f;
        }
        d->cut[side][d->cuts[side]++] = put(&d->child[side], &part);
    }
}

static void put_parts(struct division *d, const struct scene *scene)
{
    for (uint32_t i = 0; i < d->set->count; i++)
        if (d->side[i] == BOTH)
            put_cut(d, scene, &d->set->part[i]);
        else
            d->to[i] = put(&d->child[d->side[i]], &d->set->part[i]);
}

/* The events of a child: those of its whole parts, which are in order, and those of the cut ones,
 * which are sorted and merged from behind. */
static void put_events(struct division *d, int side, int axis)
{
    struct kd_set *child = &d->child[side];
    kd_event *out = child->event[axis];
    uint32_t kept = 0, fresh = 0;
    for (uint32_t i = 0; i < d->set->events[axis]; i++) {
        kd_event event = d->set->event[axis][i];
        uint32_t part = kd_event_part(event);
        if (d->side[part] == side)
            out[kept++] = (event ^ part) | d->to[part];
    }
    for (uint32_t i = 0; i < d->cuts[side]; i++) {
        uint32_t part = d->cut[side][i];
        fresh += kd_events(&child->part[part], part, axis, d->fresh + fresh);
    }
    qsort(d->fresh, fresh, sizeof *d->fresh, by_number);
    child->events[axis] = kept + fresh;
    while (fresh > 0) {
        bool last = kept > 0 && out[kept - 1] > d->fresh[fresh - 1];
        out[kept + fresh - 1] = last ? out[kept - 1] : d->fresh[fresh - 1];
        kept -= last;
        fresh -= !last;
    }
}

/* Errors: STATUS_MEMORY. */
static enum status fill_children(struct division *d, const struct scene *scene)
{
    bool made = true;
    d->to = room_make(d->set->count, sizeof *d->to);
    d->fresh = room_make(2 * (size_t)d->both, sizeof *d->fresh);
    for (int side = 0; side < 2; side++) {
        d->cut[side] = room_make(d->both, sizeof *d->cut[side]);
        made = !set_make(d->whole[side] + d->both, &d->child[side]) && d->cut[side] && made;
    }
    if (!made || !d->to || !d->fresh)
        return STATUS_MEMORY;
    put_parts(d, scene);
    for (int i = 0; i < 6; i++)
        put_events(d, i / 3, i % 3);
    return STATUS_OK;
}

/* Makes the sets of both sides. Errors: STATUS_MEMORY, and they are empty. */
static enum status divide(const struct scene *scene, const struct kd_set *set,
                          const struct box voxel[2], const struct kd_plane *plane,
                          struct kd_set child[2])
{
    struct division d = {.set = set, .voxel = {voxel[0], voxel[1]}};
    enum status status = STATUS_MEMORY;
    d.side = room_make(set->count, sizeof *d.side);
    if (d.side) {
        choose_sides(&d, plane);
        status = fill_children(&d, scene);
    }
    for (int side = 0; side < 2; side++) {
        if (status)
            set_free(&d.child[side]);
        child[side] = d.child[side];
        room_free(d.cut[side]);
    }
    room_free(d.to);
    room_free(d.side);
    room_free(d.fresh);
    return status;
}

/* --- nodes ------------------------------------------------------------------------------------ */

static enum status make_leaf(struct kd_builder *b, const struct kd_set *set, size_t node)
{
    if (b->item_count + set->count > NODES_MOST)
        return STATUS_LIMIT;
    if (array_reserve(&b->item, &b->item_room, b->item_count + set->count, sizeof *b->item))
        return STATUS_MEMORY;
    b->node[node] =
        (struct kd_node){.first = (uint32_t)b->item_count, .what = set->count << 2 | KD_LEAF};
    for (uint32_t i = 0; i < set->count; i++)
        b->item[b->item_count++] = set->part[i].prim;
    return STATUS_OK;
}

/* Makes the subtree of a set, which is freed. */
static enum status grow(struct kd_builder *b, struct kd_set *set, const struct box *voxel,
                        uint32_t depth, size_t node)
{
    struct kd_plane plane = {.axis = -1};
    struct kd_set child[2];
    struct box side[2] = {*voxel, *voxel};
    enum status status = STATUS_OK;
    b->depth = depth > b->depth ? depth : b->depth;
    if (depth < b->depth_most)
        plane = kd_plane_find(set, voxel);
    if (plane.axis < 0 || !(plane.cost < KD_COST_TRI * (double)set->count)) {
        status = make_leaf(b, set, node);
        set_free(set);
        return status;
    }
    side[0].hi[plane.axis] = side[1].lo[plane.axis] = plane.at;
    status = divide(b->scene, set, side, &plane, child);
    set_free(set);
    size_t left = b->node_count;
    if (!status && left + 2 > NODES_MOST)
        status = STATUS_LIMIT;
    if (!status)
        status = array_reserve(&b->node, &b->node_room, left + 2, sizeof *b->node);
    if (!status) {
        b->node[node] =
            (struct kd_node){.at = plane.at, .what = (uint32_t)left << 2 | (uint32_t)plane.axis};
        b->node_count += 2;
    }
    for (size_t i = 0; i < 2; i++)
        if (!status)
            status = grow(b, &child[i], &side[i], depth + 1, left + i);
        else
            set_free(&child[i]);
    return status;
}

/* The set of all triangles. */
static enum status gather(const struct scene *scene, struct kd_set *set, struct box *voxel)
{
    if (set_make(scene->tri_count, set))
        return STATUS_MEMORY;
    *voxel = box_empty();
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        struct part part = {scene_tri_bounds(scene, i), i};
        for (int k = 0; k < 3; k++) {
            part.box.lo[k] += 0.0f;
            part.box.hi[k] += 0.0f;
            set->events[k] += kd_events(&part, i, k, set->event[k] + set->events[k]);
        }
        box_add_box(voxel, &part.box);
        (void)put(set, &part);
    }
    for (int k = 0; k < 3; k++)
        qsort(set->event[k], set->events[k], sizeof *set->event[k], by_number);
    return STATUS_OK;
}

static enum status make(struct kd_builder *b, struct kd_tree *out)
{
    const struct scene *scene = b->scene;
    struct kd_set set;
    b->depth_most = (uint32_t)(8.0 + 1.3 * log2((double)scene->tri_count));
    enum status status = array_reserve(&b->node, &b->node_room, 1, sizeof *b->node);
    if (!status)
        status = gather(scene, &set, &out->box);
    b->node_count = 1;
    if (!status)
        status = grow(b, &set, &out->box, 0, 0);
    if (!status)
        out->tri = room_make(scene->tri_count, sizeof *out->tri);
    if (!status && !out->tri)
        status = STATUS_MEMORY;
    out->node = b->node;
    out->item = b->item;
    if (status)
        return status;
    out->node_count = (uint32_t)b->node_count;
    out->item_count = (uint32_t)b->item_count;
    out->tri_count = scene->tri_count;
    out->depth = b->depth;
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        float v[3][3];
        scene_tri(scene, i, v);
        out->tri[i] = tri_accel_make(v, i);
    }
    return STATUS_OK;
}

enum status kd_make(const struct scene *scene, struct kd_tree *out, struct reason *reason)
{
    const uint64_t bytes = (uint64_t)TRI_BYTES * scene->tri_count;
    struct kd_builder b = {.scene = scene};
    *out = (struct kd_tree){0};
    if (scene->tri_count == 0)
        return STATUS_OK;
    if (scene->tri_count > KD_TRIS_MOST)
        return fail(reason, STATUS_LIMIT,
                    "a k-d tree holds at most 2^29 triangles, the scene has %u", scene->tri_count);
    if (!memory_fits(bytes))
        return fail(
            reason, STATUS_MEMORY,
            "no memory: a k-d tree of %u triangles takes at least %.1f GB, %.1f GB are free",
            scene->tri_count, (double)bytes / GIGA, (double)memory_left() / GIGA);
    enum status status = make(&b, out);
    if (!status)
        return STATUS_OK;
    kd_free(out);
    if (status == STATUS_LIMIT)
        return fail(reason, status, "a k-d tree holds at most 2^30 nodes and as many items");
    return fail(reason, status, "no memory for a k-d tree of %u triangles", scene->tri_count);
}

void kd_free(struct kd_tree *tree)
{
    free(tree->node);
    free(tree->item);
    room_free(tree->tri);
    *tree = (struct kd_tree){0};
}
