#include "ref/store/dense_strip.h"

#include <string.h>

/* Appends an index; false if there are too many vertices. The first three are of new vertices. */
static bool add_index(struct dense_strip *s, const int32_t at[3], uint32_t *number)
{
    uint32_t v = 0;
    while (v < s->vertices && memcmp(s->vertex[v], at, sizeof s->vertex[v]) != 0)
        v++;
    if (s->indices < 3)
        v = s->vertices;
    s->first[s->indices++] = v == s->vertices;
    *number = v;
    if (v == s->vertices) {
        if (v == DENSE_VERTICES)
            return false;
        memcpy(s->vertex[s->vertices++], at, sizeof s->vertex[v]);
        return true;
    }
    s->reuse[s->reused++] = (uint8_t)v;
    s->largest = v > s->largest ? v : s->largest;
    return true;
}

void dense_edge(enum control control, enum control before, const uint32_t one[3],
                const uint32_t two[3], uint32_t edge[2])
{
    const uint32_t *of = control == CONTROL_BACKTRACK ? two : one;
    bool second = control == CONTROL_EDGE2;
    if (control == CONTROL_BACKTRACK)
        second = before == CONTROL_EDGE1;
    edge[0] = second ? of[0] : of[2];
    edge[1] = second ? of[2] : of[1];
}

static bool may_backtrack(uint32_t before)
{
    return before == CONTROL_EDGE1 || before == CONTROL_EDGE2;
}

/* Finds a control, and the corner with which the triangle then begins. */
static void choose(struct dense_strip *s, const int32_t at[3][3], const uint32_t one[3],
                   const uint32_t two[3])
{
    const uint32_t i = s->tris;
    s->control[i] = CONTROL_RESTART;
    s->turn[i] = 0;
    for (uint32_t c = CONTROL_EDGE1; c <= CONTROL_BACKTRACK && i > 0; c++)
        for (uint32_t turn = 0; turn < 3; turn++) {
            uint32_t edge[2];
            if (c == CONTROL_BACKTRACK && !may_backtrack(s->control[i - 1]))
                continue;
            dense_edge((enum control)c, (enum control)s->control[i - 1], one, two, edge);
            if (memcmp(s->vertex[edge[0]], at[turn], sizeof at[0]) == 0 &&
                memcmp(s->vertex[edge[1]], at[(turn + 1) % 3], sizeof at[0]) == 0) {
                s->control[i] = (uint8_t)c;
                s->turn[i] = (uint8_t)turn;
                return;
            }
        }
}

/* Returns with which corner a triangle begins a strip so that `next` can share an edge with it that
 * has its third vertex; 0 if there is none. */
static uint32_t begin_with(const int32_t at[3][3], const int32_t next[3][3])
{
    for (uint32_t turn = 0; turn < 3; turn++)
        for (uint32_t n = 0; n < 3; n++)
            for (uint32_t from = 1; from < 3; from++) {
                const int32_t *a = at[(from + turn) % 3], *b = at[(from + 1 + turn) % 3];
                if (memcmp(next[n], b, sizeof at[0]) == 0 &&
                    memcmp(next[(n + 1) % 3], a, sizeof at[0]) == 0)
                    return turn;
            }
    return 0;
}

static void numbers_of(const struct scene *scene, double step, uint32_t prim, int32_t at[3][3])
{
    float v[3][3];
    scene_tri(scene, prim, v);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            at[c][k] = (int32_t)((double)v[c][k] / step);
}

bool dense_strip_make(const struct scene *scene, double step, const uint32_t *prim, uint32_t count,
                      struct dense_strip *s)
{
    uint32_t one[3] = {0}, two[3] = {0}, now[3];
    int32_t at[3][3], next[3][3];
    if (count > DENSE_TRIS)
        return false;
    memset(s, 0, sizeof *s);
    numbers_of(scene, step, prim[0], next);
    for (; s->tris < count; s->tris++) {
        const uint32_t i = s->tris;
        memcpy(at, next, sizeof at);
        if (i + 1 < count)
            numbers_of(scene, step, prim[i + 1], next);
        choose(s, (const int32_t(*)[3])at, one, two);
        const enum control control = (enum control)s->control[i];
        if (control == CONTROL_RESTART)
            s->turn[i] = (uint8_t)begin_with((const int32_t(*)[3])at, (const int32_t(*)[3])next);
        else
            dense_edge(control, (enum control)s->control[i - 1], one, two, now);
        for (uint32_t c = control == CONTROL_RESTART ? 0 : 2; c < 3; c++)
            if (!add_index(s, at[(c + s->turn[i]) % 3], &now[c]))
                return false;
        memcpy(two, one, sizeof two);
        memcpy(one, now, sizeof one);
    }
    return true;
}
