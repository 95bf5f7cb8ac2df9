#include "ref/packed/packed_file.h"
#include "ref/base/invariant.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

#define NAME_BYTES 16

struct head {
    char magic[4];
    uint32_t version;
    char layout[NAME_BYTES];
    uint32_t record_bytes, records, items, root, triangles, stack;
};

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
               "words are written as they lie in memory");
_Static_assert(sizeof(struct head) == 12 * 4, "no padding");

void packed_file_write(const struct packed *packed, FILE *stream)
{
    struct head head = {.magic = "RDPK",
                        .version = PACKED_FILE_VERSION,
                        .record_bytes = packed->layout->node_bytes,
                        .records = packed->node_count,
                        .items = packed->item_count,
                        .root = packed->root,
                        .triangles = packed->tri_count,
                        .stack = packed->stack_need};
    invariant(packed->store == tri_stores[0]); /* the file has no field for the storage */
    size_t length = strlen(packed->layout->name);
    memcpy(head.layout, packed->layout->name, length < NAME_BYTES ? length : NAME_BYTES);
    fwrite(&head, sizeof head, 1, stream);
    if (packed->word_count)
        fwrite(packed->word, 4, packed->word_count, stream);
    if (packed->item_count)
        fwrite(packed->item, 4, packed->item_count, stream);
}

bool packed_file_is(const char *bytes, size_t size)
{
    return size >= 4 && memcmp(bytes, "RDPK", 4) == 0;
}

/* Finds the layout of that name, which must be padded with zeros; NULL if there is none. */
static const struct layout *find_layout(const char name[NAME_BYTES])
{
    char text[NAME_BYTES + 1] = "", padded[NAME_BYTES] = "";
    memcpy(text, name, NAME_BYTES);
    const struct layout *layout = layout_find(text);
    if (layout)
        memcpy(padded, layout->name, strlen(layout->name));
    return layout && memcmp(padded, name, NAME_BYTES) == 0 ? layout : NULL;
}

static enum status check_head(const char *name, const struct head *head, size_t size,
                              const struct scene *scene, const struct layout **layout,
                              struct reason *reason)
{
    *layout = find_layout(head->layout);
    if (head->version != PACKED_FILE_VERSION)
        return fail(reason, STATUS_INPUT, "%s: version %u; this program reads %u", name,
                    head->version, PACKED_FILE_VERSION);
    if (!*layout)
        return fail(reason, STATUS_INPUT, "%s: names no layout (raydiff list layouts)", name);
    if ((*layout)->outside) /* its load() has not been checked on these words */
        return fail(reason, STATUS_INPUT, "%s: is in %s, a layout from outside: those are not read",
                    name, (*layout)->name);
    if (head->record_bytes != (*layout)->node_bytes)
        return fail(reason, STATUS_INPUT, "%s: records of %u bytes, those of %s have %u", name,
                    head->record_bytes, (*layout)->name, (*layout)->node_bytes);
    uint64_t words = (uint64_t)head->records * (head->record_bytes / 4);
    uint64_t needed = sizeof *head + 4 * (words + head->items);
    if (words > UINT32_MAX || needed != size)
        return fail(reason, STATUS_INPUT, "%s: %u records and %u items are %llu bytes, not %zu",
                    name, head->records, head->items, (unsigned long long)needed, size);
    if (head->triangles != scene->tri_count)
        return fail(reason, STATUS_INPUT, "%s: is of %u triangles, the scene has %u", name,
                    head->triangles, scene->tri_count);
    if (head->stack > layout_stack_most(*layout))
        return fail(reason, STATUS_INPUT, "%s: needs %u stack entries, at most %u are possible",
                    name, head->stack, layout_stack_most(*layout));
    return STATUS_OK;
}

/* Copies `count` words; *out is NULL if there are none. False if out of memory. */
static bool copy_words(const char *bytes, uint32_t count, uint32_t **out)
{
    *out = count ? alloc_copy(bytes, count, sizeof **out) : NULL;
    return *out || !count;
}

static bool is_unsafe(const struct packed_faults *faults)
{
    return faults->bad_refs || faults->cycles || faults->bad_prims || faults->too_deep;
}

/* Runs packed_check; a fault is an error only if it makes the tree unsafe. A tree that names every
 * triangle, and some in several leaves, is taken as a split tree. Faithful layouts are exempt: they
 * name triangles other than those meant. */
static enum status check_tree(const char *name, struct packed *packed, const struct scene *scene,
                              struct packed_faults *faults, struct reason *reason)
{
    struct packed_faults found;
    struct reason why = {""};
    enum status status = packed_check(packed, scene, &found, &why);
    if (found.double_prims && !found.lost_prims && !is_unsafe(&found) &&
        !packed->layout->faithful) {
        packed->split = true;
        why.text[0] = '\0';
        status = packed_check(packed, scene, &found, &why);
    }
    if (faults)
        *faults = found;
    if (status)
        (void)fail(reason, status, "%s: %s", name, why.text);
    return status == STATUS_INPUT && !is_unsafe(&found) ? STATUS_OK : status;
}

enum status packed_file_read(const char *name, const char *bytes, size_t size,
                             const struct scene *scene, struct packed *out,
                             struct packed_faults *faults, struct reason *reason)
{
    struct head head;
    const struct layout *layout;
    *out = (struct packed){0};
    if (faults)
        *faults = (struct packed_faults){0};
    if (reason)
        reason->text[0] = '\0';
    if (!packed_file_is(bytes, size) || size < sizeof head)
        return fail(reason, STATUS_INPUT, "%s: does not begin as a packed tree does, with 'RDPK'",
                    name);
    memcpy(&head, bytes, sizeof head);
    enum status status = check_head(name, &head, size, scene, &layout, reason);
    if (status)
        return status;
    *out = (struct packed){.layout = layout,
                           .store = tri_stores[0],
                           .word_count = head.records * (head.record_bytes / 4),
                           .item_count = head.items,
                           .node_count = head.records,
                           .ref_count = head.records * layout_refs(layout),
                           .root = head.root,
                           .tri_count = head.triangles,
                           .stack_need = head.stack};
    bytes += sizeof head;
    if (!copy_words(bytes, out->word_count, &out->word) ||
        !copy_words(bytes + 4 * (size_t)out->word_count, out->item_count, &out->item))
        status = fail(reason, STATUS_MEMORY, "%s: no memory for %u records", name, head.records);
    if (!status)
        status = check_tree(name, out, scene, faults, reason);
    if (status)
        packed_free(out);
    return status;
}
