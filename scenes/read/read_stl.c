#include "scenes/read/formats.h"
#include "ref/files/scan.h"
#include "ref/scene/mesh.h"

#include <stdlib.h>
#include <string.h>

#define HEADER   84u /* 80 bytes of text, and the count */
#define TRIANGLE 50u /* a normal, three corners, 2 bytes of attributes */

struct stl {
    struct scan scan;
    struct mesh mesh;
    uint32_t *slot; /* of a hash table of the vertices: 1 + its number, or 0 */
    size_t slots;   /* a power of two */
    struct reason *reason;
};

static enum status no_memory(const struct stl *stl)
{
    return fail(stl->reason, STATUS_MEMORY, "%s: no memory for %zu triangles", stl->scan.name,
                stl->mesh.tri_count + 1);
}

static size_t hash_position(const float position[3])
{
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        hash = (hash ^ float_bits(position[k])) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 32;
    }
    return (size_t)hash;
}

/* The slot of the vertex at a position: its own, or the free one where it belongs. */
static uint32_t *find_slot(const struct stl *stl, const float position[3])
{
    size_t at = hash_position(position) & (stl->slots - 1);
    while (stl->slot[at] &&
           memcmp(stl->mesh.vertex + 3 * (size_t)(stl->slot[at] - 1), position, 12) != 0)
        at = (at + 1) & (stl->slots - 1);
    return &stl->slot[at];
}

/* Doubles the table where one more vertex would make it more than half full. */
static enum status grow_table(struct stl *stl)
{
    if (2 * (stl->mesh.vertex_count + 1) <= stl->slots)
        return STATUS_OK;
    free(stl->slot);
    stl->slots = stl->slots ? 2 * stl->slots : 64;
    stl->slot = alloc_zeroed(stl->slots, sizeof *stl->slot);
    if (!stl->slot)
        return no_memory(stl);
    for (size_t i = 0; i < stl->mesh.vertex_count; i++)
        *find_slot(stl, stl->mesh.vertex + 3 * i) = (uint32_t)i + 1;
    return STATUS_OK;
}

static enum status add_corner(struct stl *stl, const float position[3])
{
    enum status status = grow_table(stl);
    if (status)
        return status;
    uint32_t *slot = find_slot(stl, position);
    if (!*slot) {
        if (mesh_vertex(&stl->mesh, position))
            return no_memory(stl);
        *slot = (uint32_t)stl->mesh.vertex_count;
    }
    return mesh_corner(&stl->mesh, *slot - 1) ? no_memory(stl) : STATUS_OK;
}

/* --- binary ----------------------------------------------------------------------------------- */

static uint32_t get_u32(const char *at)
{
    uint32_t value = 0;
    for (int i = 0; i < 4; i++)
        value |= (uint32_t)(unsigned char)at[i] << (8 * i);
    return value;
}

/* Reads the corners of the triangle at the cursor. */
static enum status read_triangle(struct stl *stl)
{
    mesh_polygon(&stl->mesh);
    for (int c = 0; c < 3; c++) {
        float position[3];
        for (int k = 0; k < 3; k++) {
            const char *at = stl->scan.at + 12 + 12 * c + 4 * k;
            position[k] = float_from_bits(get_u32(at));
            if (float_is_finite(position[k]))
                continue;
            stl->scan.at = at;
            return scan_fail(&stl->scan, stl->reason, "%c is not a finite number", "xyz"[k]);
        }
        enum status status = add_corner(stl, position);
        if (status)
            return status;
    }
    stl->scan.at += TRIANGLE;
    return STATUS_OK;
}

static enum status read_binary(struct stl *stl, uint32_t count)
{
    stl->scan.binary = true;
    stl->scan.at += HEADER;
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < count && !status; i++)
        status = read_triangle(stl);
    return status;
}

/* --- ASCII ------------------------------------------------------------------------------------ */

/* Skips blanks and line ends. */
static void skip_space(struct stl *stl)
{
    scan_blanks(&stl->scan);
    while (stl->scan.at < stl->scan.end && scan_line_done(&stl->scan)) {
        scan_next_line(&stl->scan);
        scan_blanks(&stl->scan);
    }
}

/* True if the word at the cursor is `word`, in small or capital letters; it is then read. */
static bool take_word(struct stl *stl, const char *word)
{
    skip_space(stl);
    struct scan ahead = stl->scan;
    const char *start;
    size_t length = scan_word(&ahead, &start);
    if (length != strlen(word))
        return false;
    for (size_t i = 0; i < length; i++)
        if ((start[i] >= 'A' && start[i] <= 'Z' ? start[i] + ('a' - 'A') : start[i]) != word[i])
            return false;
    stl->scan = ahead;
    return true;
}

static enum status need_word(struct stl *stl, const char *word)
{
    char shown[SCAN_SHOWN];
    if (take_word(stl, word))
        return STATUS_OK;
    return scan_fail(&stl->scan, stl->reason, "'%s' must stand here, not %s", word,
                     scan_show(&stl->scan, shown));
}

static enum status read_floats(struct stl *stl, float out[3])
{
    static const char *const axis[] = {"x", "y", "z"};
    enum status status = STATUS_OK;
    for (int k = 0; k < 3 && !status; k++) {
        skip_space(stl);
        status = scan_float(&stl->scan, axis[k], &out[k], stl->reason);
    }
    return status;
}

/* A normal is three words; some programs write NaN for that of a triangle without area. */
static enum status skip_normal(struct stl *stl)
{
    enum status status = need_word(stl, "normal");
    for (int k = 0; k < 3 && !status; k++) {
        const char *word;
        skip_space(stl);
        if (scan_word(&stl->scan, &word) == 0)
            status = scan_fail(&stl->scan, stl->reason, "the normal is cut short");
    }
    return status;
}

/* Reads what follows "facet". */
static enum status read_facet(struct stl *stl)
{
    enum status status = skip_normal(stl);
    if (!status)
        status = need_word(stl, "outer");
    if (!status)
        status = need_word(stl, "loop");
    mesh_polygon(&stl->mesh);
    for (int c = 0; c < 3 && !status; c++) {
        float position[3];
        status = need_word(stl, "vertex");
        if (!status)
            status = read_floats(stl, position);
        if (!status)
            status = add_corner(stl, position);
    }
    if (!status)
        status = need_word(stl, "endloop");
    return status ? status : need_word(stl, "endfacet");
}

/* Reads solids; the name of one is the rest of its line. */
static enum status read_ascii(struct stl *stl)
{
    enum status status = STATUS_OK;
    while (!status && take_word(stl, "solid")) {
        scan_next_line(&stl->scan);
        while (!status && take_word(stl, "facet"))
            status = read_facet(stl);
        if (!status)
            status = need_word(stl, "endsolid");
        if (!status)
            scan_next_line(&stl->scan);
        skip_space(stl);
    }
    if (!status && stl->scan.at < stl->scan.end)
        status = need_word(stl, "solid");
    return status;
}

/* Whether the file begins as ASCII ones do. The header of a binary one that is cut short may, too,
 * but 0 follows. */
static bool is_ascii(struct stl *stl, size_t size)
{
    struct scan start = stl->scan;
    bool solid = take_word(stl, "solid");
    stl->scan = start;
    return solid && !memchr(start.at, '\0', size);
}

enum status read_stl(const char *name, const char *bytes, size_t size, struct scene *out,
                     struct reason *reason)
{
    *out = (struct scene){0};
    struct stl stl = {.scan = scan_make(name, bytes, size), .reason = reason};
    uint64_t count = size >= HEADER ? get_u32(bytes + HEADER - 4) : 0;
    uint64_t whole = HEADER + TRIANGLE * count;
    enum status status;
    if (size >= HEADER && size == whole)
        status = read_binary(&stl, (uint32_t)count);
    else if (is_ascii(&stl, size))
        status = read_ascii(&stl);
    else if (size < HEADER)
        status = fail(reason, STATUS_INPUT,
                      "%s: begins with no \"solid\", and is shorter than the %u bytes before the "
                      "triangles of a binary STL file",
                      name, HEADER);
    else
        status = fail(reason, STATUS_INPUT,
                      "%s: byte 80: %llu triangles take %llu bytes, but the file has %zu (one in "
                      "ASCII begins with \"solid\")",
                      name, (unsigned long long)count, (unsigned long long)whole, size);
    free(stl.slot);
    if (!status)
        return mesh_finish(&stl.mesh, name, out, reason);
    mesh_free(&stl.mesh);
    return status;
}
