/* raydiff tree --from E --aim N: whether boxes of instances that are too small cost hits. A ray
 * stays in a plane between the end of such a box and the exact vertex beyond it, and the oracle
 * tells whether it hits the instance there. What the driver then misses it has to find in the same
 * world with larger boxes of meshes, or the box was not why. */
#include "cmd/tree/cmd_tree_aim.h"

#include "gpu/engines/rayquery_named.h"
#include "ref/oracle/oracle_world.h"
#include "ref/world/placed.h"
#include "scenes/worlds.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AIM_SEED 1u

/* --- rays ------------------------------------------------------------------------------------- */

static void place(const float m[3][4], const float v[3], double out[3])
{
    double unused;
    for (int k = 0; k < 3; k++)
        out[k] = placed_about(m[k], v, &unused);
}

/* A triangle of which a vertex is beyond the bound, drawn, and its number of that vertex. Returns
 * false if there is none among the few that are looked at. */
static bool draw_triangle(const struct scene *mesh, const float row[4],
                          const struct dump_side *goal, struct rng *rng, uint32_t *tri,
                          unsigned *corner)
{
    const uint32_t start = rng_below(rng, 3 * mesh->tri_count);
    for (uint32_t i = 0; i < 3 * mesh->tri_count; i++) {
        const uint32_t at = (start + i) % (3 * mesh->tri_count);
        if (placed_compare(row, mesh->vertex + 3 * (size_t)at, goal->bound) *
                (goal->side < 3 ? -1 : 1) <=
            0)
            continue;
        *tri = at / 3;
        *corner = at % 3;
        return true;
    }
    return false;
}

/* A point of the triangle that is about beyond the bound: from the vertex there, parts of the edges
 * that leave it so far. */
static void draw_point(const double v[3][3], unsigned corner, const struct dump_side *goal,
                       struct rng *rng, double out[3])
{
    const unsigned k = goal->side % 3;
    const double lacks = fabs(v[corner][k] - (double)goal->bound);
    double share = 1;
    memcpy(out, v[corner], 3 * sizeof *out);
    for (unsigned e = 1; e < 3; e++) {
        const double *to = v[(corner + e) % 3], falls = fabs(to[k] - v[corner][k]);
        const double most = falls > lacks ? lacks / falls : 1,
                     part = share * (double)rng_float(rng);
        for (int c = 0; c < 3; c++)
            out[c] += part * most * (to[c] - v[corner][c]);
        share -= part;
    }
}

/* The float next to x that is strictly beyond the bound. */
static float beyond(double x, const struct dump_side *goal)
{
    const float near = (float)x, end = goal->side < 3 ? -INFINITY : INFINITY;
    const bool is_beyond = goal->side < 3 ? near < goal->bound : near > goal->bound;
    return is_beyond ? near : nextafterf(goal->bound, end);
}

bool tree_aim_ray(const struct tree_dump *dump, const struct dump_side *goal, struct rng *rng,
                  struct ray *out)
{
    const struct dump_instance *instance = &dump->instance[goal->item];
    const struct scene *mesh = &dump->below[instance->below].scene;
    const unsigned k = goal->side % 3, j = (k + 1 + rng_below(rng, 2)) % 3, i = 3 - k - j;
    double v[3][3], point[3];
    uint32_t tri;
    unsigned corner;
    if (!draw_triangle(mesh, instance->m[k], goal, rng, &tri, &corner))
        return false;
    for (size_t c = 0; c < 3; c++)
        place(instance->m, mesh->vertex + 9 * (size_t)tri + 3 * c, v[c]);
    draw_point(v, corner, goal, rng, point);
    const float way = rng_below(rng, 2) ? -1.0f : 1.0f;
    const float far = (float)fmax(fabs(point[j]), 1) * 2;
    *out = (struct ray){.tmax = INFINITY};
    out->dir[j] = way;
    out->org[k] = beyond(point[k], goal);
    out->org[i] = (float)point[i];
    out->org[j] = (float)point[j] - way * far;
    return true;
}

/* --- answers ---------------------------------------------------------------------------------- */

enum status tree_aim_enlarge(struct world *world, struct reason *reason)
{
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        struct world_mesh *mesh = &world->mesh[i];
        const struct scene *from = mesh->scene;
        const struct box box = scene_bounds(from);
        if (from->tri_count == 0)
            continue;
        struct scene *to = alloc_zeroed(1, sizeof *to);
        if (!to || scene_make(from->vertex_count + 2, from->tri_count + 2, to)) {
            free(to);
            return fail(reason, STATUS_MEMORY, "no memory for a mesh");
        }
        memcpy(to->vertex, from->vertex, 3 * sizeof(float) * from->vertex_count);
        memcpy(to->index, from->index, 3 * sizeof(uint32_t) * from->tri_count);
        for (int k = 0; k < 3; k++) {
            const float by = 0.25f * (box.hi[k] - box.lo[k]) + 0x1p-10f * fabsf(box.hi[k]);
            to->vertex[3 * (size_t)from->vertex_count + (size_t)k] =
                fmaxf(box.lo[k] - by, -FLT_MAX);
            to->vertex[3 * (size_t)from->vertex_count + 3 + (size_t)k] =
                fminf(box.hi[k] + by, FLT_MAX);
        }
        for (uint32_t c = 0; c < 6; c++)
            to->index[3 * (size_t)from->tri_count + c] = from->vertex_count + c / 3;
        scene_free(mesh->scene);
        free(mesh->scene);
        mesh->scene = to;
        mesh->geometry[mesh->geometry_count - 1].count += 2;
    }
    free(world->first);
    world->first = NULL;
    return world_finish(world, reason);
}

/* The instance that the driver finds for each ray; UINT32_MAX: none. */
static enum status ask_driver(const struct tree_command *command, const struct world *world,
                              const struct aiming *aiming, uint32_t *instance,
                              struct reason *reason)
{
    const struct engine *engine = engine_find("rayquery");
    struct hit *hit = alloc_zeroed(aiming->count, sizeof *hit);
    uint32_t *tag = alloc_zeroed(aiming->count, sizeof *tag);
    struct trace_report report;
    void *self = NULL;
    enum status status = hit && tag ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for rays");
    if (!status && strcmp(command->from, engine->name) != 0)
        status = rayquery_named(command->from, &engine, reason);
    if (!status)
        status = engine_open(engine, &command->engines, &self, reason);
    const struct world_job job = {
        .world = world, .box = box_tests[0], .tri = tri_tests[0], .query = QUERY_CLOSEST};
    if (!status)
        status = engine->worlds->prepare_world(self, &job, reason);
    if (!status)
        status = engine->worlds->trace_world(self, aiming->ray, NULL, aiming->count, hit, tag,
                                             &report, reason);
    for (uint32_t i = 0; i < aiming->count && !status; i++)
        instance[i] =
            hit[i].prim == ABI_NO_PRIM ? UINT32_MAX : world_instance_of(world, hit[i].prim);
    if (self)
        engine->close(self);
    free(hit);
    free(tag);
    return status;
}

/* The instance that each ray exactly hits first. */
static enum status ask_oracle(const struct world *world, const struct aiming *aiming,
                              uint32_t *instance, struct reason *reason)
{
    struct oracle *oracle = NULL;
    struct oracle_stats stats;
    struct oracle_answer *answer = alloc_zeroed(aiming->count, sizeof *answer);
    enum status status = answer ? oracle_make_world(world, &oracle, reason)
                                : fail(reason, STATUS_MEMORY, "no memory for rays");
    if (!status)
        status = oracle_closest_world(oracle, ORACLE_AUTO, ORACLE_OPEN, aiming->ray, NULL,
                                      aiming->count, 0, answer, &stats, reason);
    for (uint32_t i = 0; i < aiming->count && !status; i++)
        instance[i] = answer[i].prim == ABI_NO_PRIM || answer[i].tie_count > 1
                          ? UINT32_MAX
                          : world_instance_of(world, answer[i].prim);
    oracle_free(oracle);
    free(answer);
    return status;
}

void tree_aim_count(const struct aiming *aiming, const uint32_t *exact, const uint32_t *driver,
                    const uint32_t *larger, struct tree_aimed *out)
{
    for (uint32_t i = 0; i < aiming->count; i++) {
        const uint32_t number = aiming->told->dump->instance[aiming->goal[i].item].number;
        if (exact[i] != number)
            continue;
        out->aimed++;
        if (driver[i] == number)
            continue;
        out->lost++;
        if (larger[i] != number)
            continue;
        if (out->found++ > 0)
            continue;
        out->ray = aiming->ray[i];
        out->instance = number;
        out->side = aiming->goal[i].side;
    }
}

static enum status play(const struct tree_command *command, struct world *world,
                        const struct aiming *aiming, struct tree_aimed *out, struct reason *reason)
{
    uint32_t *found = alloc_zeroed(3 * (size_t)aiming->count, sizeof *found);
    enum status status =
        found ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for %u rays", aiming->count);
    if (!status)
        status = ask_oracle(world, aiming, found, reason);
    if (!status)
        status = ask_driver(command, world, aiming, found + aiming->count, reason);
    if (!status)
        status = tree_aim_enlarge(world, reason);
    if (!status)
        status = ask_driver(command, world, aiming, found + 2 * (size_t)aiming->count, reason);
    if (!status)
        tree_aim_count(aiming, found, found + aiming->count, found + 2 * (size_t)aiming->count,
                       out);
    free(found);
    return status;
}

enum status tree_aim(const struct tree_command *command, const char *spec, struct tree_told *told,
                     struct reason *reason)
{
    struct world world = {0};
    struct rng rng = rng_make(AIM_SEED, 0);
    struct ray *ray = alloc_zeroed(command->aim, sizeof *ray);
    struct dump_side *goal = alloc_zeroed(command->aim, sizeof *goal);
    struct aiming aiming = {.told = told, .goal = goal, .ray = ray};
    enum status status = ray && goal
                             ? world_open(spec, 1, &world, reason)
                             : fail(reason, STATUS_MEMORY, "no memory for %u rays", command->aim);
    for (uint32_t i = 0; i < command->aim && told->lacks.sides && !status; i++) {
        goal[aiming.count] = told->lacks.side[i % told->lacks.sides];
        aiming.count += tree_aim_ray(told->dump, &goal[aiming.count], &rng, &ray[aiming.count]);
    }
    told->aimed = (struct tree_aimed){.done = true, .tries = aiming.count};
    if (!status && aiming.count)
        status = play(command, &world, &aiming, &told->aimed, reason);
    world_free(&world);
    free(ray);
    free(goal);
    return status;
}
