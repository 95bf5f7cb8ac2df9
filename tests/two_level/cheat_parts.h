/* What the cheats that hard cases find compute, each as it is commonly done wrong. For
 * tests/two_level/world_cheats.h, within which it is included. */
#ifndef TWO_LEVEL_CHEAT_PARTS_H
#define TWO_LEVEL_CHEAT_PARTS_H

/* W as adjugate over determinant, all of it in float32. */
static void float_inverse(const float m[3][4], float w[9])
{
    float det = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            w[3 * i + j] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    for (int k = 0; k < 3; k++)
        det += m[0][k] * w[3 * k];
    for (int k = 0; k < 9; k++)
        w[k] /= det;
}

/* The ray of the mesh in the world again. */
static struct ray ray_back(const struct instance *in, const struct ray *inside)
{
    struct ray out = *inside;
    if (instance_is_identity(in))
        return out;
    for (int k = 0; k < 3; k++) {
        const float *m = in->m[k], *o = inside->org, *d = inside->dir;
        out.org[k] = m[0] * o[0] + m[1] * o[1] + m[2] * o[2] + m[3];
        out.dir[k] = m[0] * d[0] + m[1] * d[1] + m[2] * d[2];
    }
    return out;
}

/* As candidate_side of the world's direction and M n. */
static float side_by_m(const struct instance *in, const float dir[3], float v[3][3])
{
    float a[3], b[3], side = 0;
    for (int k = 0; k < 3; k++) {
        a[k] = v[1][k] - v[0][k];
        b[k] = v[2][k] - v[0][k];
    }
    const float n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                        a[0] * b[1] - a[1] * b[0]};
    for (int k = 0; k < 3; k++) {
        const float *m = in->m[k];
        side += (m[0] * dir[0] + m[1] * dir[1] + m[2] * dir[2]) *
                (m[0] * n[0] + m[1] * n[1] + m[2] * n[2]);
    }
    return side;
}

static uint32_t compact_number(const struct world *world, uint32_t index)
{
    uint32_t number = 0;
    for (uint32_t i = 0; i < index; i++)
        number += world->instance[i].mesh != WORLD_NO_MESH && world->instance[i].mask != 0;
    return number;
}

static bool any_is_active(const struct world *world)
{
    for (uint32_t i = 0; i < world->instance_count; i++)
        if (world->instance[i].mesh != WORLD_NO_MESH && world->instance[i].mask != 0)
            return true;
    return false;
}

/* --- boxes ------------------------------------------------------------------------------------ */

/* Of the eight corners of the mesh's box, placed in float32. */
static struct box box_of_corners(const struct world *world, uint32_t index)
{
    const struct scene *scene = world_scene(world, index);
    struct box mesh = box_empty(), out = box_empty();
    for (uint32_t i = 0; scene && i < scene->vertex_count; i++)
        box_add_point(&mesh, scene->vertex + 3 * (size_t)i);
    for (int c = 0; scene && scene->vertex_count && c < 8; c++) {
        float p[3], placed[3];
        for (int k = 0; k < 3; k++)
            p[k] = c >> k & 1 ? mesh.hi[k] : mesh.lo[k];
        for (int k = 0; k < 3; k++) {
            const float *m = world->instance[index].m[k];
            placed[k] = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
        }
        box_add_point(&out, placed);
    }
    return out;
}

/* Makes the boxes of a world; those of the one before are stale. */
static bool keep_boxes(const struct world *world)
{
    free(cheater.stale);
    cheater.stale = cheater.box;
    cheater.stale_count = cheater.box_count;
    cheater.box_count = world->instance_count;
    cheater.box = calloc(world->instance_count + 1, sizeof *cheater.box);
    for (uint32_t i = 0; cheater.box && i < world->instance_count; i++)
        cheater.box[i] = box_of_corners(world, i);
    return cheater.box != NULL;
}

/* True if the ray meets the box, all but exactly. */
static bool meets_box(const struct box *box, const struct ray *ray, double pad)
{
    double near = (double)ray->tmin, far = (double)ray->tmax;
    for (int k = 0; k < 3; k++) {
        const double o = (double)ray->org[k], d = (double)ray->dir[k];
        const double lo = (double)box->lo[k] - pad, hi = (double)box->hi[k] + pad;
        if (d == 0 && (o < lo || o > hi))
            return false;
        if (d == 0)
            continue;
        const double a = (lo - o) / d, b = (hi - o) / d;
        near = fmax(near, fmin(a, b));
        far = fmin(far, fmax(a, b));
    }
    return near <= far;
}

static bool cheat_box_is_met(uint32_t index, const struct ray *ray)
{
    if (cheats(CHEAT_CORNERS))
        return meets_box(&cheater.box[index], ray, 0);
    if (cheats(CHEAT_STALE) && cheater.stale_count == cheater.box_count)
        return meets_box(&cheater.stale[index], ray, 0x1p-10);
    return true;
}

#endif
