#include "tests/exact/gmp_world.h"

#include <math.h>

static void init_all(mpq_t v[3][3])
{
    for (int c = 0; c < 3; c++)
        mpq_inits(v[c][0], v[c][1], v[c][2], NULL);
}

static void clear_all(mpq_t v[3][3])
{
    for (int c = 0; c < 3; c++)
        mpq_clears(v[c][0], v[c][1], v[c][2], NULL);
}

struct place gmp_world_place(const struct world *world, uint32_t prim)
{
    struct place place = {0};
    for (;; place.instance++) {
        place.mesh = world->instance[place.instance].mesh;
        uint32_t count = place.mesh == WORLD_NO_MESH ? 0 : world->mesh[place.mesh].scene->tri_count;
        if (prim < count)
            break;
        prim -= count;
    }
    place.prim = prim;
    const struct geometry *geometry = world->mesh[place.mesh].geometry;
    while (prim >= geometry[place.geometry].count)
        prim -= geometry[place.geometry++].count;
    place.tri = prim;
    return place;
}

void gmp_world_vertices(const struct world *world, uint32_t prim, mpq_t v[3][3])
{
    struct place place = gmp_world_place(world, prim);
    const struct instance *instance = &world->instance[place.instance];
    float p[3][3];
    mpq_t m, x;
    mpq_inits(m, x, NULL);
    scene_tri(world->mesh[place.mesh].scene, place.prim, p);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            mpq_set_d(v[c][k], (double)instance->m[k][3]);
            for (int j = 0; j < 3; j++) {
                mpq_set_d(m, (double)instance->m[k][j]);
                mpq_set_d(x, (double)p[c][j]);
                mpq_mul(x, x, m);
                mpq_add(v[c][k], v[c][k], x);
            }
        }
    mpq_clears(m, x, NULL);
}

void gmp_world_pair(const struct world *world, const struct ray *ray, uint32_t prim,
                    struct gmp_pair *pair)
{
    mpq_t v[3][3];
    init_all(v);
    gmp_world_vertices(world, prim, v);
    exact_gmp_pair_at(ray, v, pair);
    clear_all(v);
}

bool gmp_world_far_off(const struct instance *instance, const struct ray *ray, float p[3][3])
{
    long double a[3][3], slack = 0; /* of placing a vertex in long double */
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) {
            long double sum = (long double)instance->m[k][3], size = fabsl(sum);
            for (int j = 0; j < 3; j++) {
                long double product = (long double)instance->m[k][j] * (long double)p[c][j];
                sum += product;
                size += fabsl(product);
            }
            a[c][k] = sum - (long double)ray->org[k];
            slack = fmaxl(slack, 0x1p-58L * (size + fabsl((long double)ray->org[k])));
        }
    return exact_gmp_far_off(ray, a, slack);
}

/* --- facing ----------------------------------------------------------------------------------- */

/* out = the determinant of three columns, by Sarrus's rule. */
static void determinant(mpq_t column[3][3], mpq_t out)
{
    mpq_t term;
    mpq_init(term);
    mpq_set_si(out, 0, 1);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpq_mul(term, column[0][i], column[1][j]);
        mpq_mul(term, term, column[2][k]);
        mpq_add(out, out, term);
        mpq_mul(term, column[0][k], column[1][j]);
        mpq_mul(term, term, column[2][i]);
        mpq_sub(out, out, term);
    }
    mpq_clear(term);
}

/* d' solves M d' = d, by Cramer's rule. */
void gmp_world_object_direction(const struct instance *instance, const float d[3], mpq_t out[3])
{
    mpq_t column[3][3], det;
    init_all(column);
    mpq_init(det);
    for (int j = -1; j < 3; j++) { /* -1: M itself */
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                mpq_set_d(column[i][k], (double)(i == j ? d[k] : instance->m[k][i]));
        determinant(column, j < 0 ? det : out[j < 0 ? 0 : j]);
        if (j >= 0)
            mpq_div(out[j], out[j], det);
    }
    mpq_clear(det);
    clear_all(column);
}

int gmp_world_facing(const struct world *world, const struct ray *ray, uint32_t prim)
{
    struct place place = gmp_world_place(world, prim);
    float p[3][3];
    mpq_t column[3][3], x;
    init_all(column);
    mpq_init(x);
    scene_tri(world->mesh[place.mesh].scene, place.prim, p);
    gmp_world_object_direction(&world->instance[place.instance], ray->dir, column[0]);
    for (int c = 1; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            mpq_set_d(column[c][k], (double)p[c][k]);
            mpq_set_d(x, (double)p[0][k]);
            mpq_sub(column[c][k], column[c][k], x);
        }
    determinant(column, x);
    int sign = mpq_sgn(x);
    mpq_clear(x);
    clear_all(column);
    return sign;
}

/* --- rules ------------------------------------------------------------------------------------ */

/* The cell of a weight from 0 to 1. */
static int cell_of(const mpq_t weight)
{
    mpq_t line;
    int cell = 0;
    mpq_init(line);
    while (cell + 1 < (int)ABI_FILTER_GRID) {
        mpq_set_si(line, cell + 1, ABI_FILTER_GRID);
        if (mpq_cmp(weight, line) < 0)
            break;
        cell++;
    }
    mpq_clear(line);
    return cell;
}

static bool passes(const struct world *world, const struct place *place,
                   const struct gmp_pair *pair)
{
    float at[2] = {0, 0};
    if (world->filter.kind == FILTER_ALL)
        return true;
    if (world->filter.kind == FILTER_NONE)
        return false;
    if (world->filter.kind == FILTER_CELLS) {
        if (pair->class == ORACLE_IN_PLANE)
            return true;
        for (int i = 0; i < 2; i++)
            at[i] = ((float)cell_of(pair->weight[i + 1]) + 0.5f) / (float)ABI_FILTER_GRID;
    }
    return filter_passes(&world->filter, place, at[0], at[1]);
}

enum oracle_admission gmp_world_admit(const struct world *world, const struct ray *ray,
                                      struct ray_mode mode, uint32_t prim,
                                      const struct gmp_pair *pair)
{
    struct place place = gmp_world_place(world, prim);
    const struct instance *instance = &world->instance[place.instance];
    bool opaque = world->mesh[place.mesh].geometry[place.geometry].opaque;
    if ((instance->mask & mode.mask) == 0 || (mode.flags & ABI_RAY_SKIP_TRIANGLES))
        return ORACLE_MASKED;
    if (instance->flags & (ABI_INSTANCE_FORCE_OPAQUE | ABI_INSTANCE_FORCE_NO_OPAQUE))
        opaque = instance->flags & ABI_INSTANCE_FORCE_OPAQUE;
    if (mode.flags & (ABI_RAY_OPAQUE | ABI_RAY_NO_OPAQUE))
        opaque = mode.flags & ABI_RAY_OPAQUE;
    if ((opaque && (mode.flags & ABI_RAY_CULL_OPAQUE)) ||
        (!opaque && (mode.flags & ABI_RAY_CULL_NO_OPAQUE)))
        return ORACLE_CULLED_OPACITY;
    if (pair->class != ORACLE_IN_PLANE && !(instance->flags & ABI_INSTANCE_CULL_DISABLE)) {
        bool front = gmp_world_facing(world, ray, prim) < 0;
        if (instance->flags & ABI_INSTANCE_FLIP_FACING)
            front = !front;
        if ((front && (mode.flags & ABI_RAY_CULL_FRONT)) ||
            (!front && (mode.flags & ABI_RAY_CULL_BACK)))
            return ORACLE_CULLED_FACING;
    }
    return opaque || passes(world, &place, pair) ? ORACLE_ADMITTED : ORACLE_FILTERED;
}

void gmp_world_nearest(const struct world *world, const struct ray *ray, struct ray_mode mode,
                       enum oracle_ends ends, struct gmp_nearest *out)
{
    struct gmp_pair pair;
    mpq_t plane;
    bool any_plane = false;
    exact_gmp_init(&pair);
    mpq_init(plane);
    out->prim = ABI_NO_PRIM;
    out->count = 0;
    out->has_next = false;
    for (uint32_t prim = 0; prim < world_tri_count(world); prim++) {
        gmp_world_pair(world, ray, prim, &pair);
        bool hit = exact_gmp_hits(&pair, ends);
        bool touches = pair.class == ORACLE_IN_PLANE && pair.range == ORACLE_WITHIN;
        if ((!hit && !touches) || gmp_world_admit(world, ray, mode, prim, &pair) != ORACLE_ADMITTED)
            continue;
        if (hit)
            exact_gmp_take(out, prim, pair.t);
        if (touches && (!any_plane || mpq_cmp(pair.t, plane) < 0)) {
            mpq_set(plane, pair.t);
            any_plane = true;
        }
    }
    if (any_plane && exact_gmp_compare(plane, (double)ray->tmin) < 0)
        mpq_set_d(plane, (double)ray->tmin);
    out->in_plane = any_plane && (out->count == 0 || mpq_cmp(plane, out->t) <= 0);
    out->in_plane_close =
        any_plane &&
        (out->count == 0 ||
         mpq_get_d(plane) <= mpq_get_d(out->t) * (1 + copysign(0x1p-38, mpq_get_d(out->t))));
    exact_gmp_clear(&pair);
    mpq_clear(plane);
}
