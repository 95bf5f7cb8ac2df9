/* Scenes, trees and runs for tests of schedulers. */
#ifndef TRAFFIC_FIXTURE_H
#define TRAFFIC_FIXTURE_H

#include "bench/traffic/schedulers.h"
#include "ref/tree/bvh.h"
#include "ref/store.h"
#include "scenes/scenes.h"

/* A scene, its tree in a layout, and paths. */
struct traffic_case {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct job job;
    struct kd_tree kd;
    struct traffic_paths paths;
    struct traffic_walker walker;
};

/* Before a scene: it has each triangle twice, and a leaf for each. */
#define TRAFFIC_TWICE "twice "
/* Before a scene, with a number and a blank: it is larger by that power of two. */
#define TRAFFIC_SCALED "scaled "

/* Opens a scene and packs it. Returns false if the layout cannot hold it. Fails the test if
 * anything else is wrong. */
bool traffic_case_open(const char *spec, const char *layout, const char *store,
                       struct traffic_case *out);

/* Makes paths and a walker with treelets of at most `treelet` bytes. */
void traffic_case_start(struct traffic_case *c, size_t paths, uint32_t depth, uint64_t treelet);

/* Ends what traffic_case_start made. */
void traffic_case_stop(struct traffic_case *c);
void traffic_case_close(struct traffic_case *c);

/* A small machine. */
struct traffic_machine traffic_small(void);

/* Plays a scheduler. */
struct traffic_result traffic_case_play(struct traffic_case *c, const char *scheduler,
                                        const struct traffic_machine *machine);

/* Bytes read and written at a level for a cause, or for nodes and triangles together. */
static inline uint64_t traffic_part(const struct traffic_result *r, enum traffic_level level,
                                    enum traffic_cause cause)
{
    return r->count[level].in[cause] + r->count[level].out[cause];
}

static inline uint64_t traffic_scene_part(const struct traffic_result *r, enum traffic_level level)
{
    return traffic_part(r, level, TRAFFIC_NODES) + traffic_part(r, level, TRAFFIC_TRIANGLES);
}

#endif
