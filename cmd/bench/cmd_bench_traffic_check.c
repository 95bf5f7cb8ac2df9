/* What is refused before any scheduler runs. */
#include "cmd/bench/cmd_bench_traffic.h"

#include "ref/base/memory.h"
#include "scenes/scenes.h"

static enum status check_memory(const struct bench *bench, size_t paths, struct reason *reason)
{
    const struct traffic_options *o = &bench->traffic;
    size_t count = bench_rays_count(bench, paths);
    uint32_t most = 1;
    for (size_t d = 0; d < o->depth_count; d++)
        most = o->depth[d] > most ? o->depth[d] : most;
    uint64_t need = traffic_paths_bytes(count, most) +
                    traffic_run_bytes(&o->machine, ABI_STACK_MAX, count) +
                    (uint64_t)count * most * (TRAFFIC_HIT_BYTES + 1);
    if (memory_fits(need))
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%zu paths of %u rays need up to %llu MiB, and %llu are left",
                count, most, (unsigned long long)(need >> 20),
                (unsigned long long)(memory_left() >> 20));
}

/* Of several scenes each is looked at, so that none is played if one cannot be. */
static enum status check_scenes(const struct bench *bench, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < bench->scene_count && bench->scene_count > 1 && !status; i++) {
        struct scene scene;
        struct reason why = {""};
        status = scene_open(bench->scene[i], bench->seed, &scene, &why);
        if (status)
            fail(reason, status, "%.100s: %.300s", bench->scene[i], why.text);
        else if (scene.tri_count == 0)
            status = fail(reason, STATUS_INPUT, "%.100s: no triangles", bench->scene[i]);
        scene_free(&scene);
    }
    return status;
}

enum status traffic_check(const struct bench *bench, size_t paths, struct reason *reason)
{
    const struct list *named = &bench->layout;
    enum status status = traffic_options_used(&bench->traffic, reason);
    if (!status)
        status = traffic_machine_check(&bench->traffic.machine, reason);
    for (size_t i = 0; i <= named->count && !status; i++) {
        const struct layout *layout = i < named->count ? layouts_all[named->index[i]]
                                      : named->count   ? NULL
                                                       : layouts[0];
        if (layout && bench->traffic.machine.treelet < layout->node_bytes)
            status = fail(reason, STATUS_INPUT,
                          "--treelet: %llu bytes are smaller than a node of layout %s, %u bytes",
                          (unsigned long long)bench->traffic.machine.treelet, layout->name,
                          layout->node_bytes);
    }
    if (!status)
        status = check_memory(bench, paths, reason);
    return status ? status : check_scenes(bench, reason);
}
