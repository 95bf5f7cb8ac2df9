#include "ref/twin/twin_placed.h"
#include "ref/base/invariant.h"

/* Rays have bounds here. */
#define RAY_BOUNDED 1
#include "ref/twin/twin_scalar.h"

#ifndef PLACED_TURNED /* a test turns them */
/* A float32 number is a multiple of this share of itself at most, and what two of them come to when
 * they are multiplied, and not rounded. */
#define GRID_ROUNDED 0x1p-24
#define GRID_FUSED   0x1p-48
#endif
/* The ends of the contract (ray_in_contract). */
#define LARGEST_ORIGIN 0x1p40
#define LARGEST_DIR    0x1p40
#define LEAST_DIR      0x1p-40

/* --- rays ------------------------------------------------------------------------------------- */

static bool is_exact(struct rounding k, bool fuses)
{
    const struct rounding ieee = ROUNDING_IEEE;
    return k.add <= ieee.add && k.mul <= ieee.mul && k.tiny <= ieee.tiny && !fuses;
}

/* The least that component i of the direction can be if it is not 0: each sum of its products is a
 * multiple of whatever all of them are multiples of. 0: not known. */
static double least_component(const struct twin_place *place, const struct ray *ray, int i,
                              bool fuses)
{
    double least = INFINITY;
    for (int j = 0; j < 3; j++) {
        double size = fabs((double)place->w[3 * i + j] * (double)ray->dir[j]);
        if (size == 0.0)
            continue;
        if (size < 2.0 * NORMAL)
            return 0.0;
        least = fmin(least, size);
    }
    return least / 2.0 * (fuses ? GRID_FUSED : GRID_ROUNDED);
}

/* ray_in_contract of whatever is computed. */
static bool stays_in_contract(const struct twin_ray *out, bool fuses)
{
    double largest = 0.0, surely = 0.0;
    for (int i = 0; i < 3; i++) {
        if (!(fabs(out->org_near[i]) + out->org_off[i] <= LARGEST_ORIGIN))
            return false;
        largest = fmax(largest, fabs(out->dir_near[i]) + out->dir_off[i]);
        surely = fmax(surely, fabs(out->dir_near[i]) - out->dir_off[i]);
    }
    if (!(surely >= LEAST_DIR && largest <= LARGEST_DIR))
        return false;
    for (int i = 0; i < 3; i++) {
        double least = fmax(fabs(out->dir_near[i]) - out->dir_off[i],
                            least_component(out->place, &out->world, i, fuses));
        bool zero = out->dir_near[i] == 0.0 && out->dir_off[i] == 0.0;
        if (!zero && !(least >= (double)SLAB_PARALLEL * largest))
            return false;
    }
    return true;
}

static void settle_ray(const struct bounded o[3], const struct bounded d[3], struct twin_ray *out)
{
    for (int i = 0; i < 3; i++) {
        out->ray.org[i] = o[i].v;
        out->ray.dir[i] = d[i].v;
        out->org_near[i] = o[i].x;
        out->dir_near[i] = d[i].x;
        out->org_off[i] = o[i].e;
        out->dir_off[i] = d[i].e;
    }
}

void twin_ray_of(const struct twin_place *place, struct rounding rounding, bool fuses,
                 const struct ray *ray, struct twin_ray *out)
{
    const struct rules rules = rules_of(&rounding);
    struct bounded x[3], o[3], d[3], dir[3];
    *out = (struct twin_ray){.place = place, .world = *ray, .ray = *ray};
    for (int k = 0; k < 3; k++) {
        dir[k] = d[k] = exact(ray->dir[k]);
        o[k] = exact(ray->org[k]);
        x[k] = sub(&rules, o[k], exact(place->t[k]));
    }
    for (int i = 0; i < 3 && !place->identity; i++) {
        struct bounded w[3];
        for (int j = 0; j < 3; j++) {
            int at = 3 * i + j;
            w[j] = (struct bounded){place->w[at], place->near[at], place->off[at]};
        }
        o[i] = dot(&rules, w, x);
        d[i] = dot(&rules, w, dir);
    }
    settle_ray(o, d, out);
    out->in_contract = place->identity || is_exact(rounding, fuses)
                           ? ray_in_contract(&out->ray)
                           : ray_in_contract(ray) && stays_in_contract(out, fuses);
}

/* --- one triangle ----------------------------------------------------------------------------- */

static struct bounded number(float v, double near, double off)
{
    return (struct bounded){v, near, off};
}

/* Axis k of the formula is axis[k] of the space. */
static struct input input_of(const struct twin_ray *ray, float v[3][3], const int axis[3])
{
    struct input in;
    for (int k = 0; k < 3; k++) {
        int a = axis[k];
        in.o[k] = number(ray->ray.org[a], ray->org_near[a], ray->org_off[a]);
        in.d[k] = number(ray->ray.dir[a], ray->dir_near[a], ray->dir_off[a]);
        for (int c = 0; c < 3; c++)
            in.v[c][k] = exact(v[c][a]);
    }
    return in;
}

int twin_placed_axes(enum twin_formula formula, const struct twin_ray *ray, int axis[3][3])
{
    int count = 1;
    double least = 0.0; /* of the longest */
    twin_axes(formula, &ray->ray, axis[0]);
    if (formula != TWIN_WOOP)
        return count;
    for (int k = 0; k < 3; k++)
        least = fmax(least, fabs(ray->dir_near[k]) - ray->dir_off[k]);
    for (int k = 0; k < 3; k++) {
        if (k == axis[0][2] || !(fabs(ray->dir_near[k]) + ray->dir_off[k] >= least))
            continue;
        bool back = ray->dir_near[k] < 0.0;
        axis[count][0] = (k + (back ? 2 : 1)) % 3;
        axis[count][1] = (k + (back ? 1 : 2)) % 3;
        axis[count++][2] = k;
    }
    return count;
}

/* A sign that both have. */
static struct bounded same_sign(struct bounded a, struct bounded b)
{
    if (sign_of(a) != sign_of(b))
        a.e = INFINITY;
    return a;
}

/* The wider bound; a's evaluation. */
static struct bounded wider_of(struct bounded a, struct bounded b)
{
    return a.e < b.e ? number(a.v, b.x, b.e) : a;
}

/* What holds whichever of two orders of axes is taken. In exact arithmetic t, u, v and all signs
 * are the same by both. */
static struct outcome either(struct outcome a, const struct outcome *b)
{
    for (int c = 0; c < 3; c++)
        a.edge[c] = same_sign(a.edge[c], b->edge[c]);
    a.det = same_sign(a.det, b->det);
    a.t_running = fmax(a.t_running, b->t_running);
    a.t = wider_of(a.t, b->t);
    a.u = wider_of(a.u, b->u);
    a.v = wider_of(a.v, b->v);
    a.t.e += NEAR_SHARE * a.t_running; /* t.x may be of one order and t of another */
    return a;
}

struct twin twin_eval_placed(enum twin_formula formula, struct rounding rounding,
                             const struct twin_ray *ray, float v[3][3])
{
    if (ray->place->identity)
        return twin_eval(formula, rounding, &ray->world, v);
    invariant(twin_is_own(formula));
    const struct rules rules = rules_of(&rounding);
    int axis[3][3], orders = twin_placed_axes(formula, ray, axis);
    struct input in = input_of(ray, v, axis[0]);
    struct outcome out = evaluate(formula, &rules, &in);
    for (int i = 1; i < orders; i++) {
        in = input_of(ray, v, axis[i]);
        struct outcome other = evaluate(formula, &rules, &in);
        out = either(out, &other);
    }
    return conclude(formula, &ray->world, out);
}

void twin_eval_placed_many(enum twin_formula formula, struct rounding rounding,
                           const struct twin_placed_pair *pair, size_t count, struct twin *out)
{
    for (size_t i = 0; i < count;) {
        struct twin_pair run[64]; /* of one scene, whose rays are taken as they are */
        size_t length = 0;
        while (i + length < count && length < 64 && pair[i + length].ray->place->identity &&
               pair[i + length].scene == pair[i].scene) {
            run[length] = (struct twin_pair){&pair[i + length].ray->world, pair[i + length].prim};
            length++;
        }
        if (length > 0) {
            twin_eval_many(formula, rounding, pair[i].scene, run, length, out + i);
            i += length;
            continue;
        }
        float v[3][3];
        scene_tri(pair[i].scene, pair[i].prim, v);
        out[i] = twin_eval_placed(formula, rounding, pair[i].ray, v);
        i++;
    }
}

/* --- sides ------------------------------------------------------------------------------------ */

int twin_placed_side(struct rounding rounding, const struct twin_ray *ray, float v[3][3])
{
    const int axis[3] = {0, 1, 2};
    const struct rules rules = rules_of(&rounding);
    struct input in = input_of(ray, v, axis);
    struct bounded e1[3], e2[3], n[3];
    subtract(&rules, in.v[1], in.v[0], e1);
    subtract(&rules, in.v[2], in.v[0], e2);
    cross(&rules, e1, e2, n);
    return sign_of(dot(&rules, in.d, n));
}
