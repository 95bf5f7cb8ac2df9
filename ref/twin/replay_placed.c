/* Replays of placed triangles: the ray goes into the space of the mesh in scatters. */
#include "ref/twin/replay_inner.h"

/* (a . x + b . y) + c . z of a row of the inverse. */
static struct scatter along_row(const struct liberty *k, const float row[3],
                                const struct scatter x[3])
{
    struct scatter sum = scatter_of(row[0]);
    sum = scatter_mul(k, &sum, &x[0]);
    for (int j = 1; j < 3; j++) {
        struct scatter w = scatter_of(row[j]), product = scatter_mul(k, &w, &x[j]);
        sum = scatter_add(k, &sum, &product);
    }
    return sum;
}

static void take_along(const struct liberty *k, const struct twin_ray *ray, struct scatter o[3],
                       struct scatter d[3])
{
    const struct twin_place *place = ray->place;
    struct scatter x[3], dir[3];
    for (int j = 0; j < 3; j++) {
        struct scatter org = scatter_of(ray->world.org[j]), t = scatter_of(place->t[j]);
        x[j] = scatter_sub(k, &org, &t);
        dir[j] = scatter_of(ray->world.dir[j]);
    }
    for (int i = 0; i < 3; i++) {
        o[i] = along_row(k, place->w + 3 * i, x);
        d[i] = along_row(k, place->w + 3 * i, dir);
    }
}

bool replay_can_answer_placed(enum twin_formula formula, const struct liberty *liberty,
                              const struct twin_ray *ray, float v[3][3],
                              const struct replay_answer *answer)
{
    if (ray->place->identity)
        return replay_can_answer(formula, liberty, &ray->world, v, answer);
    struct scatter o[3], d[3];
    int axis[3][3], orders = twin_placed_axes(formula, ray, axis);
    take_along(liberty, ray, o, d);
    for (int n = 0; n < orders; n++) {
        struct replay w = {.k = liberty, .answer = answer};
        for (int i = 0; i < 3; i++) {
            w.o[i] = o[axis[n][i]];
            w.d[i] = d[axis[n][i]];
        }
        replay_vertices(&w, axis[n], v);
        if (replay_formula(&w, formula))
            return true;
    }
    return false;
}
