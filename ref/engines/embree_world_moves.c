/* Worlds in Embree that move: new vertices in Embree's own buffers, new transforms, masks and
 * scenes of its instances, and all that has changed committed again. */
#include "ref/engines/embree_device.h"

#if HAVE_EMBREE

#include "ref/engines/embree_world_inner.h"
#include "ref/world/world_boxes.h"

#include <string.h>

/* The geometries of a mesh share one buffer of vertices. */
static enum status move_mesh(struct embree *embree, const struct world_mesh *mesh, RTCScene scene,
                             struct reason *reason)
{
    if (!scene)
        return STATUS_OK;
    for (uint32_t i = 0; i < mesh->geometry_count; i++) {
        if (mesh->geometry[i].count == 0)
            continue;
        RTCGeometry geometry = rtc.GetGeometry(scene, i);
        memcpy(rtc.GetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0), mesh->scene->vertex,
               12 * (size_t)mesh->scene->vertex_count);
        rtc.UpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
        rtc.CommitGeometry(geometry);
    }
    return embree_commit(embree, scene, reason);
}

/* An instance that Embree has and the world, too. */
static enum status move_instance(struct embree *embree, uint32_t number, struct reason *reason)
{
    struct embree_world *world = embree->world;
    const struct instance *instance = &world->world->instance[number];
    uint32_t mask;
    enum status status = embree_instance_mask(embree, number, &mask, reason);
    if (status)
        return status;
    RTCGeometry geometry = rtc.GetGeometry(world->top, number);
    rtc.SetGeometryInstancedScene(geometry, world->mesh[instance->mesh]);
    rtc.SetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, instance->m);
    rtc.SetGeometryMask(geometry, mask);
    rtc.CommitGeometry(geometry);
    return STATUS_OK;
}

static enum status move_each(struct embree *embree, struct reason *reason)
{
    struct embree_world *world = embree->world;
    const struct world *from = world->world;
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < from->instance_count && !status; i++) {
        const bool active = world_is_active(from, i);
        if (active && world->placed[i])
            status = move_instance(embree, i, reason);
        else if (active)
            status = embree_add_instance(embree, i, reason);
        else if (world->placed[i])
            rtc.DetachGeometry(world->top, i);
        world->placed[i] = active;
    }
    return status;
}

enum status embree_move_world(void *self, const struct world_job *job, struct reason *reason)
{
    struct embree *embree = self;
    struct embree_world *world = embree->world;
    enum status status = STATUS_OK;
    world->world = job->world;
    memset(world->class, 0, sizeof world->class);
    for (uint32_t i = 0; i < world->mesh_count && !status; i++)
        status = move_mesh(embree, &job->world->mesh[i], world->mesh[i], reason);
    if (!status)
        status = move_each(embree, reason);
    if (!status)
        status = embree_commit(embree, world->top, reason);
    if (status)
        embree_drop(embree);
    return status;
}

#endif
