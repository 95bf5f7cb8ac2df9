#include "scenes/read/ply_header.h"

#include <stdlib.h>
#include <string.h>

/* Names are compared pair by pair: a hostile header must not make that slow. */
#define ELEMENTS_MOST   256
#define PROPERTIES_MOST 4096

void ply_header_free(struct ply_header *header)
{
    free(header->element);
    free(header->property);
    *header = (struct ply_header){0};
}

size_t ply_type_size(enum ply_type type)
{
    static const unsigned char size[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return size[type];
}

static bool same_name(struct ply_name a, struct ply_name b)
{
    return a.length == b.length && memcmp(a.at, b.at, a.length) == 0;
}

bool ply_is_named(struct ply_name name, const char *word)
{
    return same_name(name, (struct ply_name){word, strlen(word)});
}

static struct ply_name next_word(struct scan *scan)
{
    struct ply_name word;
    word.length = scan_word(scan, &word.at);
    return word;
}

/* Takes the next word of the line, or refuses the one before: "`what` is missing". */
static enum status need_word(struct scan *scan, const char *what, struct ply_name *word,
                             struct reason *reason)
{
    *word = next_word(scan);
    return word->length ? STATUS_OK : scan_fail(scan, reason, "%s is missing", what);
}

static enum status read_type(struct scan *scan, enum ply_type *out, struct reason *reason)
{
    static const char *const names[][2] = {
        {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
        {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
    struct ply_name word;
    enum status status = need_word(scan, "a type", &word, reason);
    if (status)
        return status;
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        if (ply_is_named(word, names[i][0]) || ply_is_named(word, names[i][1])) {
            *out = (enum ply_type)i;
            return STATUS_OK;
        }
    }
    scan->at = word.at;
    char shown[SCAN_SHOWN];
    return scan_fail(scan, reason, "%s is no type of a property", scan_show(scan, shown));
}

static enum status read_format(struct scan *scan, struct ply_header *header, struct reason *reason)
{
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    struct ply_name word = next_word(scan), version = next_word(scan);
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        if (ply_is_named(word, names[i]) && ply_is_named(version, "1.0")) {
            header->encoding = (enum ply_encoding)i;
            return STATUS_OK;
        }
    }
    return scan_fail(scan, reason,
                     "format must be ascii, binary_little_endian or "
                     "binary_big_endian, and 1.0");
}

static enum status read_element(struct scan *scan, struct ply_header *header, struct reason *reason)
{
    struct ply_element element = {.first = (uint32_t)header->property_count};
    enum status status = need_word(scan, "the name of the element", &element.name, reason);
    int64_t count = 0;
    if (!status)
        status = scan_whole(scan, "count of the element", &count, reason);
    if (status)
        return status;
    if (count < 0)
        return scan_fail(scan, reason, "the count of an element cannot be %lld", (long long)count);
    for (size_t i = 0; i < header->element_count; i++)
        if (same_name(header->element[i].name, element.name))
            return scan_fail(scan, reason, "an element of this name is already there");
    if (header->element_count == ELEMENTS_MOST)
        return scan_fail(scan, reason, "more than %d elements", ELEMENTS_MOST);
    element.count = (uint64_t)count;
    void *grown = header->element;
    status = array_reserve(&grown, &header->element_capacity, header->element_count + 1,
                           sizeof *header->element);
    header->element = grown;
    if (status)
        return fail(reason, status, "%s: no memory for the header", scan->name);
    header->element[header->element_count++] = element;
    return STATUS_OK;
}

static enum status read_property(struct scan *scan, struct ply_header *header,
                                 struct reason *reason)
{
    if (header->element_count == 0)
        return scan_fail(scan, reason, "a property needs an element above it");
    struct ply_element *element = &header->element[header->element_count - 1];
    struct ply_property property = {0};
    struct scan before = *scan;
    enum status status = STATUS_OK;
    property.list = ply_is_named(next_word(scan), "list");
    if (property.list) {
        status = read_type(scan, &property.count_type, reason);
        if (!status && !ply_type_is_whole(property.count_type))
            return scan_fail(scan, reason, "the length of a list must have an integer type");
    } else {
        *scan = before;
    }
    if (!status)
        status = read_type(scan, &property.type, reason);
    if (!status)
        status = need_word(scan, "the name of the property", &property.name, reason);
    if (status)
        return status;
    for (size_t i = element->first; i < header->property_count; i++)
        if (same_name(header->property[i].name, property.name))
            return scan_fail(scan, reason, "a property of this name is already there");
    if (header->property_count == PROPERTIES_MOST)
        return scan_fail(scan, reason, "more than %d properties", PROPERTIES_MOST);
    void *grown = header->property;
    status = array_reserve(&grown, &header->property_capacity, header->property_count + 1,
                           sizeof *header->property);
    header->property = grown;
    if (status)
        return fail(reason, status, "%s: no memory for the header", scan->name);
    header->property[header->property_count++] = property;
    element->property_count++;
    return STATUS_OK;
}

/* Gives the properties of element `vertex` or `face` their roles. */
static enum status set_roles(const struct scan *scan, struct ply_header *header,
                             const struct ply_element *element, struct reason *reason)
{
    static const struct {
        const char *element, *property;
        enum ply_role role;
    } table[] = {
        {"vertex", "x", PLY_X},
        {"vertex", "y", PLY_Y},
        {"vertex", "z", PLY_Z},
        {"face", "vertex_indices", PLY_CORNERS},
        {"face", "vertex_index", PLY_CORNERS},
    };
    for (uint32_t i = 0; i < element->property_count; i++) {
        struct ply_property *property = &header->property[element->first + i];
        for (size_t k = 0; k < ARRAY_COUNT(table); k++)
            if (ply_is_named(element->name, table[k].element) &&
                ply_is_named(property->name, table[k].property))
                property->role = table[k].role;
        bool corners = property->role == PLY_CORNERS;
        if (property->role != PLY_SKIP && property->list != corners)
            return scan_fail(scan, reason, "property %.*s must %sbe a list",
                             (int)property->name.length, property->name.at, corners ? "" : "not ");
        if (corners && !ply_type_is_whole(property->type))
            return scan_fail(scan, reason, "vertex indices must have an integer type");
    }
    return STATUS_OK;
}

/* Checks that the header has everything that a mesh needs, once. */
static enum status check_header(const struct scan *scan, struct ply_header *header,
                                struct reason *reason)
{
    uint32_t seen[PLY_CORNERS + 1] = {0};
    for (size_t i = 0; i < header->element_count; i++) {
        const struct ply_element *element = &header->element[i];
        if (element->property_count == 0)
            return scan_fail(scan, reason, "element %.*s has no property",
                             element->name.length > 40 ? 40 : (int)element->name.length,
                             element->name.at);
        enum status status = set_roles(scan, header, element, reason);
        if (status)
            return status;
        if (ply_is_named(element->name, "vertex"))
            header->vertex_count = element->count;
    }
    for (size_t i = 0; i < header->property_count; i++)
        seen[header->property[i].role]++;
    if (seen[PLY_X] != 1 || seen[PLY_Y] != 1 || seen[PLY_Z] != 1)
        return scan_fail(scan, reason, "an element vertex with properties x, y, z is needed");
    if (seen[PLY_CORNERS] != 1)
        return scan_fail(scan, reason,
                         "an element face with one list vertex_indices (or "
                         "vertex_index) is needed");
    return STATUS_OK;
}

/* One line of the header, which begins with `word`. */
static enum status read_line(struct scan *scan, struct ply_header *header, struct ply_name word,
                             bool *has_format, struct reason *reason)
{
    enum status status;
    char shown[SCAN_SHOWN];
    if (ply_is_named(word, "comment") || ply_is_named(word, "obj_info"))
        return STATUS_OK;
    if (ply_is_named(word, "format")) {
        if (*has_format)
            return scan_fail(scan, reason, "the format is already given");
        *has_format = true;
        status = read_format(scan, header, reason);
    } else if (ply_is_named(word, "element")) {
        status = read_element(scan, header, reason);
    } else if (ply_is_named(word, "property")) {
        status = read_property(scan, header, reason);
    } else {
        scan->at = word.at;
        return scan_fail(scan, reason, "%s is no keyword of a PLY header", scan_show(scan, shown));
    }
    if (status)
        return status;
    scan_blanks(scan);
    if (!scan_line_done(scan))
        return scan_fail(scan, reason, "%s is too much on this line", scan_show(scan, shown));
    return STATUS_OK;
}

/* Steps over the end of the last line of the header. A "\r" alone ends lines only where it ended
 * the first one: else a byte 10 behind it is the line's, and not the first one of binary data. */
static enum status end_header(struct scan *scan, bool bare_return, struct reason *reason)
{
    scan_blanks(scan);
    if (scan->at == scan->end || !scan_line_done(scan))
        return scan_fail(scan, reason, "a line end must follow end_header");
    if (bare_return && *scan->at == '\r') {
        scan->at++;
        scan->line++;
        return STATUS_OK;
    }
    scan_next_line(scan);
    return STATUS_OK;
}

enum status ply_header_read(struct scan *scan, struct ply_header *out, struct reason *reason)
{
    *out = (struct ply_header){0};
    struct ply_name word = next_word(scan);
    scan_blanks(scan);
    if (!ply_is_named(word, "ply") || !scan_line_done(scan))
        return scan_fail(scan, reason, "a PLY file begins with the line 'ply'");
    bool bare_return = scan->at[0] == '\r' && scan->at[1] != '\n';
    bool has_format = false;
    for (;;) {
        scan_next_line(scan);
        if (scan->at == scan->end)
            return scan_fail(scan, reason, "the header is cut short: no end_header");
        word = next_word(scan);
        if (word.length == 0)
            continue;
        if (ply_is_named(word, "end_header"))
            break;
        enum status status = read_line(scan, out, word, &has_format, reason);
        if (status)
            return status;
    }
    if (!has_format)
        return scan_fail(scan, reason, "the header names no format");
    enum status status = check_header(scan, out, reason);
    return status ? status : end_header(scan, bare_return, reason);
}
