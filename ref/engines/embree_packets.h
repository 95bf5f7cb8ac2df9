/* Tracing in packets of 16 rays. Included by embree_device.c only, whose functions it uses. */
#ifndef EMBREE_PACKETS_H
#define EMBREE_PACKETS_H

#define EMBREE_PACKET 16u

/* Writes a ray to lane `i` of a packet. */
static void embree_lane(struct RTCRay16 *to, const struct ray *ray, uint32_t i)
{
    to->org_x[i] = ray->org[0];
    to->org_y[i] = ray->org[1];
    to->org_z[i] = ray->org[2];
    to->tnear[i] = ray->tmin;
    to->dir_x[i] = ray->dir[0];
    to->dir_y[i] = ray->dir[1];
    to->dir_z[i] = ray->dir[2];
    to->time[i] = 0;
    to->tfar[i] = ray->tmax;
    to->mask[i] = 0xFFFFFFFFu;
    to->id[i] = i;
    to->flags[i] = 0;
}

static void embree_packet_ask(const struct embree *embree, const int *valid,
                              struct RTCRayHit16 *packet)
{
#if HAVE_EMBREE == 4
    if (embree->query == QUERY_ANY)
        rtcOccluded16(valid, embree->scene, &packet->ray, NULL);
    else
        rtcIntersect16(valid, embree->scene, packet, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (embree->query == QUERY_ANY)
        rtcOccluded16(valid, embree->scene, &context, &packet->ray);
    else
        rtcIntersect16(valid, embree->scene, &context, packet);
#endif
}

/* Traces up to EMBREE_PACKET rays. Lanes beyond `count`, and lanes of rays that embree_takes
 * rejects, are switched off. */
static void embree_packet(const struct embree *embree, const struct ray *ray, uint32_t count,
                          struct hit *hit)
{
    _Alignas(64) struct RTCRayHit16 packet;
    _Alignas(64) int valid[EMBREE_PACKET];
    const struct ray nothing = {.dir = {0, 0, 1}};
    for (uint32_t i = 0; i < EMBREE_PACKET; i++) {
        bool on = i < count && embree_takes(embree, &ray[i]);
        valid[i] = on ? -1 : 0;
        embree_lane(&packet.ray, on ? &ray[i] : &nothing, i);
        packet.hit.geomID[i] = packet.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    embree_packet_ask(embree, valid, &packet);
    for (uint32_t i = 0; i < count; i++) {
        bool any = embree->query == QUERY_ANY;
        bool found =
            any ? packet.ray.tfar[i] < 0.0f : packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
        found = found && valid[i];
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        if (found && any)
            hit[i].prim = 0;
        else if (found)
            hit[i] = (struct hit){packet.ray.tfar[i], packet.hit.u[i], packet.hit.v[i],
                                  packet.hit.primID[i]};
    }
}

static void embree_packets(struct embree *embree, const struct ray *ray, size_t ray_count,
                           struct hit *hit)
{
    long long packets = (long long)((ray_count + EMBREE_PACKET - 1) / EMBREE_PACKET);
#pragma omp parallel for schedule(dynamic, 4) num_threads(embree->threads) if (packets > 4)
    for (long long i = 0; i < packets; i++) {
        size_t first = (size_t)i * EMBREE_PACKET, left = ray_count - first;
        embree_packet(embree, ray + first, left < EMBREE_PACKET ? (uint32_t)left : EMBREE_PACKET,
                      hit + first);
    }
}

#endif
