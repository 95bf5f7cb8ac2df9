/* Files of lavapipe: one serialised structure, or a top level and then those that its handles name,
 * each once, in the order in which they first do. */
#include "ref/dump/dump_inner.h"

#include "ref/dump/dump_instances.h"
#include "ref/dump/lavapipe.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define VERSION "25.0."

enum status lavapipe_fail(const struct lvp_level *level, struct reason *reason, const char *format,
                          ...)
{
    char rule[200];
    va_list args;
    va_start(args, format);
    vsnprintf(rule, sizeof rule, format, args);
    va_end(args);
    return serial_fail(level->name, level->begin, reason, "%s", rule);
}

/* --- versions --------------------------------------------------------------------------------- */

static enum status check_version(const struct lvp_level *level, const char *at,
                                 struct reason *reason)
{
    char text[2][SERIAL_UUID_TEXT];
    const char *driver = serial_uuid_text(at, text[0]),
               *compatible = serial_uuid_text(at + SERIAL_UUID, text[1]);
    if (!isdigit((unsigned char)driver[0]) || !strchr(driver, '.'))
        return lavapipe_fail(
            level, reason, "of the driver with the UUID %s; lavapipe " VERSION "x is read", driver);
    if (strncmp(driver, VERSION, strlen(VERSION)) != 0)
        return lavapipe_fail(level, reason, "of lavapipe %s; that of lavapipe " VERSION "x is read",
                             driver);
    if (strcmp(driver, compatible) != 0)
        return lavapipe_fail(level, reason, "of lavapipe %s, but compatible with %s", driver,
                             compatible);
    return STATUS_OK;
}

/* --- heads ------------------------------------------------------------------------------------ */

/* Where a structure ends and its parts are. `at` has `left` bytes. */
static enum status read_head(struct lvp_level *level, const char *at, uint64_t left, uint64_t *end,
                             struct reason *reason)
{
    if (left < SERIAL_HANDLES + LVP_HEAD)
        return lavapipe_fail(level, reason, "%llu bytes are left, a head has %u",
                             (unsigned long long)left, SERIAL_HANDLES + LVP_HEAD);
    enum status status = check_version(level, at, reason);
    if (status)
        return status;
    const uint64_t all = serial_long(at + SERIAL_SIZE), size = serial_long(at + SERIAL_INNER),
                   handles = serial_long(at + SERIAL_COUNT);
    if (all > left)
        return lavapipe_fail(level, reason, "its head tells %llu bytes, and %llu are left",
                             (unsigned long long)all, (unsigned long long)left);
    if (all > UINT32_MAX || handles > all / 8 || size < LVP_HEAD + LVP_BOX ||
        all != SERIAL_HANDLES + 8 * handles + size)
        return lavapipe_fail(level, reason,
                             "its head tells %llu bytes, of which %llu are the structure and %llu "
                             "handles",
                             (unsigned long long)all, (unsigned long long)size,
                             (unsigned long long)handles);
    level->at = at + SERIAL_HANDLES + 8 * handles;
    level->size = size;
    level->handles = (uint32_t)handles;
    level->leaf_at = serial_word(level->at + 32);
    if (serial_word(level->at + 24) != all || serial_word(level->at + 28) != handles)
        return lavapipe_fail(level, reason,
                             "its two heads differ: %llu and %u bytes, %llu and %u handles",
                             (unsigned long long)all, serial_word(level->at + 24),
                             (unsigned long long)handles, serial_word(level->at + 28));
    if (level->leaf_at > size || level->leaf_at < LVP_HEAD + LVP_BOX ||
        (level->leaf_at - LVP_HEAD) % LVP_BOX != 0)
        return lavapipe_fail(level, reason, "its leaves begin at %u, which is no end of boxes",
                             level->leaf_at);
    *end = level->begin + all;
    return STATUS_OK;
}

/* --- handles ---------------------------------------------------------------------------------- */

/* Sorted by value, each once, numbered by where they first are; 0 is the handle of no tree. */
static enum status list_handles(const struct lvp_level *top, struct serial_handle **out,
                                uint32_t *count, struct reason *reason)
{
    struct serial_handle *list = alloc_zeroed(top->handles, sizeof *list);
    if (!list)
        return fail(reason, STATUS_MEMORY, "%s: no memory for %u handles", top->name, top->handles);
    for (uint32_t i = 0; i < top->handles; i++)
        list[i] =
            (struct serial_handle){serial_long(top->at - 8 * (size_t)(top->handles - i)), i, 0};
    *out = list;
    *count = serial_handles(list, top->handles);
    return STATUS_OK;
}

/* Leads each instance to its tree; `below` is the place of its leaf. */
static enum status link_instances(const struct lvp_level *top, const struct serial_handle *list,
                                  uint32_t count, struct tree_dump *out, struct reason *reason)
{
    for (uint32_t i = 0; i < out->tri_count; i++) {
        struct dump_instance *instance = &out->instance[i];
        const uint64_t wanted =
            serial_long(top->at + top->leaf_at + (size_t)LVP_INSTANCE * instance->below);
        const struct serial_handle *handle = serial_handle_find(list, count, wanted);
        if (!handle)
            return lavapipe_fail(top, reason, "instance %u is of 0x%llx, which no handle is",
                                 instance->number, (unsigned long long)wanted);
        instance->below = out->below_count ? handle->below : DUMP_NO_TREE;
    }
    return STATUS_OK;
}

/* --- files ------------------------------------------------------------------------------------ */

/* Reads the structures behind a top level. */
static enum status read_below(const char *name, const char *bytes, size_t size, uint64_t begin,
                              uint32_t most, struct tree_dump *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    out->below = begin < size ? alloc_zeroed(most, sizeof *out->below) : NULL;
    if (begin < size && !out->below)
        return fail(reason, STATUS_MEMORY, "%s: no memory for %u trees", name, most);
    while (begin < size && !status) {
        struct lvp_level level = {.name = name, .begin = begin};
        status = read_head(&level, bytes + begin, size - begin, &begin, reason);
        if (!status && out->below_count == most)
            return lavapipe_fail(&level, reason, "one more than the %u that handles name", most);
        if (!status && level.handles)
            return lavapipe_fail(&level, reason, "a top level below another");
        if (!status)
            status = lavapipe_read_level(&level, &out->below[out->below_count++], reason);
    }
    if (!status && out->below_count && out->below_count < most)
        status = fail(reason, STATUS_INPUT,
                      "%s: %zu structures below the top level, whose handles "
                      "name %u",
                      name, out->below_count, most);
    for (size_t i = 0; i < out->below_count; i++)
        out->below[i].format = dump_formats[DUMP_LAVAPIPE];
    return status;
}

enum status dump_read_lavapipe(const char *name, const char *bytes, size_t size,
                               struct tree_dump *out, struct reason *reason)
{
    struct lvp_level level = {.name = name};
    struct serial_handle *list = NULL;
    uint64_t end = 0;
    uint32_t count = 0;
    enum status status = read_head(&level, bytes, size, &end, reason);
    if (!status)
        status = lavapipe_read_level(&level, out, reason);
    if (!status && !level.handles && end < size)
        status = fail(reason, STATUS_INPUT, "%s: %llu bytes behind a bottom level", name,
                      (unsigned long long)(size - end));
    if (status || !level.handles)
        return status;
    status = list_handles(&level, &list, &count, reason);
    if (!status)
        status = read_below(name, bytes, size, end, count, out, reason);
    if (!status)
        status = link_instances(&level, list, count, out, reason);
    free(list);
    return status ? status : dump_place(out, reason);
}
