#include "scenes/render/diff_values.h"

#include "ref/explain/steps.h"

#include <stdlib.h>

#define NO_LIGHT UINT32_MAX

/* State of a comparison; compare() keeps the first difference. */
struct comparing {
    struct first_bit *out;
    uint32_t segment, light;
};

static void compare(struct comparing *c, const char *name, bool is_float, uint32_t a, uint32_t b)
{
    struct first_bit *out = c->out;
    if (out->differs || a == b)
        return;
    *out = (struct first_bit){.differs = true,
                              .segment = c->segment,
                              .light = c->light,
                              .name = name,
                              .is_float = is_float,
                              .bits = {a, b}};
    while ((a ^ b) >> out->bit > 1u)
        out->bit++;
    if (is_float)
        out->ulps = (uint64_t)llabs(float_steps(float_from_bits(a), float_from_bits(b)));
}

static void compare_float(struct comparing *c, const char *name, float a, float b)
{
    compare(c, name, true, float_bits(a), float_bits(b));
}

static void compare_vec(struct comparing *c, const char *const name[3], struct vec3 a,
                        struct vec3 b)
{
    compare_float(c, name[0], a.x, b.x);
    compare_float(c, name[1], a.y, b.y);
    compare_float(c, name[2], a.z, b.z);
}

static void compare_ray(struct comparing *c, const struct ray *a, const struct ray *b)
{
    static const char *const org[3] = {"origin x", "origin y", "origin z"};
    static const char *const dir[3] = {"direction x", "direction y", "direction z"};
    for (int k = 0; k < 3; k++)
        compare_float(c, org[k], a->org[k], b->org[k]);
    for (int k = 0; k < 3; k++)
        compare_float(c, dir[k], a->dir[k], b->dir[k]);
    compare_float(c, "tmin", a->tmin, b->tmin);
    compare_float(c, "tmax", a->tmax, b->tmax);
}

static void compare_hit(struct comparing *c, const struct hit *a, const struct hit *b)
{
    compare(c, "triangle", false, a->prim, b->prim);
    compare_float(c, "t", a->t, b->t);
    compare_float(c, "u", a->u, b->u);
    compare_float(c, "v", a->v, b->v);
}

static void compare_light(struct comparing *c, const struct walk_light *a,
                          const struct walk_light *b, bool hits)
{
    compare_float(c, "normal . light", a->nl, b->nl);
    compare_float(c, "mirrored . eye", a->rv, b->rv);
    compare_float(c, "distance", a->far, b->far);
    compare(c, "asked", false, a->asked, b->asked);
    compare_ray(c, &a->ray, &b->ray);
    if (hits)
        compare_hit(c, &a->hit, &b->hit);
    compare(c, "shadowed", false, a->shadowed, b->shadowed);
}

static void compare_step(struct comparing *c, const struct walk_step *a, const struct walk_step *b)
{
    static const char *const p[3] = {"point x", "point y", "point z"};
    static const char *const n[3] = {"normal x", "normal y", "normal z"};
    static const char *const g[3] = {"plane x", "plane y", "plane z"};
    compare_ray(c, &a->ray, &b->ray);
    compare_float(c, "weight", a->weight, b->weight);
    compare_hit(c, &a->hit, &b->hit);
    compare_vec(c, p, a->p, b->p);
    compare_vec(c, n, a->n, b->n);
    compare_vec(c, g, a->g, b->g);
}

static void compare_colours(struct comparing *c, const struct walk_step *a,
                            const struct walk_step *b)
{
    static const char *const total[3] = {"red", "green", "blue"};
    compare_float(c, "diffuse light", a->d, b->d);
    compare_float(c, "specular light", a->s, b->s);
    compare_vec(c, total, a->total, b->total);
}

struct first_bit walk_first_bit(const struct diff_walk *a, const struct diff_walk *b, size_t index)
{
    struct first_bit out = {.light = NO_LIGHT};
    struct comparing c = {.out = &out, .light = NO_LIGHT};
    uint32_t of_a = a->length[index], of_b = b->length[index];
    bool hits = a->shadow_query == QUERY_CLOSEST;
    for (c.segment = 0; (c.segment < of_a || c.segment < of_b) && !out.differs; c.segment++) {
        compare(&c, "goes on", false, c.segment < of_a, c.segment < of_b);
        if (out.differs)
            break;
        const struct walk_step *step_a = walk_step_of(a, index, c.segment);
        const struct walk_step *step_b = walk_step_of(b, index, c.segment);
        compare_step(&c, step_a, step_b);
        for (c.light = 0; c.light < a->lights; c.light++)
            compare_light(&c, walk_light_of(a, index, c.segment, c.light),
                          walk_light_of(b, index, c.segment, c.light), hits);
        c.light = NO_LIGHT;
        compare_colours(&c, step_a, step_b);
    }
    return out;
}
