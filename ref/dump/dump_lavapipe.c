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
    return fail(reason, STATUS_INPUT, "%s: structure at byte %llu: %s", level->name,
                (unsigned long long)level->begin, rule);
}

bool dump_is_serialised(const char *bytes, size_t size)
{
    if (size < LVP_HANDLES)
        return false;
    const uint64_t all = lvp_long(bytes + LVP_SIZE), handles = lvp_long(bytes + LVP_COUNT);
    return all >= LVP_HANDLES && all <= size && handles <= (all - LVP_HANDLES) / 8 &&
           lvp_long(bytes + LVP_INNER) > 0;
}

/* --- versions --------------------------------------------------------------------------------- */

/* A UUID as the text that it is, or in hexadecimal digits. */
static const char *uuid_text(const char *at, char text[2 * LVP_UUID + 1])
{
    size_t length = 0;
    while (length < LVP_UUID && isgraph((unsigned char)at[length]))
        length++;
    bool is_text = length > 2;
    for (size_t i = length; i < LVP_UUID; i++)
        is_text = is_text && at[i] == 0;
    for (size_t i = 0; i < LVP_UUID; i++)
        snprintf(text + 2 * i, 3, "%02x", (unsigned char)at[i]);
    if (is_text) {
        memcpy(text, at, length);
        text[length] = 0;
    }
    return text;
}

static enum status check_version(const struct lvp_level *level, const char *at,
                                 struct reason *reason)
{
    char text[2][2 * LVP_UUID + 1];
    const char *driver = uuid_text(at, text[0]), *compatible = uuid_text(at + LVP_UUID, text[1]);
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
    if (left < LVP_HANDLES + LVP_HEAD)
        return lavapipe_fail(level, reason, "%llu bytes are left, a head has %u",
                             (unsigned long long)left, LVP_HANDLES + LVP_HEAD);
    enum status status = check_version(level, at, reason);
    if (status)
        return status;
    const uint64_t all = lvp_long(at + LVP_SIZE), size = lvp_long(at + LVP_INNER),
                   handles = lvp_long(at + LVP_COUNT);
    if (all > left)
        return lavapipe_fail(level, reason, "its head tells %llu bytes, and %llu are left",
                             (unsigned long long)all, (unsigned long long)left);
    if (all > UINT32_MAX || handles > all / 8 || size < LVP_HEAD + LVP_BOX ||
        all != LVP_HANDLES + 8 * handles + size)
        return lavapipe_fail(level, reason,
                             "its head tells %llu bytes, of which %llu are the structure and %llu "
                             "handles",
                             (unsigned long long)all, (unsigned long long)size,
                             (unsigned long long)handles);
    level->at = at + LVP_HANDLES + 8 * handles;
    level->size = size;
    level->handles = (uint32_t)handles;
    level->leaf_at = lvp_word(level->at + 32);
    if (lvp_word(level->at + 24) != all || lvp_word(level->at + 28) != handles)
        return lavapipe_fail(level, reason,
                             "its two heads differ: %llu and %u bytes, %llu and %u handles",
                             (unsigned long long)all, lvp_word(level->at + 24),
                             (unsigned long long)handles, lvp_word(level->at + 28));
    if (level->leaf_at > size || level->leaf_at < LVP_HEAD + LVP_BOX ||
        (level->leaf_at - LVP_HEAD) % LVP_BOX != 0)
        return lavapipe_fail(level, reason, "its leaves begin at %u, which is no end of boxes",
                             level->leaf_at);
    *end = level->begin + all;
    return STATUS_OK;
}

/* --- handles ---------------------------------------------------------------------------------- */

/* A handle of the top level. */
struct handle {
    uint64_t value;
    uint32_t first; /* in the list, the place where it comes first */
    uint32_t below; /* which tree it is of */
};

static int by_value(const void *a, const void *b)
{
    const struct handle *x = a, *y = b;
    if (x->value != y->value)
        return x->value < y->value ? -1 : 1;
    return x->first < y->first ? -1 : x->first > y->first;
}

static int by_first(const void *a, const void *b)
{
    const struct handle *x = a, *y = b;
    return x->first < y->first ? -1 : x->first > y->first;
}

/* Sorted by value, each once, numbered by where they first are; 0 is the handle of no tree. */
static enum status list_handles(const struct lvp_level *top, struct handle **out, uint32_t *count,
                                struct reason *reason)
{
    struct handle *list = alloc_zeroed(top->handles, sizeof *list);
    uint32_t kept = 0;
    if (!list)
        return fail(reason, STATUS_MEMORY, "%s: no memory for %u handles", top->name, top->handles);
    for (uint32_t i = 0; i < top->handles; i++)
        list[i] = (struct handle){lvp_long(top->at - 8 * (size_t)(top->handles - i)), i, 0};
    qsort(list, top->handles, sizeof *list, by_value);
    for (uint32_t i = 0; i < top->handles; i++)
        if (list[i].value != 0 && (kept == 0 || list[kept - 1].value != list[i].value))
            list[kept++] = list[i];
    qsort(list, kept, sizeof *list, by_first);
    for (uint32_t i = 0; i < kept; i++)
        list[i].below = i;
    qsort(list, kept, sizeof *list, by_value);
    *out = list;
    *count = kept;
    return STATUS_OK;
}

/* Leads each instance to its tree; put_instance left its place among the leaves. */
static enum status link_instances(const struct lvp_level *top, const struct handle *list,
                                  uint32_t count, struct tree_dump *out, struct reason *reason)
{
    for (uint32_t i = 0; i < out->tri_count; i++) {
        struct dump_instance *instance = &out->instance[i];
        const struct handle wanted = {
            lvp_long(top->at + top->leaf_at + (size_t)LVP_INSTANCE * instance->below), 0, 0};
        uint32_t low = 0, high = count;
        while (low < high) {
            const uint32_t middle = low + (high - low) / 2;
            if (list[middle].value < wanted.value)
                low = middle + 1;
            else
                high = middle;
        }
        if (low == count || list[low].value != wanted.value)
            return lavapipe_fail(top, reason, "instance %u is of 0x%llx, which no handle is",
                                 instance->number, (unsigned long long)wanted.value);
        instance->below = out->below_count ? list[low].below : DUMP_NO_TREE;
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
    struct handle *list = NULL;
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
