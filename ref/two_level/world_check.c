#include "ref/two_level/world_check.h"

#include "ref/packed/packed_check.h"
#include "ref/world/placed.h"
#include "ref/world/object_ray.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A check in progress. */
struct world_check {
    const struct world *world;
    const struct packed_world *packed;
    struct world_faults faults;
    struct reason *reason;
    enum status status; /* STATUS_INPUT once a fault is reported; STATUS_MEMORY */
};

/* Reports a fault; the first is described. */
static void report(struct world_check *check, enum world_rule rule, const char *format, ...)
    PRINTF_LIKE(3, 4);

static void report(struct world_check *check, enum world_rule rule, const char *format, ...)
{
    struct reason text;
    va_list args;
    if (check->status)
        return;
    va_start(args, format);
    vsnprintf(text.text, sizeof text.text, format, args);
    va_end(args);
    check->faults.first = rule;
    check->status = fail(check->reason, STATUS_INPUT, "%s", text.text);
}

/* --- records ---------------------------------------------------------------------------------- */

#define FACING  (ABI_INSTANCE_CULL_DISABLE | ABI_INSTANCE_FLIP_FACING)
#define OPACITY (ABI_INSTANCE_FORCE_OPAQUE | ABI_INSTANCE_FORCE_NO_OPAQUE)

static const char *const part_name[RECORD_PART_COUNT] = {
    "the number of its first triangle",
    "the mesh",
    "the custom index",
    "the mask",
    "the flags about facing",
    "the flags about opacity",
    "the flags",
    "the translation",
    "the inverse",
};

/* Returns the first member of a record that differs, or RECORD_PART_COUNT. */
static enum record_part wrong_part(const struct world *world, uint32_t at,
                                   const struct instance_record *record)
{
    const struct instance *instance = &world->instance[at];
    bool active = world_is_active(world, at);
    uint32_t identity = instance_is_identity(instance) ? ABI_INSTANCE_IDENTITY : 0;
    uint32_t flags = record->flags ^ (instance->flags | identity);
    float w[9] = {0}, t[3] = {0};
    if (record->first != world->first[at])
        return RECORD_FIRST;
    if (record->mesh != (active ? instance->mesh : WORLD_NO_MESH))
        return RECORD_MESH;
    if ((record->custom_mask & ABI_CUSTOM_MOST) != instance->custom)
        return RECORD_CUSTOM;
    if (record->custom_mask >> 24 != instance->mask)
        return RECORD_MASK;
    if (flags)
        return flags & FACING ? RECORD_FACING : flags & OPACITY ? RECORD_OPACITY : RECORD_IDENTITY;
    for (int k = 0; k < 3 && active; k++)
        t[k] = instance->m[k][3];
    if (memcmp(record->t, t, sizeof t) != 0)
        return RECORD_TRANSLATION;
    if (active && transform_inverse(instance->m, w, NULL))
        return RECORD_INVERSE;
    return memcmp(record->w, w, sizeof w) == 0 ? RECORD_PART_COUNT : RECORD_INVERSE;
}

static void check_records(struct world_check *check)
{
    for (uint32_t i = 0; i < check->world->instance_count; i++) {
        enum record_part part = wrong_part(check->world, i, &check->packed->record[i]);
        if (part == RECORD_PART_COUNT)
            continue;
        if (check->faults.records++ == 0)
            check->faults.part = part;
        report(check, WORLD_RECORD, "instance %u: its record differs in %s", i, part_name[part]);
    }
}

/* --- boxes ------------------------------------------------------------------------------------ */

/* Returns the first axis along which a vertex of a triangle lies outside, or -1. */
static int outside_axis(const struct instance *instance, float v[3][3], const struct box *box)
{
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            if (placed_compare(instance->m[k], v[c], box->lo[k]) < 0 ||
                placed_compare(instance->m[k], v[c], box->hi[k]) > 0)
                return k;
    return -1;
}

static bool is_finite(const struct box *box)
{
    for (int k = 0; k < 3; k++)
        if (!float_is_finite(box->lo[k]) || !float_is_finite(box->hi[k]))
            return false;
    return true;
}

static void check_box(struct world_check *check, uint32_t at)
{
    const struct scene *scene = world_scene(check->world, at);
    const struct box *box = &check->packed->box[at], empty = box_empty();
    if (!world_is_active(check->world, at)) {
        if (memcmp(box, &empty, sizeof empty) != 0) {
            check->faults.boxes++;
            report(check, WORLD_BOX, "instance %u: it is not active, and has a box", at);
        }
        return;
    }
    bool finite = is_finite(box);
    for (uint32_t prim = 0; prim < scene->tri_count; prim++) {
        float v[3][3];
        scene_tri(scene, prim, v);
        int axis = finite ? outside_axis(&check->world->instance[at], v, box) : 0;
        if (axis < 0)
            continue;
        check->faults.boxes++;
        report(check, WORLD_BOX,
               "instance %u: %c bounds [%a, %a] do not contain triangle %u of mesh %u, placed", at,
               "xyz"[axis], (double)box -> lo[axis], (double)box -> hi[axis], prim,
               check -> world -> instance[at].mesh);
        return;
    }
}

/* --- trees ------------------------------------------------------------------------------------ */

static void check_top(struct world_check *check)
{
    const struct world *world = check->world;
    struct reason why = {""};
    struct scene items;
    bool *left_out = alloc_zeroed(world->instance_count, sizeof *left_out);
    enum status status = left_out ? STATUS_OK : STATUS_MEMORY;
    if (!status)
        status = world_items_make(world, check->packed->box, &items, &why);
    if (!status) {
        for (uint32_t i = 0; i < world->instance_count; i++)
            left_out[i] = !world_is_active(world, i);
        status = check->packed->top.split
                     ? fail(&why, STATUS_INPUT, "it is split")
                     : packed_check_without(&check->packed->top, &items, left_out, NULL, &why);
        scene_free(&items);
    }
    free(left_out);
    if (status == STATUS_INPUT) {
        check->faults.tops++;
        report(check, WORLD_TOP, "top level, whose triangles are instances: %s", why.text);
    } else if (status) {
        check->status = status;
    }
}

static void check_bottoms(struct world_check *check)
{
    for (uint32_t i = 0; i < check->world->mesh_count; i++) {
        struct reason why = {""};
        enum status status =
            packed_check(&check->packed->bottom[i], check->world->mesh[i].scene, NULL, &why);
        if (status == STATUS_INPUT) {
            check->faults.bottoms++;
            report(check, WORLD_BOTTOM, "mesh %u: %s", i, why.text);
        } else if (status) {
            check->status = status;
        }
    }
}

static void check_stack(struct world_check *check)
{
    const struct packed_world *packed = check->packed;
    uint32_t bottom = 0, most = packed_world_stack_most(packed);
    for (uint32_t i = 0; i < check->world->instance_count; i++)
        if (world_is_active(check->world, i)) {
            uint32_t need = packed->bottom[check->world->instance[i].mesh].stack_need;
            bottom = need > bottom ? need : bottom;
        }
    uint32_t need = packed->top.stack_need + bottom;
    if (need <= packed->stack_need && packed->stack_need <= most)
        return;
    check->faults.stacks++;
    report(check, WORLD_STACK,
           "both levels need %u stack entries, the packed world says %u, at most %u fit", need,
           packed->stack_need, most);
}

enum status world_pack_check(const struct world *world, const struct packed_world *packed,
                             struct world_faults *faults, struct reason *reason)
{
    struct world_check check = {.world = world, .packed = packed, .reason = reason};
    if (faults)
        *faults = (struct world_faults){0};
    if (packed->instance_count != world->instance_count ||
        packed->mesh_count != world->mesh_count) {
        report(
            &check, WORLD_NUMBERS, "%u instances of %u meshes are packed, the world has %u of %u",
            packed->instance_count, packed->mesh_count, world->instance_count, world->mesh_count);
    } else {
        check_records(&check);
        for (uint32_t i = 0; i < world->instance_count; i++)
            check_box(&check, i);
        check_top(&check);
        check_bottoms(&check);
        check_stack(&check);
    }
    if (check.status == STATUS_MEMORY)
        return fail(reason, STATUS_MEMORY, "no memory to check %u instances",
                    world->instance_count);
    if (faults)
        *faults = check.faults;
    return check.status;
}
