#include "ref/outside/pipe_text_inner.h"

#include "ref/base/ray_text.h"
#include "ref/outside/pipe.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

void pipe_text_free(struct pipe_text *text)
{
    scene_free(&text->scene);
    world_free(&text->world);
    free(text->ray);
    free(text->mode);
    free(text->hit);
    free(text->tag);
    *text = (struct pipe_text){0};
}

enum status pipe_text_no_memory(struct pipe_reading *r)
{
    return fail(r->reason, STATUS_MEMORY, "%s: no memory", r->scan.name);
}

static enum status read_float(struct pipe_reading *r, const char *what, float *out)
{
    char shown[SCAN_SHOWN];
    scan_blanks(&r->scan);
    const char *end = float_text_read(r->scan.at, out), *start = r->scan.at;
    if (end) {
        r->scan.at = end;
        if (scan_word_done(&r->scan))
            return STATUS_OK;
        r->scan.at = start;
    }
    return scan_fail(&r->scan, r->reason, "%s: %s is not a float32 number", what,
                     scan_show(&r->scan, shown));
}

enum status pipe_text_floats(struct pipe_reading *r, const char *const *what, float *out, int count)
{
    enum status status = STATUS_OK;
    for (int i = 0; i < count && !status; i++)
        status = read_float(r, what[i], &out[i]);
    return status;
}

static enum status read_vertex(struct pipe_reading *r)
{
    static const char *const what[] = {"x", "y", "z"};
    float position[3];
    enum status status = pipe_text_floats(r, what, position, 3);
    if (status)
        return status;
    for (int k = 0; k < 3; k++)
        if (!float_is_finite(position[k]))
            return scan_fail(&r->scan, r->reason, "a vertex is finite");
    return mesh_vertex(&r->mesh, position) ? pipe_text_no_memory(r) : STATUS_OK;
}

static enum status read_triangle(struct pipe_reading *r)
{
    mesh_polygon(&r->mesh);
    for (int c = 0; c < 3; c++) {
        int64_t n;
        enum status status = scan_whole(&r->scan, "vertex", &n, r->reason);
        if (status)
            return status;
        if (n < 0 || (uint64_t)n >= r->mesh.vertex_count)
            return scan_fail(&r->scan, r->reason,
                             "vertex %" PRId64 " is none of the %zu before this line", n,
                             r->mesh.vertex_count);
        if (mesh_corner(&r->mesh, (uint32_t)n))
            return pipe_text_no_memory(r);
    }
    return STATUS_OK;
}

static enum status read_ray(struct pipe_reading *r)
{
    static const char *const what[] = {"origin x",    "origin y",    "origin z",    "tmin",
                                       "direction x", "direction y", "direction z", "tmax"};
    float n[8];
    enum status status = pipe_text_floats(r, what, n, 8);
    if (status)
        return status;
    if (array_reserve(&r->out->ray, &r->ray_capacity, r->out->ray_count + 1, sizeof *r->out->ray))
        return pipe_text_no_memory(r);
    r->out->ray[r->out->ray_count] =
        (struct ray){{n[0], n[1], n[2]}, n[3], {n[4], n[5], n[6]}, n[7]};
    status = r->out->version == PIPE_VERSION_WORLD ? pipe_text_mode(r) : STATUS_OK;
    r->out->ray_count += !status;
    return status;
}

enum status pipe_text_number(struct pipe_reading *r, const char *what, uint32_t most, uint32_t *out)
{
    int64_t n;
    enum status status = scan_whole(&r->scan, what, &n, r->reason);
    if (status)
        return status;
    if (n < 0 || n > (int64_t)most)
        return scan_fail(&r->scan, r->reason, "%s %" PRId64 " is not in 0 .. %" PRIu32, what, n,
                         most);
    *out = (uint32_t)n;
    return STATUS_OK;
}

enum status pipe_text_add_hit(struct pipe_reading *r, struct hit hit, uint32_t tag)
{
    struct pipe_text *out = r->out;
    if (out->hit_count == r->limits->rays)
        return scan_fail(&r->scan, r->reason, "an answer to ray %zu, but there are only %zu rays",
                         out->hit_count, r->limits->rays);
    if (array_reserve(&out->hit, &r->hit_capacity, out->hit_count + 1, sizeof hit) ||
        (out->version == PIPE_VERSION_WORLD &&
         array_reserve(&out->tag, &r->tag_capacity, out->hit_count + 1, sizeof tag)))
        return pipe_text_no_memory(r);
    if (out->version == PIPE_VERSION_WORLD)
        out->tag[out->hit_count] = tag;
    out->hit[out->hit_count++] = hit;
    return STATUS_OK;
}

/* An answer of version 1 about a world is never taken. */
static enum status check_answer(const struct pipe_reading *r)
{
    if (!r->limits->world || r->out->version == PIPE_VERSION_WORLD)
        return STATUS_OK;
    return scan_fail(&r->scan, r->reason,
                     "an answer of version 1, to rays in a world: its first line is 'raydiff 2'");
}

static enum status read_hit(struct pipe_reading *r)
{
    static const char *const what[] = {"t", "u", "v"};
    float n[3];
    int64_t prim;
    enum status status = check_answer(r);
    if (r->out->version == PIPE_VERSION_WORLD)
        return pipe_text_world_hit(r);
    if (!status)
        status = pipe_text_floats(r, what, n, 3);
    if (!status)
        status = scan_whole(&r->scan, "triangle", &prim, r->reason);
    if (status)
        return status;
    uint32_t most = r->limits->triangles;
    if (prim < 0 || prim >= most)
        return scan_fail(&r->scan, r->reason, "triangle %" PRId64 " is none of %u", prim, most);
    return pipe_text_add_hit(r, (struct hit){n[0], n[1], n[2], (uint32_t)prim}, 0);
}

static enum status read_miss(struct pipe_reading *r)
{
    enum status status = check_answer(r);
    return status ? status : pipe_text_add_hit(r, (struct hit){.prim = ABI_NO_PRIM}, 0);
}

static bool word_is(const char *word, size_t length, const char *name)
{
    return strlen(name) == length && memcmp(word, name, length) == 0;
}

uint32_t pipe_text_word(struct pipe_reading *r, const char *(*name)(uint32_t))
{
    const char *word;
    size_t length = scan_word(&r->scan, &word);
    uint32_t i = 0;
    while (name(i) && !word_is(word, length, name(i)))
        i++;
    return i;
}

static enum status read_formula(struct pipe_reading *r)
{
    r->out->formula = pipe_text_word(r, pipe_formula_name);
    if (!pipe_formula_name(r->out->formula))
        return scan_fail(&r->scan, r->reason,
                         "formulas are unknown, mt, woop, embree, embree_robust, "
                         "pluecker, baldwin_webber, tri_accel");
    scan_blanks(&r->scan);
    if (scan_line_done(&r->scan))
        return STATUS_OK;
    r->out->rounding = pipe_text_word(r, pipe_rounding_name);
    if (!pipe_rounding_name(r->out->rounding))
        return scan_fail(&r->scan, r->reason,
                         "roundings are ieee, flushed, vulkan, vulkan_rte, embree");
    return STATUS_OK;
}

static const char *flag_name(uint32_t i)
{
    static const char *const names[] = {"open", "watertight", "unnamed"};
    return i < ARRAY_COUNT(names) ? names[i] : NULL;
}

static enum status read_flags(struct pipe_reading *r)
{
    for (scan_blanks(&r->scan); !scan_line_done(&r->scan); scan_blanks(&r->scan)) {
        uint32_t flag = pipe_text_word(r, flag_name);
        if (!flag_name(flag))
            return scan_fail(&r->scan, r->reason, "flags are open, watertight, unnamed");
        r->out->flags |= 1u << flag;
    }
    return STATUS_OK;
}

/* Reads the rest of the line, without blanks at its end; a tab is a blank. */
static void read_rest(struct pipe_reading *r, char *text, size_t text_bytes)
{
    scan_blanks(&r->scan);
    size_t length = 0;
    for (; r->scan.at < r->scan.end && *r->scan.at != '\n' && *r->scan.at != '\r'; r->scan.at++) {
        const char c = *r->scan.at == '\t' ? ' ' : *r->scan.at;
        if (length + 1 < text_bytes)
            text[length++] = c < ' ' || c > '~' ? '?' : c;
    }
    while (length > 0 && text[length - 1] == ' ')
        length--;
    text[length] = '\0';
}

static enum status read_refused(struct pipe_reading *r)
{
    read_rest(r, r->out->refused, sizeof r->out->refused);
    if (r->out->refused[0] == '\0')
        strcpy(r->out->refused, "without a reason");
    return STATUS_OK;
}

/* Reads "modes=MODES", which a world's line has and no other. */
static enum status read_modes(struct pipe_reading *r)
{
    const size_t begins = strlen("modes=");
    struct scan ahead = r->scan;
    const char *word;
    const size_t length = scan_word(&ahead, &word);
    const bool is_there = length > begins && memcmp(word, "modes=", begins) == 0;
    if (is_there != (r->out->version == PIPE_VERSION_WORLD))
        return scan_fail(&r->scan, r->reason,
                         is_there ? "'from' is of a world, but the first line is not 'raydiff 2': "
                                    "this tracer has version 1"
                                  : "'from' is of a scene, but the first line is 'raydiff 2'");
    if (!is_there)
        return STATUS_OK;
    if (length - begins >= sizeof r->out->from.modes || memchr(word, 0, length))
        return scan_fail(&r->scan, r->reason, "not a 'from' line as raydiff gen writes it");
    memcpy(r->out->from.modes, word + begins, length - begins);
    r->scan = ahead;
    return STATUS_OK;
}

static enum status read_from(struct pipe_reading *r)
{
    struct pipe_from *from = &r->out->from;
    const char *word, *rest;
    size_t length = scan_word(&r->scan, &word);
    char *end = NULL;
    from->hash = strtoull(word, &end, 16);
    bool good = length == 16 && end == word + 16;
    good = good && scan_u64(&r->scan, &from->seed) && scan_u64(&r->scan, &from->count);
    length = good ? scan_word(&r->scan, &rest) : 0;
    good = good && length > 0 && length < sizeof from->rays && !memchr(rest, 0, length);
    if (good)
        memcpy(from->rays, rest, length);
    enum status status = good ? read_modes(r) : STATUS_OK;
    if (status)
        return status;
    if (good)
        read_rest(r, from->spec, sizeof from->spec);
    if (!good || from->spec[0] == '\0')
        return scan_fail(&r->scan, r->reason, "not a 'from' line as raydiff gen writes it");
    return STATUS_OK;
}

static enum status read_query(struct pipe_reading *r)
{
    const char *word;
    size_t length = scan_word(&r->scan, &word);
    r->out->query = word_is(word, length, "any") ? QUERY_ANY : QUERY_CLOSEST;
    if (r->out->query == QUERY_CLOSEST && !word_is(word, length, "closest"))
        return scan_fail(&r->scan, r->reason, "queries are closest, any");
    return STATUS_OK;
}

static enum status read_version(struct pipe_reading *r)
{
    int64_t version;
    enum status status = scan_whole(&r->scan, "version", &version, r->reason);
    const bool of_scene = r->limits->triangles != UINT32_MAX, of_world = r->limits->world != NULL;
    if (status)
        return status;
    if (version != PIPE_VERSION && version != PIPE_VERSION_WORLD)
        return scan_fail(&r->scan, r->reason, "version %" PRId64 ", not %u or %u", version,
                         PIPE_VERSION, PIPE_VERSION_WORLD);
    if (of_world ? version != PIPE_VERSION_WORLD : of_scene && version != PIPE_VERSION)
        return scan_fail(&r->scan, r->reason, "version %" PRId64 ", not %u: the rays are in a %s",
                         version, of_world ? PIPE_VERSION_WORLD : PIPE_VERSION,
                         of_world ? "world" : "scene");
    if (version != (int64_t)r->out->version && r->lines > 0)
        return scan_fail(&r->scan, r->reason, "'raydiff %" PRId64 "' is not the first line",
                         version);
    r->out->version = (uint32_t)version;
    return STATUS_OK;
}

static enum status read_end(struct pipe_reading *r)
{
    r->ended = true;
    return STATUS_OK;
}

static enum status read_line(struct pipe_reading *r)
{
    static const struct {
        const char *name;
        enum status (*read)(struct pipe_reading *r);
    } lines[] = {{"v", read_vertex},        {"t", read_triangle},      {"r", read_ray},
                 {"h", read_hit},           {"m", read_miss},          {"query", read_query},
                 {"formula", read_formula}, {"flags", read_flags},     {"refused", read_refused},
                 {"from", read_from},       {"raydiff", read_version}, {"end", read_end}};
    char shown[SCAN_SHOWN];
    const char *word;
    struct scan before = r->scan;
    size_t length = scan_word(&r->scan, &word);
    if (length == 0)
        return STATUS_OK;
    if (r->ended)
        return scan_fail(&before, r->reason, "nothing follows 'end'");
    enum status status = STATUS_OK;
    bool known = pipe_text_world_line(r, word, length, &status);
    for (size_t i = 0; i < ARRAY_COUNT(lines) && !known; i++)
        if (word_is(word, length, lines[i].name)) {
            known = true;
            status = lines[i].read(r);
        }
    if (!known)
        return scan_fail(&before, r->reason,
                         "%s is no line: v, t, r, h, m, query, formula, flags, refused, from, "
                         "end; of worlds also mesh, g, i, filter",
                         scan_show(&before, shown));
    if (status)
        return status;
    scan_blanks(&r->scan);
    if (!scan_line_done(&r->scan))
        return scan_fail(&r->scan, r->reason, "%s is too much on a line '%.*s'",
                         scan_show(&r->scan, shown), (int)length, word);
    r->lines++;
    return STATUS_OK;
}

static enum status finish_world(struct pipe_reading *r)
{
    struct reason why = {""};
    enum status status = pipe_text_end_mesh(r);
    if (status)
        return status;
    status = world_finish(&r->out->world, &why);
    return status ? fail(r->reason, status, "%s: %s", r->scan.name, why.text) : STATUS_OK;
}

enum status pipe_text_parse(const char *name, const char *bytes, size_t size,
                            const struct pipe_limits *limits, struct pipe_text *out,
                            struct reason *reason)
{
    *out = (struct pipe_text){.version = PIPE_VERSION};
    struct pipe_reading r = {
        .scan = scan_make(name, bytes, size), .limits = limits, .out = out, .reason = reason};
    enum status status = STATUS_OK;
    r.scan.comment = '#';
    while (r.scan.at < r.scan.end && !status) {
        scan_blanks(&r.scan);
        out->last_line = r.scan.line;
        status = read_line(&r);
        if (!status)
            scan_next_line(&r.scan);
    }
    if (!status && out->version == PIPE_VERSION_WORLD)
        status = finish_world(&r);
    else if (!status && r.mesh.vertex_count > 0)
        status = mesh_finish(&r.mesh, name, &out->scene, reason);
    mesh_free(&r.mesh);
    if (status)
        pipe_text_free(out);
    return status;
}
