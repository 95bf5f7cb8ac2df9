#include "ref/build/refs.h"

#include "ref/build/presplit.h"
#include "ref/build/room.h"

#include <omp.h>
#include <string.h>

#define PARALLEL_LEAST 16384u

uint32_t build_threads(const struct build_options *options, uint32_t count)
{
    if (count < PARALLEL_LEAST)
        return 1;
    return options->threads ? options->threads : (uint32_t)omp_get_max_threads();
}

/* Loads the three coordinates; the fourth lane is arbitrary. */
static lanes vertex_load(const struct scene *scene, uint32_t vertex)
{
    const float *p = scene->vertex + 3 * (size_t)vertex;
    lanes v;
    if (vertex + 1 == scene->vertex_count)
        return (lanes){p[0], p[1], p[2], 0};
    memcpy(&v, p, sizeof v);
    return v;
}

static struct ref ref_of(const struct scene *scene, uint32_t prim)
{
    static const lanes_int first_three = {-1, -1, -1, 0};
    const uint32_t *index = scene->index + 3 * (size_t)prim;
    lanes a = vertex_load(scene, index[0]), b = vertex_load(scene, index[1]);
    lanes c = vertex_load(scene, index[2]);
    lanes_int low = {0, 0, 0, (int32_t)(0x3F800000u | (prim & 0xFFFFu))};
    lanes_int high = {0, 0, 0, (int32_t)(0x3F800000u | prim >> 16)};
    /* Masked before the sum, because the fourth lane may be subnormal, which is slow. */
    lanes_int lo = (lanes_int)lanes_min(lanes_min(a, b), c) & first_three;
    lanes_int hi = (lanes_int)lanes_max(lanes_max(a, b), c) & first_three;
    lanes zero = lanes_all(0);
    return (struct ref){{(lanes)((lanes_int)((lanes)lo + zero) | low),
                         (lanes)((lanes_int)((lanes)hi + zero) | high)}};
}

static struct ref ref_of_part(const struct part *part)
{
    struct lane_box box = lane_box_load(&part->box);
    lanes zero = lanes_all(0);
    struct ref ref = {{box.lo + zero, box.hi + zero}};
    ref.box.lo[3] = float_from_bits(0x3F800000u | (part->prim & 0xFFFFu));
    ref.box.hi[3] = float_from_bits(0x3F800000u | part->prim >> 16);
    return ref;
}

enum status refs_make(const struct scene *scene, const struct build_options *options,
                      uint32_t threads, struct refs *out, struct reason *reason)
{
    struct part *part = NULL;
    *out = (struct refs){.count = scene->tri_count, .centres = lane_box_empty()};
    if (options->presplit > 0) {
        enum status status = presplit_make(scene, options, threads, &part, &out->count, reason);
        if (status)
            return status;
    }
    struct ref *ref = out->ref = room_make(out->count, sizeof *ref);
    uint32_t count = ref ? out->count : 0;
#pragma omp parallel num_threads(threads) if (threads > 1)
    {
        struct lane_box mine = lane_box_empty();
#pragma omp for schedule(static)
        for (uint32_t i = 0; i < count; i++) {
            ref[i] = part ? ref_of_part(&part[i]) : ref_of(scene, i);
            lanes centre = ref_centre(&ref[i]);
            lane_box_add(&mine, &(struct lane_box){centre, centre});
        }
        /* Minimum and maximum, without -0: the order does not matter. */
#pragma omp critical(refs)
        lane_box_add(&out->centres, &mine);
    }
    room_free(part);
    return ref ? STATUS_OK : STATUS_MEMORY;
}
