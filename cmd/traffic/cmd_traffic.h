/* Options of benchmark traffic, and its figures. For commands only. */
#ifndef CMD_TRAFFIC_H
#define CMD_TRAFFIC_H

#include "bench/traffic/schedulers.h"
#include "cmd/common/cmd_rows.h"

#include <jansson.h>

#define TRAFFIC_DEPTHS_MOST     8
#define TRAFFIC_SCHEDULERS_MOST 16

struct traffic_options {
    struct traffic_machine machine;
    const struct scheduler *scheduler[TRAFFIC_SCHEDULERS_MOST];
    size_t scheduler_count; /* 0: all */
    uint32_t depth[TRAFFIC_DEPTHS_MOST];
    size_t depth_count; /* 0: 1 alone */
};

extern const struct option_row traffic_rows[];

struct traffic_options traffic_options_default(void);

/* Returns STATUS_OK, or STATUS_INPUT with the first given option that no named scheduler uses. */
enum status traffic_options_used(const struct traffic_options *options,
                                 struct reason *reason) MUST_USE;

/* Writes a figure for each scene, with the first depths as panels: bytes of the tree per triangle
 * against bytes of DRAM per ray. Errors: those of plot_write_file; STATUS_MEMORY. */
enum status traffic_plot(const char *path, const json_t *rows, struct reason *reason) MUST_USE;

#endif
