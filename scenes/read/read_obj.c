#include "scenes/read/formats.h"
#include "ref/scene/mesh.h"
#include "ref/files/scan.h"

#include <string.h>

/* What is known above the line being read. */
struct obj {
    struct scan scan;
    struct mesh mesh;
    size_t texture_count, normal_count;
};

static bool is_word(const char *word, size_t length, const char *keyword)
{
    return length == strlen(keyword) && memcmp(word, keyword, length) == 0;
}

/* Letters, digits and '_', not beginning with a digit: anything that a keyword could be. */
static bool is_keyword(const char *word, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        char c = word[i];
        bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
        if (!letter && (i == 0 || c < '0' || c > '9'))
            return false;
    }
    return length > 0;
}

static enum status read_position(struct obj *obj, struct reason *reason)
{
    static const char *const what[] = {"x",        "y",        "z",       "number 4",
                                       "number 5", "number 6", "number 7"};
    float number[ARRAY_COUNT(what)];
    size_t count = 0;
    for (; count < 3 || !scan_line_done(&obj->scan); count++) {
        if (count == ARRAY_COUNT(what))
            break;
        enum status status = scan_float(&obj->scan, what[count], &number[count], reason);
        if (status)
            return status;
        scan_blanks(&obj->scan);
    }
    if (count == 5 || !scan_line_done(&obj->scan))
        return scan_fail(&obj->scan, reason,
                         "v has %s numbers; 3, 4 (a weight), 6 or 7 (a colour) are allowed",
                         count == 5 ? "5" : "more than 7");
    enum status status = mesh_vertex(&obj->mesh, number);
    if (status)
        return fail(reason, status, "%s: no room for %zu vertices", obj->scan.name,
                    obj->mesh.vertex_count + 1);
    return STATUS_OK;
}

/* Reads one index at the cursor and turns it into 0 .. count-1. */
static enum status read_index(struct obj *obj, const char *what, size_t count, size_t *out,
                              struct reason *reason)
{
    char shown[SCAN_SHOWN];
    struct scan before = obj->scan;
    int64_t index;
    if (!scan_digits(&obj->scan, &index))
        return scan_fail(&before, reason,
                         "corner: at %s a %s index is missing; allowed are v, v/vt, v//vn, "
                         "v/vt/vn",
                         scan_show(&before, shown), what);
    if (index == 0)
        return scan_fail(&before, reason, "%s index 0; they count from 1", what);
    if (index > (int64_t)count || -index > (int64_t)count)
        return scan_fail(&before, reason, "%s index %lld, but %zu stand above this line", what,
                         (long long)index, count);
    *out = (size_t)(index > 0 ? index - 1 : (int64_t)count + index);
    return STATUS_OK;
}

static enum status read_corner(struct obj *obj, struct reason *reason)
{
    size_t vertex, ignored;
    enum status status = read_index(obj, "vertex", obj->mesh.vertex_count, &vertex, reason);
    if (!status && *obj->scan.at == '/') {
        obj->scan.at++;
        if (*obj->scan.at != '/')
            status = read_index(obj, "texture", obj->texture_count, &ignored, reason);
        if (!status && *obj->scan.at == '/') {
            obj->scan.at++;
            status = read_index(obj, "normal", obj->normal_count, &ignored, reason);
        }
    }
    if (status)
        return status;
    char shown[SCAN_SHOWN];
    if (!scan_word_done(&obj->scan))
        return scan_fail(&obj->scan, reason,
                         "corner ends in %s; allowed are v, v/vt, v//vn, "
                         "v/vt/vn",
                         scan_show(&obj->scan, shown));
    status = mesh_corner(&obj->mesh, (uint32_t)vertex);
    if (status == STATUS_LIMIT)
        return scan_fail(&obj->scan, reason, "polygon with more than %d corners",
                         MESH_CORNERS_MOST);
    if (status)
        return fail(reason, status, "%s: no memory for %zu triangles", obj->scan.name,
                    obj->mesh.tri_count + 1);
    return STATUS_OK;
}

static enum status read_face(struct obj *obj, struct reason *reason)
{
    mesh_polygon(&obj->mesh);
    scan_blanks(&obj->scan);
    while (!scan_line_done(&obj->scan)) {
        enum status status = read_corner(obj, reason);
        if (status)
            return status;
        scan_blanks(&obj->scan);
    }
    if (obj->mesh.corners < 3)
        return scan_fail(&obj->scan, reason, "face with %u corners; at least 3 are needed",
                         obj->mesh.corners);
    return STATUS_OK;
}

static enum status read_line(struct obj *obj, struct reason *reason)
{
    struct scan before = obj->scan;
    const char *word;
    size_t length = scan_word(&obj->scan, &word);
    enum status status = STATUS_OK;
    if (is_word(word, length, "v"))
        status = read_position(obj, reason);
    else if (is_word(word, length, "f"))
        status = read_face(obj, reason);
    else if (is_word(word, length, "vt"))
        obj->texture_count++;
    else if (is_word(word, length, "vn"))
        obj->normal_count++;
    else if (length > 0 && !is_keyword(word, length)) {
        char shown[SCAN_SHOWN];
        scan_blanks(&before);
        status = scan_fail(&before, reason, "%s is no keyword of an OBJ file",
                           scan_show(&before, shown));
    }
    return status;
}

enum status read_obj(const char *name, const char *bytes, size_t size, struct scene *out,
                     struct reason *reason)
{
    *out = (struct scene){0};
    struct obj obj = {.scan = scan_make(name, bytes, size)};
    obj.scan.joins = true;
    obj.scan.comment = '#';
    if (size >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0)
        obj.scan.at += 3; /* the mark some editors put before UTF-8 */
    while (obj.scan.at < obj.scan.end) {
        enum status status = read_line(&obj, reason);
        if (status) {
            mesh_free(&obj.mesh);
            return status;
        }
        scan_next_line(&obj.scan);
    }
    return mesh_finish(&obj.mesh, name, out, reason);
}
