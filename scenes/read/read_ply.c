#include "scenes/read/formats.h"
#include "ref/scene/mesh.h"
#include "scenes/read/ply_header.h"
#include "ref/files/scan.h"

#include <math.h>
#include <string.h>

struct ply {
    struct scan scan; /* binary: `at` is the next byte of the data */
    struct ply_header header;
    struct mesh mesh;
    float position[3]; /* of the vertex being read */
    struct reason *reason;
};

/* Takes `size` bytes of binary data, low byte first; at most 8. */
static enum status take(struct ply *ply, size_t size, uint64_t *out)
{
    *out = 0;
    if ((size_t)(ply->scan.end - ply->scan.at) < size)
        return scan_fail(&ply->scan, ply->reason, "the data are cut short");
    for (size_t i = 0; i < size; i++) {
        size_t byte = ply->header.encoding == PLY_LITTLE ? i : size - 1 - i;
        *out |= (uint64_t)(unsigned char)ply->scan.at[i] << (8 * byte);
    }
    ply->scan.at += size;
    return STATUS_OK;
}

/* Sign-extends the low `size` bytes. */
static int64_t extend(uint64_t bits, size_t size)
{
    uint64_t sign = UINT64_C(1) << (8 * size - 1);
    return (int64_t)((bits ^ sign) - sign);
}

/* A whole number of a list's length or of an index. */
static enum status take_whole(struct ply *ply, enum ply_type type, const char *what, int64_t *out)
{
    if (ply->header.encoding == PLY_ASCII)
        return scan_whole(&ply->scan, what, out, ply->reason);
    uint64_t bits;
    size_t size = ply_type_size(type);
    enum status status = take(ply, size, &bits);
    bool is_signed = type == PLY_INT8 || type == PLY_INT16 || type == PLY_INT32;
    *out = is_signed ? extend(bits, size) : (int64_t)bits;
    return status;
}

/* A coordinate, of any type, as the nearest float. */
static enum status take_float(struct ply *ply, enum ply_type type, const char *what, float *out)
{
    if (ply->header.encoding == PLY_ASCII)
        return scan_float(&ply->scan, what, out, ply->reason);
    const char *start = ply->scan.at;
    uint64_t bits;
    int64_t whole;
    enum status status;
    double value = 0;
    if (ply_type_is_whole(type)) {
        status = take_whole(ply, type, what, &whole);
        value = (double)whole;
    } else {
        status = take(ply, ply_type_size(type), &bits);
        if (type == PLY_FLOAT32)
            value = (double)float_from_bits((uint32_t)bits);
        else
            memcpy(&value, &bits, sizeof value);
    }
    if (status)
        return status;
    /* From this double on, rounding to float gives infinity; NaN fails the comparison. */
    if (fabs(value) < 0x1.ffffffp127) {
        *out = (float)value;
        return STATUS_OK;
    }
    ply->scan.at = start;
    return scan_fail(&ply->scan, ply->reason, "%s is not a finite 32-bit float", what);
}

/* Skips one value that is not needed. */
static enum status skip_value(struct ply *ply, enum ply_type type)
{
    if (ply->header.encoding != PLY_ASCII) {
        uint64_t bits;
        return take(ply, ply_type_size(type), &bits);
    }
    const char *word;
    if (scan_word(&ply->scan, &word) == 0)
        return scan_fail(&ply->scan, ply->reason, "the line has too few values");
    return STATUS_OK;
}

static enum status add_corner(struct ply *ply, enum ply_type type)
{
    struct scan before = ply->scan;
    int64_t index;
    enum status status = take_whole(ply, type, "vertex index", &index);
    if (status)
        return status;
    if (index < 0 || (uint64_t)index >= ply->header.vertex_count)
        return scan_fail(&before, ply->reason, "vertex index %lld, but there are %llu vertices",
                         (long long)index, (unsigned long long)ply->header.vertex_count);
    status = mesh_corner(&ply->mesh, (uint32_t)index);
    if (status == STATUS_LIMIT)
        return scan_fail(&before, ply->reason, "more than 4294967294 triangles");
    if (status)
        return fail(ply->reason, status, "%s: no memory for %zu triangles", ply->scan.name,
                    ply->mesh.tri_count + 1);
    return STATUS_OK;
}

static enum status read_list(struct ply *ply, const struct ply_property *property)
{
    struct scan before = ply->scan;
    int64_t count;
    enum status status = take_whole(ply, property->count_type, "length of the list", &count);
    if (status)
        return status;
    if (count < 0)
        return scan_fail(&before, ply->reason, "a list of %lld values", (long long)count);
    bool corners = property->role == PLY_CORNERS;
    if (corners && count < 3)
        return scan_fail(&before, ply->reason, "face with %lld corners; at least 3 are needed",
                         (long long)count);
    if (corners && count > MESH_CORNERS_MOST)
        return scan_fail(&before, ply->reason, "polygon with more than %d corners",
                         MESH_CORNERS_MOST);
    if (corners)
        mesh_polygon(&ply->mesh);
    for (int64_t i = 0; i < count && !status; i++)
        status = corners ? add_corner(ply, property->type) : skip_value(ply, property->type);
    return status;
}

static enum status read_property(struct ply *ply, const struct ply_property *property)
{
    static const char *const axis[] = {[PLY_X] = "x", [PLY_Y] = "y", [PLY_Z] = "z"};
    switch (property->role) {
    case PLY_X:
    case PLY_Y:
    case PLY_Z:
        return take_float(ply, property->type, axis[property->role],
                          &ply->position[property->role - PLY_X]);
    case PLY_CORNERS:
        return read_list(ply, property);
    case PLY_SKIP:
        break;
    }
    return property->list ? read_list(ply, property) : skip_value(ply, property->type);
}

/* Goes to the start of the next line that has a word; ascii only. */
static void start_line(struct ply *ply)
{
    scan_blanks(&ply->scan);
    while (ply->scan.at < ply->scan.end && scan_line_done(&ply->scan)) {
        scan_next_line(&ply->scan);
        scan_blanks(&ply->scan);
    }
}

/* Reads one vertex, face or other element. */
static enum status read_one(struct ply *ply, const struct ply_element *element)
{
    bool ascii = ply->header.encoding == PLY_ASCII;
    if (ascii)
        start_line(ply);
    if (ply->scan.at == ply->scan.end)
        return scan_fail(&ply->scan, ply->reason, "the data are cut short");
    for (uint32_t k = 0; k < element->property_count; k++) {
        enum status status = read_property(ply, &ply->header.property[element->first + k]);
        if (status)
            return status;
    }
    if (!ascii)
        return STATUS_OK;
    char shown[SCAN_SHOWN];
    scan_blanks(&ply->scan);
    if (!scan_line_done(&ply->scan))
        return scan_fail(&ply->scan, ply->reason, "%s is more than the header promises",
                         scan_show(&ply->scan, shown));
    return STATUS_OK;
}

/* An element needs at least this many bytes: empty lists, and one digit with a blank in ascii. */
static size_t least_size(const struct ply *ply, const struct ply_element *element)
{
    size_t size = 0;
    for (uint32_t k = 0; k < element->property_count; k++) {
        const struct ply_property *property = &ply->header.property[element->first + k];
        if (ply->header.encoding == PLY_ASCII)
            size += 2;
        else
            size += ply_type_size(property->list ? property->count_type : property->type);
    }
    return size;
}

static enum status read_element(struct ply *ply, const struct ply_element *element)
{
    /* The last value of an ascii file needs no blank behind it. */
    size_t left = (size_t)(ply->scan.end - ply->scan.at);
    size_t least = least_size(ply, element);
    if (element->count > (left + (ply->header.encoding == PLY_ASCII)) / least)
        return scan_fail(&ply->scan, ply->reason,
                         "%llu elements of at least %zu bytes do not fit into the %zu bytes left",
                         (unsigned long long)element->count, least, left);
    bool vertex = ply_is_named(element->name, "vertex");
    for (uint64_t i = 0; i < element->count; i++) {
        enum status status = read_one(ply, element);
        if (status)
            return status;
        if (vertex)
            status = mesh_vertex(&ply->mesh, ply->position);
        if (status)
            return fail(ply->reason, status, "%s: no room for %llu vertices", ply->scan.name,
                        (unsigned long long)element->count);
    }
    return STATUS_OK;
}

/* Nothing but blanks may follow. */
static enum status check_end(struct ply *ply)
{
    ply->scan.binary = ply->header.encoding != PLY_ASCII;
    const char *at = ply->scan.at;
    while (at < ply->scan.end && (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r'))
        at++;
    if (at == ply->scan.end)
        return STATUS_OK;
    return scan_fail(&ply->scan, ply->reason, "%zu bytes follow the last element",
                     (size_t)(ply->scan.end - ply->scan.at));
}

enum status read_ply(const char *name, const char *bytes, size_t size, struct scene *out,
                     struct reason *reason)
{
    *out = (struct scene){0};
    struct ply ply = {.scan = scan_make(name, bytes, size), .reason = reason};
    enum status status = ply_header_read(&ply.scan, &ply.header, reason);
    ply.scan.binary = ply.header.encoding != PLY_ASCII;
    for (size_t i = 0; i < ply.header.element_count && !status; i++)
        status = read_element(&ply, &ply.header.element[i]);
    if (!status)
        status = check_end(&ply);
    ply_header_free(&ply.header);
    if (!status)
        return mesh_finish(&ply.mesh, name, out, reason);
    mesh_free(&ply.mesh);
    return status;
}
