/* Our own text of trees, line by line. docs/formats.md has its grammar. */
#include "ref/dump/dump_inner.h"

#include "ref/base/float_word.h"
#include "ref/files/scan.h"
#include "ref/scene/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct dump_reading {
    struct scan scan;
    struct dump_making making;
    struct mesh mesh;
    bool ended;
    struct reason *reason;
};

static enum status no_memory(struct dump_reading *r, enum status status)
{
    if (status == STATUS_LIMIT)
        return scan_fail(&r->scan, r->reason, "more than 2^32 - 2 numbers of a kind");
    return fail(r->reason, status, "%s: no memory for the tree", r->scan.name);
}

/* A NaN as printf writes it: nan, -nan, nan(ind); not the form with bits. */
static bool take_nan(struct scan *scan, float *out)
{
    struct scan ahead = *scan;
    const char *word;
    size_t length = scan_word(&ahead, &word);
    size_t sign = length > 0 && *word == '-';
    if (length < sign + 3 || memcmp(word + sign, "nan", 3) != 0 ||
        (length > sign + 3 && word[sign + 3] != '('))
        return false;
    *scan = ahead;
    *out = NAN;
    return true;
}

static enum status take_float(struct dump_reading *r, const char *what, float *out)
{
    char shown[SCAN_SHOWN];
    const char *rule = "";
    scan_blanks(&r->scan);
    if (take_nan(&r->scan, out))
        return STATUS_OK;
    const char *start = r->scan.at, *end = float_word_read(start, out, &rule);
    if (end)
        r->scan.at = end;
    if (end && scan_word_done(&r->scan))
        return STATUS_OK;
    r->scan.at = start;
    return scan_fail(&r->scan, r->reason, "%s: %s is %s", what, scan_show(&r->scan, shown),
                     end || !*rule ? "not a number" : rule);
}

static enum status take_number(struct dump_reading *r, const char *what, uint32_t *out)
{
    int64_t whole;
    enum status status = scan_whole(&r->scan, what, &whole, r->reason);
    if (!status && (whole < 0 || whole > UINT32_MAX))
        status =
            scan_fail(&r->scan, r->reason, "%s: not a whole number from 0 to 4294967295", what);
    *out = status ? 0 : (uint32_t)whole;
    return status;
}

static enum status take_node(struct dump_reading *r, bool leaf)
{
    static const char *const side[] = {"least x", "least y", "least z",
                                       "most x",  "most y",  "most z"};
    struct box box;
    enum status status = STATUS_OK;
    for (int k = 0; k < 6 && !status; k++)
        status = take_float(r, side[k], k < 3 ? &box.lo[k] : &box.hi[k - 3]);
    if (status)
        return status;
    if ((status = dump_add_node(&r->making, leaf, &box)) != STATUS_OK)
        return no_memory(r, status);
    for (scan_blanks(&r->scan); !scan_line_done(&r->scan) && !status; scan_blanks(&r->scan)) {
        uint32_t number;
        status = take_number(r, leaf ? "triangle" : "child", &number);
        if (!status && (status = dump_add_link(&r->making, number)) != STATUS_OK)
            status = no_memory(r, status);
    }
    return status;
}

static enum status read_leaf(struct dump_reading *r)
{
    return take_node(r, true);
}

static enum status read_node(struct dump_reading *r)
{
    return take_node(r, false);
}

static enum status read_vertex(struct dump_reading *r)
{
    float position[3];
    enum status status = STATUS_OK;
    for (int k = 0; k < 3 && !status; k++) {
        status = take_float(r, "coordinate", &position[k]);
        if (!status && !float_is_finite(position[k]))
            status = scan_fail(&r->scan, r->reason, "a vertex that is not finite");
    }
    if (!status && (status = mesh_vertex(&r->mesh, position)) != STATUS_OK)
        status = no_memory(r, status);
    return status;
}

static enum status read_triangle(struct dump_reading *r)
{
    enum status status = STATUS_OK;
    mesh_polygon(&r->mesh);
    for (int c = 0; c < 3 && !status; c++) {
        uint32_t vertex;
        status = take_number(r, "vertex", &vertex);
        if (!status && (status = mesh_corner(&r->mesh, vertex)) != STATUS_OK)
            status = no_memory(r, status);
    }
    return status;
}

/* The name is the rest of the line, its blanks at the end left out. */
static enum status read_scene(struct dump_reading *r)
{
    scan_blanks(&r->scan);
    const char *start = r->scan.at, *end = start, *word;
    for (size_t length; (length = scan_word(&r->scan, &word)) > 0;)
        end = word + length;
    for (const char *at = start; at < end; at++)
        if ((unsigned char)*at < 0x20 || *at == 0x7F)
            return scan_fail(&r->scan, r->reason, "scene: a byte that is no letter");
    if (end == start)
        return scan_fail(&r->scan, r->reason, "scene: no name");
    if (r->making.dump.spec)
        return scan_fail(&r->scan, r->reason, "a second scene");
    r->making.dump.spec = alloc_zeroed((size_t)(end - start) + 1, 1);
    if (!r->making.dump.spec)
        return no_memory(r, STATUS_MEMORY);
    memcpy(r->making.dump.spec, start, (size_t)(end - start));
    return STATUS_OK;
}

static enum status read_splits(struct dump_reading *r)
{
    r->making.dump.splits = true;
    return STATUS_OK;
}

static enum status read_bytes(struct dump_reading *r)
{
    int64_t bytes;
    enum status status = scan_whole(&r->scan, "bytes", &bytes, r->reason);
    if (!status && bytes < 0)
        status = scan_fail(&r->scan, r->reason, "bytes: below 0");
    r->making.dump.bytes = status ? 0 : (uint64_t)bytes;
    return status;
}

static enum status read_end(struct dump_reading *r)
{
    r->ended = true;
    return STATUS_OK;
}

static enum status read_line(struct dump_reading *r)
{
    static const struct {
        const char *word;
        enum status (*read)(struct dump_reading *r);
    } lines[] = {{"node", read_node},         {"leaf", read_leaf},
                 {"vertex", read_vertex},     {"scene", read_scene},
                 {"triangle", read_triangle}, {"bytes", read_bytes},
                 {"splits", read_splits},     {"end", read_end}};
    char shown[SCAN_SHOWN];
    const char *word, *before = r->scan.at;
    size_t length = scan_word(&r->scan, &word);
    if (length == 0)
        return STATUS_OK;
    if (r->ended)
        return scan_fail(&r->scan, r->reason, "a line after 'end'");
    for (size_t i = 0; i < ARRAY_COUNT(lines); i++) {
        if (strlen(lines[i].word) != length || memcmp(word, lines[i].word, length) != 0)
            continue;
        enum status status = lines[i].read(r);
        scan_blanks(&r->scan);
        if (!status && !scan_line_done(&r->scan))
            status = scan_fail(&r->scan, r->reason, "%s after the line's last value",
                               scan_show(&r->scan, shown));
        return status;
    }
    r->scan.at = before;
    scan_blanks(&r->scan);
    return scan_fail(&r->scan, r->reason,
                     "%s: a line is scene, vertex, triangle, splits, bytes, node, leaf or end",
                     scan_show(&r->scan, shown));
}

/* The first line: the format's name and version. */
static enum status read_magic(struct dump_reading *r)
{
    static const char *const word[] = {"raydiff", "tree"};
    char shown[SCAN_SHOWN];
    for (size_t i = 0; i < ARRAY_COUNT(word); i++) {
        const char *at;
        if (scan_word(&r->scan, &at) != strlen(word[i]) || memcmp(at, word[i], strlen(word[i])))
            return scan_fail(&r->scan, r->reason, "does not begin with '" DUMP_MAGIC "1'");
    }
    const char *version;
    struct scan before = r->scan;
    scan_blanks(&before);
    if (scan_word(&r->scan, &version) != 1 || *version != '1')
        return scan_fail(&r->scan, r->reason, "version %s; this reads version 1",
                         scan_show(&before, shown));
    scan_blanks(&r->scan);
    if (!scan_line_done(&r->scan))
        return scan_fail(&r->scan, r->reason, "%s after the version", scan_show(&r->scan, shown));
    scan_next_line(&r->scan);
    return STATUS_OK;
}

enum status dump_read_text(const char *name, const char *bytes, size_t size, struct tree_dump *out,
                           struct reason *reason)
{
    struct dump_reading r = {.scan = scan_make(name, bytes, size), .reason = reason};
    r.scan.comment = '#';
    enum status status = read_magic(&r);
    while (!status && r.scan.at < r.scan.end) {
        status = read_line(&r);
        if (!status)
            scan_next_line(&r.scan);
    }
    if (!status && !r.ended)
        status = scan_fail(&r.scan, reason, "is cut short: no line 'end'");
    if (!status && (r.mesh.tri_count || r.mesh.vertex_count)) {
        status = r.making.dump.spec
                     ? fail(reason, STATUS_INPUT, "%s: has vertices and names a scene", name)
                     : mesh_finish(&r.mesh, name, &r.making.dump.scene, reason);
        r.making.dump.tri_count = r.making.dump.scene.tri_count;
        r.making.dump.tri_known = true;
    }
    mesh_free(&r.mesh);
    *out = r.making.dump;
    return status;
}
