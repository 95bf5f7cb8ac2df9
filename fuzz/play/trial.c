#include "fuzz/play/trial.h"

#include "fuzz/play/trial_weight.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum status fuzz_trial_make(uint32_t vertices, uint32_t triangles, uint32_t rays,
                            struct fuzz_trial *out, struct reason *reason)
{
    *out = (struct fuzz_trial){.ray_count = rays,
                               .builder = builders[0],
                               .build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT},
                               .box = box_tests[0],
                               .tri = tri_tests[0],
                               .query = QUERY_CLOSEST,
                               .store = tri_stores[0]};
    if (triangles > FUZZ_TRIANGLES_MOST || vertices > 3 * FUZZ_TRIANGLES_MOST ||
        rays > FUZZ_RAYS_MOST) {
        *out = (struct fuzz_trial){0};
        return fail(reason, STATUS_LIMIT, "a trial has at most %u triangles and %u rays",
                    FUZZ_TRIANGLES_MOST, FUZZ_RAYS_MOST);
    }
    out->ray = alloc_zeroed(rays, sizeof *out->ray);
    if (!out->ray || scene_make(vertices, triangles, &out->scene)) {
        fuzz_trial_free(out);
        return fail(reason, STATUS_MEMORY, "no memory for a trial of %u triangles", triangles);
    }
    return STATUS_OK;
}

enum status fuzz_trial_copy(const struct fuzz_trial *trial, struct fuzz_trial *out,
                            struct reason *reason)
{
    const struct scene *scene = &trial->scene;
    enum status status =
        fuzz_trial_make(scene->vertex_count, scene->tri_count, trial->ray_count, out, reason);
    if (status)
        return status;
    struct fuzz_trial owned = *out;
    status = trial_world_copy(&trial->world, trial->ray_count, &owned.world, reason);
    if (status) {
        fuzz_trial_free(out);
        return status;
    }
    *out = *trial;
    out->scene = owned.scene;
    out->world = owned.world;
    out->ray = owned.ray;
    memcpy(out->scene.vertex, scene->vertex, 12 * (size_t)scene->vertex_count);
    memcpy(out->scene.index, scene->index, 12 * (size_t)scene->tri_count);
    memcpy(out->ray, trial->ray, sizeof *trial->ray * trial->ray_count);
    return STATUS_OK;
}

void fuzz_trial_free(struct fuzz_trial *trial)
{
    scene_free(&trial->scene);
    trial_world_free(&trial->world);
    free(trial->ray);
    *trial = (struct fuzz_trial){0};
}

struct fuzz_trial fuzz_trial_rays_from(const struct fuzz_trial *trial, uint32_t first,
                                       uint32_t count)
{
    struct fuzz_trial part = *trial;
    part.ray += first;
    part.ray_count = count;
    if (part.world.is)
        part.world.mode += first;
    return part;
}

static uint64_t mix_text(uint64_t hash, const char *text)
{
    for (; *text; text++)
        hash = trial_mix_u32(hash, (unsigned char)*text);
    return trial_mix_u32(hash, 0);
}

uint64_t fuzz_trial_hash(const struct fuzz_trial *trial)
{
    const struct scene *scene = &trial->scene;
    uint64_t hash = 0xCBF29CE484222325u;
    hash = trial_mix_u32(trial_mix_u32(trial_mix_u32(hash, scene->vertex_count), scene->tri_count),
                         trial->ray_count);
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        hash = trial_mix_float(hash, scene->vertex[i]);
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++)
        hash = trial_mix_u32(hash, scene->index[i]);
    for (uint32_t i = 0; i < trial->ray_count; i++) {
        const struct ray *ray = &trial->ray[i];
        for (int k = 0; k < 3; k++)
            hash = trial_mix_float(trial_mix_float(hash, ray->org[k]), ray->dir[k]);
        hash = trial_mix_float(trial_mix_float(hash, ray->tmin), ray->tmax);
    }
    hash = mix_text(mix_text(mix_text(hash, trial->builder->name), trial->box->name),
                    trial->tri->name);
    hash = trial_mix_u32(hash, (uint32_t)trial->query);
    hash = trial_mix_float(trial_mix_u32(hash, trial->build.leaf), trial->build.eps);
    /* What older trials had not; its default keeps their hashes. */
    if (trial->build.passes > 0)
        hash = trial_mix_u32(mix_text(hash, trial->build.rotates ? "rotate" : "passes"),
                             trial->build.passes);
    if (trial->build.presplit > 0)
        hash = trial_mix_float(mix_text(hash, "presplit"), trial->build.presplit);
    if (trial->store != tri_stores[0])
        hash = mix_text(mix_text(hash, "store"), trial->store->name);
    if (trial->move > 0) {
        hash = trial_mix_float(mix_text(hash, "move"), trial->move);
        hash = trial_mix_u32(trial_mix_u32(hash, (uint32_t)trial->move_seed),
                             (uint32_t)(trial->move_seed >> 32));
    }
    if (trial->step_count > 0) {
        char steps[STEPS_TEXT_MOST];
        steps_write(trial->step, trial->step_count, steps);
        hash = mix_text(mix_text(hash, "steps"), steps);
    }
    return trial->world.is ? trial_world_hash(&trial->world, trial->ray_count, hash) : hash;
}

uint64_t trial_float_weight(float x)
{
    uint32_t bits = float_bits(x) & 0x7FFFFFFFu, fraction = bits & 0x7FFFFFu;
    if (bits == 0)
        return float_bits(x) >> 31;
    int exponent = (int)(bits >> 23) - 127;
    if (exponent == 128)
        return fraction ? 9 : 8;
    uint64_t weight = 1;
    for (; fraction & 0x7FFFFFu; fraction <<= 1)
        weight++;
    for (int rest = exponent < 0 ? -exponent : exponent; rest; rest /= 2)
        weight++;
    return weight + (float_bits(x) >> 31);
}

/* Corners whose vertex is not numbered in the order in which triangles name them. */
static uint64_t disorder(const struct scene *scene)
{
    uint64_t out_of_order = 0;
    uint32_t next = 0;
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++)
        if (scene->index[i] == next)
            next++;
        else if (scene->index[i] > next)
            out_of_order++;
    return out_of_order;
}

/* 0 for what fuzz_trial_make sets; else more the farther down its table a member stands. */
/* Of a step's seed. */
static uint64_t step_weight(const struct step *step)
{
    uint64_t weight = 0;
    for (uint64_t rest = step->seed; rest; rest /= 2)
        weight++;
    return weight;
}

static uint64_t member_weight(const struct fuzz_trial *trial)
{
    uint64_t weight = trial->query != QUERY_CLOSEST;
    for (size_t i = 0; builders_all[i] && builders_all[i] != trial->builder; i++)
        weight++;
    for (size_t i = 0; box_tests[i] && box_tests[i] != trial->box; i++)
        weight++;
    for (size_t i = 0; tri_tests[i] && tri_tests[i] != trial->tri; i++)
        weight++;
    if (trial->build.leaf != BUILD_LEAF_DEFAULT)
        weight += 1 + (uint64_t)trial->build.leaf;
    if (trial->build.eps != BUILD_EPS_DEFAULT)
        weight += 1 + trial_float_weight(trial->build.eps);
    for (size_t i = 0; tri_stores[i] && tri_stores[i] != trial->store; i++)
        weight++;
    weight += trial->build.passes + (trial->build.passes > 0 && trial->build.rotates);
    if (trial->build.presplit > 0)
        weight += 1 + trial_float_weight(trial->build.presplit);
    if (trial->move > 0)
        weight += 1 + trial_float_weight(trial->move) + (trial->move_seed > 0);
    for (uint32_t i = 0; i < trial->step_count; i++)
        weight +=
            (uint64_t)trial->step[i].motion + trial->step[i].act + step_weight(&trial->step[i]);
    return weight;
}

struct fuzz_trial_size fuzz_trial_size(const struct fuzz_trial *trial)
{
    const struct scene *scene = &trial->scene;
    const struct trial_world *world = &trial->world;
    struct fuzz_trial_size size = {.steps = trial->step_count,
                                   .instances = world->instance_count,
                                   .triangles = scene->tri_count,
                                   .rays = trial->ray_count,
                                   .vertices = scene->vertex_count,
                                   .places = trial_world_places(world),
                                   .bits = trial_world_weight(world, trial->ray_count),
                                   .hash = fuzz_trial_hash(trial)};
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        size.bits += trial_float_weight(scene->vertex[i]);
    for (size_t i = 0; i < trial->ray_count; i++) {
        const struct ray *ray = &trial->ray[i];
        for (int k = 0; k < 3; k++)
            size.bits += trial_float_weight(ray->org[k]) + trial_float_weight(ray->dir[k]);
        size.bits += trial_float_weight(ray->tmin);
        size.bits += ray->tmax == INFINITY ? 0 : 1 + trial_float_weight(ray->tmax);
    }
    size.bits += disorder(scene) + member_weight(trial);
    return size;
}

static int compare(uint64_t a, uint64_t b)
{
    return a < b ? -1 : a > b;
}

int fuzz_trial_size_compare(const struct fuzz_trial_size *a, const struct fuzz_trial_size *b)
{
    int order = compare(a->steps, b->steps);
    if (!order)
        order = compare(a->instances, b->instances);
    if (!order)
        order = compare(a->triangles, b->triangles);
    if (!order)
        order = compare(a->rays, b->rays);
    if (!order)
        order = compare(a->vertices, b->vertices);
    if (!order)
        order = compare(a->places, b->places);
    if (!order)
        order = compare(a->bits, b->bits);
    return order ? order : compare(a->hash, b->hash);
}

enum status fuzz_trial_check(const struct fuzz_trial *trial, struct reason *reason)
{
    const struct scene *scene = &trial->scene;
    if (!trial->builder || !trial->box || !trial->tri || !trial->store)
        return fail(reason, STATUS_INPUT,
                    "a trial names a builder, a box and a triangle test, and a storage");
    if (trial->query != QUERY_CLOSEST && trial->query != QUERY_ANY)
        return fail(reason, STATUS_INPUT, "a trial's query is closest or any");
    if (trial->build.leaf == 0 || !(trial->build.eps >= 0) || !float_is_finite(trial->build.eps))
        return fail(reason, STATUS_INPUT, "a trial's leaf is 1 or more, its eps 0 or more");
    if (trial->build.passes > FUZZ_PASSES_MOST ||
        !(trial->move >= 0 && trial->move <= FUZZ_MOVE_MOST))
        return fail(reason, STATUS_INPUT,
                    "a trial has at most %u passes of optimization, and moves by "
                    "0 to %g extents",
                    FUZZ_PASSES_MOST, (double)FUZZ_MOVE_MOST);
    if (!(trial->build.presplit >= 0 && trial->build.presplit <= FUZZ_PRESPLIT_MOST))
        return fail(reason, STATUS_INPUT, "the parts of a trial are 0 to %g of its triangles",
                    (double)FUZZ_PRESPLIT_MOST);
    if (trial->build.presplit > 0 && !builder_takes(trial->builder, "presplit"))
        return fail(reason, STATUS_INPUT, "builder %s takes no parts of triangles",
                    trial->builder->name);
    if (trial->build.passes > 0 && trial->builder->faithful)
        return fail(reason, STATUS_INPUT, "builder %s builds as published: it is not optimized",
                    trial->builder->name);
    if (tri_store_check(trial->store, trial->tri->id, trial->tri->name, reason))
        return STATUS_INPUT;
    if (scene->tri_count > FUZZ_TRIANGLES_MOST || trial->ray_count > FUZZ_RAYS_MOST)
        return fail(reason, STATUS_LIMIT, "a trial has at most %u triangles and %u rays",
                    FUZZ_TRIANGLES_MOST, FUZZ_RAYS_MOST);
    if (trial->step_count > LIFE_STEPS_MOST || (trial->step_count > 0 && trial->move > 0))
        return fail(reason, STATUS_INPUT, "a trial has at most %u steps, and none if it moves",
                    LIFE_STEPS_MOST);
    if (!trial->world.is && steps_of_scene(trial->step, trial->step_count, reason))
        return STATUS_INPUT;
    if (trial->world.is && trial->move > 0)
        return fail(reason, STATUS_INPUT, "a trial of a world does not move");
    enum status status = scene_check(scene, reason);
    if (!status && trial->world.is)
        status = trial_world_check(&trial->world, scene, trial->ray_count, reason);
    return status;
}
