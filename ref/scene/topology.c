#include "ref/scene/topology.h"

#include <stdlib.h>
#include <string.h>

/* A vertex keyed by its position: bit patterns, with -0 as +0, so that equal numbers are equal
 * keys. */
struct topology_place {
    uint32_t key[3];
    uint32_t vertex;
};

/* A triangle's side from corner `corner` to the next one, lower point first. */
struct half_edge {
    uint32_t a, b;
    uint32_t tri;
    uint8_t corner;
    bool backward;
};

static int by_place(const void *left, const void *right)
{
    const struct topology_place *x = left, *y = right;
    int order = 0;
    for (int k = 0; k < 3 && order == 0; k++)
        order = order_numbers(x->key[k], y->key[k]);
    return order ? order : order_numbers(x->vertex, y->vertex);
}

static int by_edge(const void *left, const void *right)
{
    const struct half_edge *x = left, *y = right;
    int order = order_numbers(x->a, y->a);
    order = order ? order : order_numbers(x->b, y->b);
    order = order ? order : order_numbers(x->backward, y->backward);
    return order ? order : order_numbers(x->tri, y->tri);
}

/* Numbers the points by their first vertex. */
static enum status weld(const struct scene *scene, struct topology *out)
{
    struct topology_place *place = alloc_zeroed(out->vertex_count, sizeof *place);
    if (!place)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < out->vertex_count; i++) {
        place[i].vertex = i;
        for (int k = 0; k < 3; k++)
            place[i].key[k] = float_bits(scene->vertex[3 * (size_t)i + (size_t)k] + 0.0f);
    }
    qsort(place, out->vertex_count, sizeof *place, by_place);
    for (uint32_t i = 0; i < out->vertex_count; i++) {
        bool same = i > 0 && memcmp(place[i].key, place[i - 1].key, sizeof place[i].key) == 0;
        out->point[place[i].vertex] = same ? out->point[place[i - 1].vertex] : place[i].vertex;
    }
    free(place);
    for (uint32_t i = 0; i < out->vertex_count; i++) {
        if (out->point[i] == i) {
            out->vertex[out->point_count] = i;
            out->point[i] = out->point_count++;
        } else {
            out->point[i] = out->point[out->point[i]]; /* already numbered: it comes before i */
        }
    }
    return STATUS_OK;
}

/* Lists the sides of all triangles that are not collapsed; returns their number. */
static size_t list_halves(struct topology *out, struct half_edge *half)
{
    size_t count = 0;
    for (uint32_t i = 0; i < out->tri_count; i++) {
        const uint32_t *p = out->corner + 3 * (size_t)i;
        if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) {
            out->collapsed++;
            continue;
        }
        for (uint8_t c = 0; c < 3; c++) {
            uint32_t from = p[c], to = p[(c + 1) % 3];
            bool backward = from > to;
            half[count++] =
                (struct half_edge){backward ? to : from, backward ? from : to, i, c, backward};
        }
    }
    return count;
}

static enum status list_edges(struct topology *out)
{
    struct half_edge *half = alloc_zeroed(3 * (size_t)out->tri_count, sizeof *half);
    if (!half)
        return STATUS_MEMORY;
    size_t count = list_halves(out, half);
    qsort(half, count, sizeof *half, by_edge);
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || half[i].a != half[i - 1].a || half[i].b != half[i - 1].b)
            out->edge[out->edge_count++] =
                (struct topology_edge){half[i].a, half[i].b, (uint32_t)i, 0, 0};
        struct topology_edge *edge = &out->edge[out->edge_count - 1];
        if (half[i].backward)
            edge->backward++;
        else
            edge->forward++;
        out->side[i] = half[i].tri;
        out->edge_of[3 * (size_t)half[i].tri + half[i].corner] = out->edge_count - 1;
    }
    free(half);
    return STATUS_OK;
}

/* Counting sort of the triangles by point. */
static void list_fans(struct topology *out)
{
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < out->tri_count; i++) {
            const uint32_t *p = out->corner + 3 * (size_t)i;
            if (out->edge_of[3 * (size_t)i] == TOPOLOGY_NONE)
                continue;
            for (int c = 0; c < 3; c++) {
                if (pass == 0)
                    out->fan_first[p[c]]++;
                else
                    out->fan[out->fan_first[p[c]]++] = i;
            }
        }
        /* After the first pass counts become starts. The second pass has moved each start to its
         * end, which is the start of the next point. */
        uint32_t start = 0;
        for (uint32_t p = 0; p <= out->point_count; p++) {
            uint32_t value = out->fan_first[p];
            out->fan_first[p] = start;
            start = pass == 0 ? start + value : value;
        }
    }
}

enum status topology_make(const struct scene *scene, struct topology *out, struct reason *reason)
{
    *out = (struct topology){.vertex_count = scene->vertex_count, .tri_count = scene->tri_count};
    if (scene->tri_count > UINT32_MAX / 3)
        return fail(reason, STATUS_LIMIT, "topology of at most %u triangles, there are %u",
                    UINT32_MAX / 3, scene->tri_count);
    size_t sides = 3 * (size_t)scene->tri_count;
    out->point = alloc_zeroed(scene->vertex_count, sizeof *out->point);
    out->vertex = alloc_zeroed(scene->vertex_count, sizeof *out->vertex);
    out->corner = alloc_zeroed(sides, sizeof *out->corner);
    out->edge_of = alloc_zeroed(sides, sizeof *out->edge_of);
    out->edge = alloc_zeroed(sides, sizeof *out->edge);
    out->side = alloc_zeroed(sides, sizeof *out->side);
    out->fan = alloc_zeroed(sides, sizeof *out->fan);
    enum status status = STATUS_OK;
    if (!out->point || !out->vertex || !out->corner || !out->edge_of || !out->edge || !out->side ||
        !out->fan)
        status = STATUS_MEMORY;
    if (!status)
        status = weld(scene, out);
    if (!status) {
        for (size_t i = 0; i < sides; i++)
            out->corner[i] = out->point[scene->index[i]];
        memset(out->edge_of, 0xFF, sides * sizeof *out->edge_of);
        out->fan_first = alloc_zeroed((size_t)out->point_count + 1, sizeof *out->fan_first);
        status = out->fan_first ? list_edges(out) : STATUS_MEMORY;
    }
    if (status) {
        topology_free(out);
        return fail(reason, status, "no memory for the edges of %u triangles", scene->tri_count);
    }
    list_fans(out);
    return STATUS_OK;
}

void topology_free(struct topology *topology)
{
    free(topology->point);
    free(topology->vertex);
    free(topology->corner);
    free(topology->edge_of);
    free(topology->edge);
    free(topology->side);
    free(topology->fan_first);
    free(topology->fan);
    *topology = (struct topology){0};
}

bool topology_edge_closed(const struct topology_edge *edge)
{
    return edge->forward == edge->backward;
}

bool topology_fan_closed(const struct topology *topology, uint32_t p)
{
    for (uint32_t i = topology->fan_first[p]; i < topology->fan_first[p + 1]; i++)
        for (size_t c = 0; c < 3; c++) {
            uint32_t e = topology->edge_of[3 * (size_t)topology->fan[i] + c];
            const struct topology_edge *edge = &topology->edge[e];
            if ((edge->a == p || edge->b == p) && !topology_edge_closed(edge))
                return false;
        }
    return topology->fan_first[p] < topology->fan_first[p + 1];
}

/* True if triangle `tri` traverses its side `edge` from the edge's lower point to the higher. */
static bool runs_forward(const struct topology *topology, const struct topology_edge *edge,
                         uint32_t tri)
{
    for (uint32_t i = 0; i < edge->forward; i++)
        if (topology->side[edge->first + i] == tri)
            return true;
    return false;
}

/* Finds the two sides of triangle `tri` at point `p`, in the triangle's own direction: the one that
 * ends there and the one that starts there. */
static void sides_at(const struct topology *topology, uint32_t tri, uint32_t p, uint32_t *arrives,
                     uint32_t *leaves)
{
    *arrives = *leaves = TOPOLOGY_NONE;
    for (size_t c = 0; c < 3; c++) {
        uint32_t e = topology->edge_of[3 * (size_t)tri + c];
        const struct topology_edge *edge = &topology->edge[e];
        if (edge->a != p && edge->b != p)
            continue;
        if ((edge->a == p) == runs_forward(topology, edge, tri))
            *leaves = e;
        else
            *arrives = e;
    }
}

bool topology_fan_is_ring(const struct topology *topology, uint32_t p)
{
    uint32_t size = topology->fan_first[p + 1] - topology->fan_first[p], steps = 0;
    if (size < 3)
        return false;
    uint32_t first = topology->fan[topology->fan_first[p]], tri = first;
    do {
        uint32_t arrives, leaves;
        sides_at(topology, tri, p, &arrives, &leaves);
        const struct topology_edge *edge = &topology->edge[leaves];
        if (edge->forward != 1 || edge->backward != 1)
            return false;
        uint32_t other = topology->side[edge->first];
        tri = other == tri ? topology->side[edge->first + 1] : other;
        steps++;
    } while (tri != first && steps <= size);
    return steps == size;
}

uint32_t topology_shared_edge(const struct topology *topology, uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++) {
            uint32_t e = topology->edge_of[3 * (size_t)a + i];
            if (e == TOPOLOGY_NONE || e != topology->edge_of[3 * (size_t)b + j])
                continue;
            const struct topology_edge *edge = &topology->edge[e];
            if (runs_forward(topology, edge, a) != runs_forward(topology, edge, b))
                return e;
        }
    return TOPOLOGY_NONE;
}

uint32_t topology_open_edge(const struct topology *topology)
{
    for (uint32_t e = 0; e < topology->edge_count; e++)
        if (!topology_edge_closed(&topology->edge[e]))
            return e;
    return TOPOLOGY_NONE;
}

enum status topology_is_closed(const struct topology *topology, const struct scene *scene,
                               struct reason *reason)
{
    uint32_t e = topology_open_edge(topology);
    if (topology->edge_count == 0)
        return fail(reason, STATUS_INPUT, "no closed mesh: it has no triangle with three corners");
    if (e == TOPOLOGY_NONE)
        return STATUS_OK;
    const struct topology_edge *edge = &topology->edge[e];
    uint32_t a = topology->vertex[edge->a], b = topology->vertex[edge->b];
    const float *p = scene->vertex + 3 * (size_t)a, *q = scene->vertex + 3 * (size_t)b;
    uint32_t total = edge->forward + edge->backward;
    return fail(reason, STATUS_INPUT,
                "no closed mesh: triangle %u, edge of vertices %u (%.9g %.9g %.9g) and %u (%.9g "
                "%.9g %.9g): %u triangle%s, %u one way and %u the other%s",
                topology->side[edge->first], a, (double)p[0], (double)p[1], (double)p[2], b,
                (double)q[0], (double)q[1], (double)q[2], total, total == 1 ? "" : "s",
                edge->forward, edge->backward,
                total % 2 == 0 ? ": a triangle is turned round" : ": the mesh is open there");
}
