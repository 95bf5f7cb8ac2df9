/* The bytes that schedulers of the literature move for real rays. */
#ifndef CMD_BENCH_TRAFFIC_H
#define CMD_BENCH_TRAFFIC_H

#include "cmd/bench/cmd_bench.h"
#include "cmd/traffic/cmd_traffic.h"

/* Checks options, memory and scenes before anything runs. `paths`: of the benchmark's own. Errors:
 * STATUS_INPUT an option that no named scheduler uses, sizes of a machine that cannot be, a treelet
 * below a node, more paths than memory holds; of several scenes one that cannot be opened (as
 * scene_open) or has no triangles. */
enum status traffic_check(const struct bench *bench, size_t paths, struct reason *reason) MUST_USE;

#endif
