#include "ref/two_level/world_check_inner.h"

#include "ref/packed/packed_check.h"
#include "ref/world/placed.h"
#include "ref/world/object_ray.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void world_check_report(struct world_check *check, enum world_rule rule, const char *format, ...)
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

/* --- numbers ---------------------------------------------------------------------------------- */

/* Parts are of active instances and in their order. */
static bool entries_are_in_order(const struct world_check *check)
{
    const struct packed_world *packed = check->packed;
    for (uint32_t i = 0; i < packed->entry_count; i++) {
        const uint32_t instance = packed->instance[i];
        if (i < packed->instance_count
                ? instance != i
                : instance >= packed->instance_count || !world_is_active(check->world, instance))
            return false;
        if (i > packed->instance_count && instance < packed->instance[i - 1])
            return false;
    }
    return true;
}

static bool trees_are_in_order(const struct world_check *check)
{
    const struct packed_world *packed = check->packed;
    for (uint32_t i = 0; i < packed->tree_count; i++)
        if (i < packed->mesh_count ? packed->mesh[i] != i : packed->mesh[i] >= packed->mesh_count)
            return false;
    return true;
}

/* Returns false if nothing else can be checked. */
static bool check_numbers(struct world_check *check)
{
    const struct packed_world *packed = check->packed;
    const struct world *world = check->world;
    if (packed->instance_count != world->instance_count || packed->mesh_count != world->mesh_count)
        world_check_report(
            check, WORLD_NUMBERS, "%u instances of %u meshes are packed, the world has %u of %u",
            packed->instance_count, packed->mesh_count, world->instance_count, world->mesh_count);
    else if (packed->entry_count < packed->instance_count || !entries_are_in_order(check))
        world_check_report(check, WORLD_NUMBERS,
                           "the %u entries are not those of %u instances and of parts of them",
                           packed->entry_count, packed->instance_count);
    else if (packed->tree_count < packed->mesh_count || !trees_are_in_order(check))
        world_check_report(check, WORLD_NUMBERS,
                           "the %u trees are not those of %u meshes and of parts of them",
                           packed->tree_count, packed->mesh_count);
    return !check->status;
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

/* True if record->mesh is what it has to be: of a part a tree of its mesh. */
static bool is_of_mesh(const struct world_check *check, uint32_t entry, uint32_t instance)
{
    const struct packed_world *packed = check->packed;
    const uint32_t mesh = check->world->instance[instance].mesh, of = packed->record[entry].mesh;
    if (entry >= packed->instance_count)
        return of >= packed->mesh_count && of < packed->tree_count && packed->mesh[of] == mesh;
    return of == (world_is_active(check->world, instance) ? mesh : WORLD_NO_MESH);
}

/* Returns the first member of a record that differs, or RECORD_PART_COUNT. */
static enum record_part wrong_part(const struct world_check *check, uint32_t entry)
{
    const struct world *world = check->world;
    const struct instance_record *record = &check->packed->record[entry];
    const uint32_t at = check->packed->instance[entry];
    const struct instance *instance = &world->instance[at];
    bool active = world_is_active(world, at);
    uint32_t identity = instance_is_identity(instance) ? ABI_INSTANCE_IDENTITY : 0;
    uint32_t flags = record->flags ^ (instance->flags | identity);
    float w[9] = {0}, t[3] = {0};
    if (record->first != world->first[at])
        return RECORD_FIRST;
    if (!is_of_mesh(check, entry, at))
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
    const uint32_t instances = check->world->instance_count;
    for (uint32_t i = 0; i < check->packed->entry_count; i++) {
        enum record_part part = wrong_part(check, i);
        if (part == RECORD_PART_COUNT)
            continue;
        if (check->faults.records++ == 0)
            check->faults.part = part;
        if (i < instances)
            world_check_report(check, WORLD_RECORD, "instance %u: its record differs in %s", i,
                               part_name[part]);
        else
            world_check_report(check, WORLD_RECORD,
                               "part %u, of instance %u: its record differs in %s", i - instances,
                               check->packed->instance[i], part_name[part]);
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

bool world_check_placed(struct world_check *check, uint32_t entry, uint32_t prim)
{
    const struct box *box = &check->packed->box[entry];
    const uint32_t at = check->packed->instance[entry];
    const bool is_part = entry >= check->packed->instance_count;
    float v[3][3];
    scene_tri(world_scene(check->world, at), prim, v);
    int axis = is_finite(box) ? outside_axis(&check->world->instance[at], v, box) : 0;
    if (axis < 0)
        return true;
    check->faults.boxes++;
    world_check_report(check, WORLD_BOX,
                       "instance %u: %c bounds [%a, %a]%s do not contain triangle %u of mesh %u, "
                       "placed",
                       at, "xyz"[axis], (double)box -> lo[axis], (double)box -> hi[axis],
                       is_part ? " of a part" : "", prim, check->world->instance[at].mesh);
    return false;
}

static void check_box(struct world_check *check, uint32_t at)
{
    const struct scene *scene = world_scene(check->world, at);
    const struct box *box = &check->packed->box[at], empty = box_empty();
    if (!world_is_active(check->world, at)) {
        if (memcmp(box, &empty, sizeof empty) != 0) {
            check->faults.boxes++;
            world_check_report(check, WORLD_BOX, "instance %u: it is not active, and has a box",
                               at);
        }
        return;
    }
    for (uint32_t prim = 0; prim < scene->tri_count; prim++)
        if (!world_check_placed(check, at, prim))
            return;
}

/* --- trees ------------------------------------------------------------------------------------ */

/* The parts as braid_make gives them, without their nodes. */
static enum status parts_of(const struct packed_world *packed, struct world_parts *out)
{
    const uint32_t count = packed->entry_count - packed->instance_count;
    *out = (struct world_parts){.part = alloc_zeroed(count, sizeof *out->part), .count = count};
    for (uint32_t i = 0; i < count && out->part; i++)
        out->part[i].instance = packed->instance[packed->instance_count + i];
    return out->part ? STATUS_OK : STATUS_MEMORY;
}

/* Which entries the top has to leave out, told from the entries themselves: not as the builder
 * does. Caller frees; NULL if out of memory. */
static bool *left_out_of(const struct world_check *check)
{
    const struct packed_world *packed = check->packed;
    bool *out = alloc_zeroed(packed->entry_count, sizeof *out);
    for (uint32_t i = 0; i < packed->entry_count && out; i++)
        if (i >= packed->instance_count)
            out[packed->instance[i]] = true;
        else if (!world_is_active(check->world, i))
            out[i] = true;
    return out;
}

static void check_top(struct world_check *check)
{
    const struct world *world = check->world;
    struct reason why = {""};
    struct scene items = {0};
    struct world_parts parts;
    bool *left_out = NULL;
    enum status status = parts_of(check->packed, &parts);
    if (!status)
        status = world_items_make(world, &parts, check->packed->box, &items, &why);
    if (!status) {
        left_out = left_out_of(check);
        status = left_out ? STATUS_OK : STATUS_MEMORY;
    }
    if (!status)
        status = check->packed->top.split
                     ? fail(&why, STATUS_INPUT, "it is split")
                     : packed_check_without(&check->packed->top, &items, left_out, NULL, &why);
    scene_free(&items);
    free(left_out);
    world_parts_free(&parts);
    if (status == STATUS_INPUT) {
        check->faults.tops++;
        world_check_report(check, WORLD_TOP, "top level, whose triangles are instances: %s",
                           why.text);
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
            world_check_report(check, WORLD_BOTTOM, "mesh %u: %s", i, why.text);
        } else if (status) {
            check->status = status;
        }
    }
}

static void check_stack(struct world_check *check)
{
    const struct packed_world *packed = check->packed;
    uint32_t bottom = 0, most = packed_world_stack_most(packed);
    for (uint32_t i = 0; i < packed->entry_count; i++) {
        const uint32_t tree =
            i < packed->instance_count ? check->world->instance[i].mesh : packed->record[i].mesh;
        if (!world_is_active(check->world, packed->instance[i]) || tree >= packed->tree_count)
            continue;
        uint32_t need = packed->bottom[tree].stack_need;
        bottom = need > bottom ? need : bottom;
    }
    uint32_t need = packed->top.stack_need + bottom;
    if (need <= packed->stack_need && packed->stack_need <= most)
        return;
    check->faults.stacks++;
    world_check_report(
        check, WORLD_STACK,
        "both levels need %u stack entries, the packed world says %u, at most %u fit", need,
        packed->stack_need, most);
}

enum status world_pack_check(const struct world *world, const struct packed_world *packed,
                             struct world_faults *faults, struct reason *reason)
{
    struct world_check check = {.world = world, .packed = packed, .reason = reason};
    if (faults)
        *faults = (struct world_faults){0};
    if (check_numbers(&check)) {
        check_records(&check);
        for (uint32_t i = 0; i < world->instance_count; i++)
            check_box(&check, i);
        check_top(&check);
        check_bottoms(&check);
        if (check.faults.records == 0 && world_check_parts(&check))
            check.status = STATUS_MEMORY;
        check_stack(&check);
    }
    if (check.status == STATUS_MEMORY)
        return fail(reason, STATUS_MEMORY, "no memory to check %u instances",
                    world->instance_count);
    if (faults)
        *faults = check.faults;
    return check.status;
}
