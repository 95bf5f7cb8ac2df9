/* Motions of what is placed in a world. */
#include "ref/base/rng.h"
#include "ref/world/object_ray.h"
#include "ref/world/world_boxes.h"
#include "scenes/world_steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DRIFTS      12u /* amounts of MOTION_DRIFT */
#define TURNS       8u  /* of MOTION_TURN */
#define AWAYS       24u /* of MOTION_AWAY */
#define AXES        3u
#define MASK_BITS   8u
#define SCALE_MOST  3 /* MOTION_SCALE: powers of two from -3 to 3 */
#define STREAM_EACH 0x696E7374u

/* --- what can be placed ----------------------------------------------------------------------- */

/* The largest coordinate that a vertex of the mesh can have where the instance is. */
static double reach_of(const struct instance *instance, const struct box *box)
{
    double most = 0;
    for (int i = 0; i < 3; i++) {
        double sum = fabs((double)instance->m[i][3]);
        for (int k = 0; k < 3; k++)
            sum += fabs((double)instance->m[i][k]) *
                   fmax(fabs((double)box->lo[k]), fabs((double)box->hi[k]));
        most = fmax(most, sum);
    }
    return most;
}

/* The boxes of the meshes; zero ones without triangles. Caller frees; NULL if out of memory. */
static struct box *mesh_boxes(const struct world *world)
{
    struct box *box = alloc_zeroed(world->mesh_count, sizeof *box);
    for (uint32_t i = 0; i < world->mesh_count && box; i++)
        if (world->mesh[i].scene->tri_count > 0)
            box[i] = scene_bounds(world->mesh[i].scene);
    return box;
}

/* The box of the instance's mesh. */
static struct box box_of(const struct instance *instance, const struct box *box)
{
    return instance->mesh == WORLD_NO_MESH ? (struct box){{0, 0, 0}, {0, 0, 0}}
                                           : box[instance->mesh];
}

static bool reaches(double reach, double before)
{
    return reach < WORLD_REACH || reach <= before;
}

/* Gives the instance its new transform, or leaves it where it is if that cannot be placed. */
static void place(struct world *world, uint32_t at, const struct box *box,
                  const struct instance *moved)
{
    float w[9];
    struct instance *instance = &world->instance[at];
    const struct instance before = *instance;
    const struct box mesh = box_of(instance, box);
    *instance = *moved;
    if (world_check_instance(world, at, NULL) || transform_inverse(moved->m, w, NULL) ||
        !reaches(reach_of(moved, &mesh), reach_of(&before, &mesh)))
        *instance = before;
}

/* The longest side of a box around all that is active; 0 if nothing is. */
static double longest_side(const struct world *world, const struct box *box)
{
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    double most = 0;
    for (uint32_t n = 0; n < world->instance_count; n++) {
        const struct instance *instance = &world->instance[n];
        if (!world_is_active(world, n))
            continue;
        for (int i = 0; i < 3; i++) {
            double from = (double)instance->m[i][3], to = from;
            for (int k = 0; k < 3; k++) {
                const double a = (double)instance->m[i][k] * (double)box[instance->mesh].lo[k];
                const double b = (double)instance->m[i][k] * (double)box[instance->mesh].hi[k];
                from += fmin(a, b);
                to += fmax(a, b);
            }
            lo[i] = fmin(lo[i], from);
            hi[i] = fmax(hi[i], to);
        }
    }
    for (int i = 0; i < 3; i++)
        most = fmax(most, hi[i] > lo[i] ? hi[i] - lo[i] : 0.0);
    return most;
}

/* --- motions of one instance ------------------------------------------------------------------ */

static void drift(struct instance *instance, struct rng *rng, double most)
{
    for (int i = 0; i < 3; i++)
        instance->m[i][3] =
            (float)((double)instance->m[i][3] + most * (2 * (double)rng_float(rng) - 1));
}

/* By the rotation of the quaternion (1, x, y, z): only + - * / of doubles, on any machine the same.
 */
static void turn(struct instance *instance, struct rng *rng, double most)
{
    double q[3], m[3][3];
    for (int k = 0; k < 3; k++)
        q[k] = most * (2 * (double)rng_float(rng) - 1);
    const double s = 2 / (1 + q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    const double x = q[0], y = q[1], z = q[2];
    const double r[3][3] = {{1 - s * (y * y + z * z), s * (x * y - z), s * (x * z + y)},
                            {s * (x * y + z), 1 - s * (x * x + z * z), s * (y * z - x)},
                            {s * (x * z - y), s * (y * z + x), 1 - s * (x * x + y * y)}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            m[i][k] = r[i][0] * (double)instance->m[0][k] + r[i][1] * (double)instance->m[1][k] +
                      r[i][2] * (double)instance->m[2][k];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            instance->m[i][k] = (float)m[i][k];
}

static void scale(struct instance *instance, struct rng *rng)
{
    const float by = ldexpf(1.0f, (int)rng_below(rng, 2 * SCALE_MOST + 1) - SCALE_MOST);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            instance->m[i][k] *= by;
}

static void reflect(struct instance *instance, uint64_t axis)
{
    for (int k = 0; k < 4; k++)
        instance->m[axis][k] = -instance->m[axis][k];
}

/* What all instances are moved with. */
struct placed_motion {
    const struct step *step;
    double side; /* longest side of the world */
    float to[3]; /* origin of one of them */
};

static void move(const struct placed_motion *motion, uint32_t at, struct instance *instance)
{
    const uint64_t seed = motion->step->seed;
    struct rng of_seed = rng_make(seed, STREAM_EACH);
    struct rng rng = rng_make(rng_u64(&of_seed), at);
    switch (motion->step->motion) {
    case MOTION_DRIFT:
        drift(instance, &rng, ldexp(motion->side, -(int)(seed % DRIFTS)));
        break;
    case MOTION_TURN:
        turn(instance, &rng, ldexp(1.0, -(int)(seed % TURNS)));
        break;
    case MOTION_REFLECT:
        reflect(instance, seed % AXES);
        break;
    case MOTION_SCALE:
        scale(instance, &rng);
        break;
    case MOTION_GATHER:
        for (int i = 0; i < 3; i++)
            instance->m[i][3] = motion->to[i];
        break;
    case MOTION_AWAY:
        instance->m[seed / AWAYS % AXES][3] = (float)((double)instance->m[seed / AWAYS % AXES][3] +
                                                      ldexp(motion->side, 1 + (int)(seed % AWAYS)));
        break;
    default:
        break;
    }
}

static void move_all(const struct step *step, const struct box *box, struct world *world)
{
    const struct instance *one = &world->instance[step->seed % world->instance_count];
    const struct placed_motion motion = {
        step, longest_side(world, box), {one->m[0][3], one->m[1][3], one->m[2][3]}};
    for (uint32_t i = 0; i < world->instance_count; i++) {
        struct instance moved = world->instance[i];
        move(&motion, i, &moved);
        place(world, i, box, &moved);
    }
}

/* --- of masks, of two ------------------------------------------------------------------------- */

static void turn_masks(struct world *world, uint64_t seed)
{
    const uint32_t by = 1 + (uint32_t)(seed % (MASK_BITS - 1));
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const uint32_t mask = world->instance[i].mask;
        world->instance[i].mask = (mask << by | mask >> (MASK_BITS - by)) & 0xFFu;
    }
}

static uint32_t hidden_mask(const struct world *world, struct rng *rng, uint32_t at)
{
    const uint32_t mask = world->instance[at].mask;
    return rng_below(rng, 2) == 0 ? mask : mask ? 0 : 0xFF;
}

/* Hides or shows every second instance, if something is active then. */
static void hide(struct world *world, uint64_t seed)
{
    struct rng rng = rng_make(seed, 3), again = rng;
    bool active = false;
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct scene *scene = world_scene(world, i);
        active |= hidden_mask(world, &rng, i) != 0 && scene && scene->tri_count > 0;
    }
    for (uint32_t i = 0; i < world->instance_count && active; i++)
        world->instance[i].mask = hidden_mask(world, &again, i);
}

static void exchange(struct world *world, uint64_t seed)
{
    struct rng rng = rng_make(seed, 4);
    const uint32_t a = rng_below(&rng, world->instance_count);
    const uint32_t b = rng_below(&rng, world->instance_count);
    const struct instance kept = world->instance[a];
    world->instance[a] = world->instance[b];
    world->instance[b] = kept;
}

/* --- vertices --------------------------------------------------------------------------------- */

/* The furthest that an instance of each mesh reaches. */
static void add_reaches(const struct world *world, const struct box *box, double *reach)
{
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct instance *instance = &world->instance[i];
        if (instance->mesh != WORLD_NO_MESH)
            reach[instance->mesh] =
                fmax(reach[instance->mesh], reach_of(instance, &box[instance->mesh]));
    }
}

/* Moves the vertices of all meshes; those of a mesh that reaches too far then go back. `vertex` has
 * room for all of them, `reach` for two numbers a mesh. */
static void move_meshes(const struct step *step, struct world *world, struct box *box,
                        float *vertex, double *reach)
{
    double *now = reach + world->mesh_count;
    add_reaches(world, box, reach);
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        struct scene *scene = world->mesh[i].scene;
        const size_t bytes = 12 * (size_t)scene->vertex_count;
        memcpy(vertex, scene->vertex, bytes);
        vertex += 3 * (size_t)scene->vertex_count;
        motion_apply(step, scene);
        if (scene->tri_count > 0)
            box[i] = scene_bounds(scene);
    }
    add_reaches(world, box, now);
    for (uint32_t i = world->mesh_count; i-- > 0;) {
        struct scene *scene = world->mesh[i].scene;
        vertex -= 3 * (size_t)scene->vertex_count;
        if (!reaches(now[i], reach[i]))
            memcpy(scene->vertex, vertex, 12 * (size_t)scene->vertex_count);
    }
}

static enum status move_vertices(const struct step *step, struct world *world, struct box *box)
{
    size_t vertices = 0;
    for (uint32_t i = 0; i < world->mesh_count; i++)
        vertices += world->mesh[i].scene->vertex_count;
    float *vertex = alloc_zeroed(vertices, 3 * sizeof *vertex);
    double *reach = alloc_zeroed(2 * (size_t)world->mesh_count, sizeof *reach);
    const bool room = vertex && reach;
    if (room)
        move_meshes(step, world, box, vertex, reach);
    free(vertex);
    free(reach);
    return room ? STATUS_OK : STATUS_MEMORY;
}

enum status world_motion_apply(const struct step *step, struct world *world, struct reason *reason)
{
    enum status status = STATUS_OK;
    struct box *box = mesh_boxes(world);
    if (!box)
        status = STATUS_MEMORY;
    else if (!motion_is_of_worlds(step->motion))
        status = move_vertices(step, world, box);
    else if (world->instance_count == 0)
        ; /* nothing can move */
    else if (step->motion == MOTION_MASKS)
        turn_masks(world, step->seed);
    else if (step->motion == MOTION_HIDE)
        hide(world, step->seed);
    else if (step->motion == MOTION_EXCHANGE)
        exchange(world, step->seed);
    else
        move_all(step, box, world);
    free(box);
    return status ? fail(reason, status, "no memory to move a world of %u instances",
                         world->instance_count)
                  : STATUS_OK;
}
