/* Files of RADV: one serialised structure, or a top level and then those that its handles name,
 * each once, in the order in which they first do. */
#include "ref/dump/dump_inner.h"

#include "ref/dump/dump_instances.h"
#include "ref/dump/radv.h"

#include <stdlib.h>
#include <string.h>

/* Where 64-bit words of the head are. */
#define HEAD_SIZE      32u
#define HEAD_ALL       40u
#define HEAD_LEAVES    80u
#define HEAD_INSTANCES 88u
#define LATER          16u /* further behind are the sizes in a head of Mesa 25.1 and later */

#define ROOT (2 * RADV_SLOT)

static const char driver[SERIAL_UUID] = "AMD-MESA-DRV";

bool dump_is_radv(const char *bytes, size_t size)
{
    return dump_is_serialised(bytes, size) && memcmp(bytes, driver, sizeof driver) == 0;
}

#define FAIL(level, reason, ...) serial_fail((level)->name, (level)->begin, reason, __VA_ARGS__)

/* --- heads ------------------------------------------------------------------------------------ */

static enum status check_driver(const struct radv_level *level, const char *at,
                                struct reason *reason)
{
    char text[SERIAL_UUID_TEXT];
    if (memcmp(at, driver, sizeof driver) == 0)
        return STATUS_OK;
    return FAIL(level, reason, "of the driver with the UUID %s; %s, RADV, is read",
                serial_uuid_text(at, text), driver);
}

/* The head of the structure itself, whose sizes must be those before its handles. */
static enum status check_head(const struct radv_level *level, uint64_t all, uint64_t size,
                              struct reason *reason)
{
    const char *at = level->at;
    if (serial_long(at + HEAD_SIZE + LATER) == size && serial_long(at + HEAD_ALL + LATER) == all)
        return FAIL(level, reason,
                    "its head is that of Mesa 25.1 or later, which may be of GFX12; that of Mesa "
                    "25.0 is read");
    if (serial_long(at + HEAD_SIZE) != size || serial_long(at + HEAD_ALL) != all ||
        serial_long(at + HEAD_INSTANCES) != level->handles)
        return FAIL(level, reason,
                    "its two heads differ: %llu and %llu bytes, of which %llu and %llu are the "
                    "structure, %u and %llu instances",
                    (unsigned long long)all, (unsigned long long)serial_long(at + HEAD_ALL),
                    (unsigned long long)size, (unsigned long long)serial_long(at + HEAD_SIZE),
                    level->handles, (unsigned long long)serial_long(at + HEAD_INSTANCES));
    const uint64_t nodes = serial_word(at);
    if (nodes < RADV_HEAD || nodes % RADV_SLOT != 0 || nodes + ROOT > size)
        return FAIL(level, reason, "its nodes begin at %llu, where no root can be",
                    (unsigned long long)nodes);
    if (serial_long(at + HEAD_LEAVES) != nodes + ROOT ||
        level->handles > (size - nodes - ROOT) / ROOT)
        return FAIL(level, reason, "its leaves begin at %llu, and %u instances do not fit there",
                    (unsigned long long)serial_long(at + HEAD_LEAVES), level->handles);
    return STATUS_OK;
}

/* Where a structure ends and its parts are. `at` has `left` bytes. */
static enum status read_head(struct radv_level *level, const char *at, uint64_t left, uint64_t *end,
                             struct reason *reason)
{
    if (left < SERIAL_HANDLES + RADV_HEAD)
        return FAIL(level, reason, "%llu bytes are left, a head has %u", (unsigned long long)left,
                    SERIAL_HANDLES + RADV_HEAD);
    enum status status = check_driver(level, at, reason);
    if (status)
        return status;
    const uint64_t all = serial_long(at + SERIAL_SIZE), size = serial_long(at + SERIAL_INNER),
                   handles = serial_long(at + SERIAL_COUNT);
    if (all > left)
        return FAIL(level, reason, "its head tells %llu bytes, and %llu are left",
                    (unsigned long long)all, (unsigned long long)left);
    if (all > UINT32_MAX || handles > all / 8 || size < RADV_HEAD || size > all ||
        all != size + (SERIAL_HANDLES + 8 * handles + 127) / 128 * 128)
        return FAIL(level, reason,
                    "its head tells %llu bytes, of which %llu are the structure and %llu handles",
                    (unsigned long long)all, (unsigned long long)size, (unsigned long long)handles);
    level->handles = (uint32_t)handles;
    level->at = at + SERIAL_HANDLES + 8 * handles;
    status = check_head(level, all, size, reason);
    if (status)
        return status;
    level->node = level->at + serial_word(level->at);
    level->slots = (size - serial_word(level->at)) / RADV_SLOT;
    *end = level->begin + all;
    return STATUS_OK;
}

/* --- instances -------------------------------------------------------------------------------- */

static uint64_t handle_of(const struct radv_level *top, uint32_t i)
{
    return serial_long(top->at - 8 * (size_t)(top->handles - i));
}

/* The address that a pointer stands for, without its low six bits. */
static uint64_t address_of(uint64_t pointer)
{
    const uint64_t shifted = (pointer & ~(uint64_t)7) << 19;
    return shifted >> 16 | (shifted >> 63 ? (uint64_t)0xFFFF << 48 : 0);
}

/* The handle, what the node points to and where the nodes begin go together. */
static enum status check_pointers(const struct radv_level *top, const struct tree_dump *dump,
                                  struct reason *reason)
{
    for (uint32_t i = 0; i < dump->tri_count; i++) {
        const uint32_t place = dump->instance[i].below;
        const uint64_t handle = handle_of(top, place),
                       at = address_of(serial_long(radv_instance(top, place, RADV_POINTER)));
        const uint32_t begin = serial_word(radv_instance(top, place, RADV_BEGIN));
        if (handle == 0 || at - begin != handle)
            return FAIL(top, reason,
                        "instance %u has the handle 0x%llx, and points to 0x%llx less %u",
                        dump->instance[i].number, (unsigned long long)handle,
                        (unsigned long long)at, begin);
    }
    return STATUS_OK;
}

/* All handles, or those of the instances that are in the tree: the others may be inactive ones,
 * whose handles may be anything. `list` has room for all. Returns how many are left. */
static uint32_t list_handles(const struct radv_level *top, const struct tree_dump *dump, bool all,
                             struct serial_handle *list)
{
    const uint32_t count = all ? top->handles : dump->tri_count;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t place = all ? i : dump->instance[i].below;
        list[i] = (struct serial_handle){handle_of(top, place), place, 0};
    }
    return serial_handles(list, count);
}

/* Leads each instance to its tree, whose nodes begin where the instance says. */
static enum status link_instances(const struct radv_level *top, const struct serial_handle *list,
                                  uint32_t count, const uint32_t *begins, struct tree_dump *out,
                                  struct reason *reason)
{
    for (uint32_t i = 0; i < out->tri_count; i++) {
        struct dump_instance *instance = &out->instance[i];
        const uint32_t place = instance->below,
                       begin = serial_word(radv_instance(top, place, RADV_BEGIN));
        const struct serial_handle *handle = serial_handle_find(list, count, handle_of(top, place));
        instance->below = out->below_count && handle ? handle->below : DUMP_NO_TREE;
        if (instance->below != DUMP_NO_TREE && begins[instance->below] != begin)
            return FAIL(top, reason, "instance %u has nodes at %u, its structure at %u",
                        instance->number, begin, begins[instance->below]);
    }
    return STATUS_OK;
}

/* --- files ------------------------------------------------------------------------------------ */

static enum status read_one_below(struct radv_level *level, const char *top, const char *at,
                                  struct tree_dump *out, struct reason *reason)
{
    char text[2][SERIAL_UUID_TEXT];
    if (level->handles)
        return FAIL(level, reason, "a top level below another");
    if (memcmp(top + SERIAL_UUID, at + SERIAL_UUID, SERIAL_UUID) != 0)
        return FAIL(level, reason, "of the build %s, below a top level of the build %s",
                    serial_uuid_text(at + SERIAL_UUID, text[0]),
                    serial_uuid_text(top + SERIAL_UUID, text[1]));
    out->format = dump_formats[DUMP_RADV];
    return radv_read_level(level, out, reason);
}

/* Reads the structures behind a top level; `begins` gets where the nodes of each begin. */
static enum status read_below(const char *name, const char *bytes, size_t size, uint64_t begin,
                              uint32_t most, uint32_t *begins, struct tree_dump *out,
                              struct reason *reason)
{
    enum status status = STATUS_OK;
    out->below = begin < size ? alloc_zeroed(most, sizeof *out->below) : NULL;
    if (begin < size && !out->below)
        return fail(reason, STATUS_MEMORY, "%s: no memory for %u trees", name, most);
    while (begin < size && !status) {
        struct radv_level level = {.name = name, .begin = begin};
        const char *at = bytes + begin;
        status = read_head(&level, at, size - begin, &begin, reason);
        if (!status && out->below_count == most)
            return FAIL(&level, reason, "one more than the %u that handles name", most);
        if (!status) {
            begins[out->below_count] = serial_word(level.at);
            status = read_one_below(&level, bytes, at, &out->below[out->below_count++], reason);
        }
    }
    return status;
}

/* Reads what is behind a top level: the structures of all handles, or of those in the tree. */
static enum status read_behind(const struct radv_level *top, const char *bytes, size_t size,
                               uint64_t end, struct tree_dump *out, struct reason *reason)
{
    struct serial_handle *list = alloc_zeroed(top->handles, sizeof *list);
    uint32_t *begins = alloc_zeroed(top->handles, sizeof *begins);
    enum status status = STATUS_OK;
    if (!list || !begins)
        status =
            fail(reason, STATUS_MEMORY, "%s: no memory for %u handles", top->name, top->handles);
    if (!status)
        status = check_pointers(top, out, reason);
    if (!status) {
        const uint32_t all = list_handles(top, out, true, list);
        uint32_t count = all;
        status = read_below(top->name, bytes, size, end, all, begins, out, reason);
        if (out->below_count != all)
            count = list_handles(top, out, false, list);
        if (!status && out->below_count && out->below_count != count)
            status =
                fail(reason, STATUS_INPUT,
                     "%s: %zu structures below the top level, whose handles name %u, and those "
                     "of instances in boxes %u",
                     top->name, out->below_count, all, count);
        if (!status)
            status = link_instances(top, list, count, begins, out, reason);
    }
    free(list);
    free(begins);
    return status;
}

enum status dump_read_radv(const char *name, const char *bytes, size_t size, struct tree_dump *out,
                           struct reason *reason)
{
    struct radv_level level = {.name = name};
    uint64_t end = 0;
    enum status status = read_head(&level, bytes, size, &end, reason);
    if (!status)
        status = radv_read_level(&level, out, reason);
    if (!status && !level.handles && end < size)
        status = fail(reason, STATUS_INPUT, "%s: %llu bytes behind a bottom level", name,
                      (unsigned long long)(size - end));
    if (!status && level.handles)
        status = read_behind(&level, bytes, size, end, out, reason);
    return status || !level.handles ? status : dump_place(out, reason);
}
