/* The smallest tracer that raydiff can judge: every triangle for every ray, Moeller and Trumbore
 * 1997. The protocol: ref/outside/pipe.h, of which nothing needs to be included.
 *   cc -O2 -o tracer tracer.c && raydiff check sphere --engine 'pipe:./tracer'
 * With -DBUG=1 an edge is tested wrongly, with -DBUG=2 a later triangle hides a nearer one, with
 * -DBUG=3 vertices stay where they were. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifndef BUG
#define BUG 0
#endif

struct request {
    char magic[4];
    uint32_t version, query, vertices, triangles, rays, same, zero;
};
/* formula 1: `mt`, rounding 0: IEEE; all 0 would say nothing of how it counts. Flag 64: updates */
struct answer {
    char magic[4];
    uint32_t version, refused, count, formula, rounding, flags, zero;
};
struct ray {
    float o[3], tmin, d[3], tmax;
};
struct hit {
    float t, u, v;
    uint32_t triangle; /* 0xFFFFFFFF: none */
};
static float dot(const float *a, const float *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const float *a, const float *b, float *out)
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static int meets(const struct ray *r, const float *a, const float *b, const float *c, struct hit *h)
{
    float e1[3], e2[3], s[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = b[k] - a[k];
        e2[k] = c[k] - a[k];
        s[k] = r->o[k] - a[k];
    }
    cross(r->d, e2, p);
    cross(s, e1, q);
    float det = dot(e1, p), side = det < 0.0f ? -1.0f : 1.0f, size = side * det;
    float u = side * dot(s, p), v = side * dot(r->d, q);
    if (!(size > 0.0f && u >= 0.0f && v >= 0.0f && u + v <= (BUG == 1 ? 1.05f : 1.0f) * size))
        return 0;
    h->t = side * dot(e2, q) / size;
    h->u = u / size;
    h->v = v / size;
    return h->t >= r->tmin && h->t <= r->tmax;
}

static void *take(size_t count, size_t size) /* reads an array from the request */
{
    void *array = malloc(count * size + 1);
    if (!array || fread(array, size, count, stdin) != count)
        exit(1);
    return array;
}

int main(void)
{
    struct request q;
    float *vertex = NULL;
    uint32_t *index = NULL;
    while (fread(&q, sizeof q, 1, stdin) == 1) {
        if (memcmp(q.magic, "RDRQ", 4) != 0 || q.version != 1)
            return 1;
        if (q.same == 0) {
            free(vertex), free(index);
            vertex = take(q.vertices, 3 * sizeof *vertex);
            index = take(q.triangles, 3 * sizeof *index);
        } else if (q.same == 2) { /* an update: only the vertices, which have moved */
            float *moved = take(q.vertices, 3 * sizeof *vertex);
            memcpy(vertex, moved, BUG == 3 ? 0 : q.vertices * 3 * sizeof *vertex);
            free(moved);
        }
        struct ray *ray = take(q.rays, sizeof *ray);
        struct answer head = {"RDRA", 1, 0, q.rays, 1, 0, 64, 0};
        fwrite(&head, sizeof head, 1, stdout);
        for (uint32_t i = 0; i < q.rays; i++) {
            struct hit best = {0, 0, 0, 0xFFFFFFFFu}, h;
            for (uint32_t t = 0; t < q.triangles; t++) {
                const uint32_t *v = index + 3 * (size_t)t;
                if (meets(&ray[i], vertex + 3 * v[0], vertex + 3 * v[1], vertex + 3 * v[2], &h) &&
                    (best.triangle == 0xFFFFFFFFu || h.t < best.t || BUG == 2)) {
                    best = h;
                    best.triangle = t;
                }
            }
            fwrite(&best, sizeof best, 1, stdout);
        }
        free(ray);
        fflush(stdout);
    }
    return 0;
}
