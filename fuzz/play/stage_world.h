/* The world of a trial being played: its trees, its packed forms, and calls of engines that do the
 * same for scenes; for the player's files. */
#ifndef FUZZ_STAGE_WORLD_H
#define FUZZ_STAGE_WORLD_H

#include "fuzz/play/stage.h"

/* Builds and packs the world of stage->trial. Errors: STATUS_MEMORY; STATUS_INTERNAL. */
enum status stage_world_set(struct play_stage *stage, const struct fuzz_player *player,
                            struct reason *reason) MUST_USE;

/* Finds the truth about its rays. Errors: those of the oracle. */
enum status stage_world_truth(struct play_stage *stage, struct reason *reason) MUST_USE;

/* Frees what stage_world_set made. */
void stage_world_clear(struct play_stage *stage);

/* True if the layout's tree is split: see job_keeps_watertight. */
bool stage_is_split(const struct play_stage *stage, size_t layout);

/* As engine.prepare of the seat's engine with the stage's scene or world; of a trial with steps as
 * trial_life_prepare. Errors: as that;
 * STATUS_REFUSED an engine that traces no worlds. */
enum status stage_prepare(const struct play_stage *stage, const struct seat *seat,
                          struct reason *reason) MUST_USE;

/* As engine.trace of an engine that is prepared with the stage: the trial's rays from number
 * `first` on, answers to their places. */
enum status stage_trace(const struct play_stage *stage, const struct seat *seat, uint32_t first,
                        uint32_t count, struct answers *answers, struct trace_report *report,
                        struct reason *reason) MUST_USE;

/* States that the world and its trees reached, and the truth about its rays. */
void stage_world_cover(const struct play_stage *stage, const struct fuzz_player *player,
                       uint64_t map[COVERAGE_WORDS]);

/* Has the seat's engine trace the stage's first ray, alone, and judges the answer. *possible: it is
 * prepared; else *out is zero. Of out->why only the opinion is set. Errors: STATUS_MEMORY. */
enum status stage_world_ask(const struct play_stage *stage, const struct seat *seat,
                            struct judged_ray *out, bool *possible, struct reason *reason) MUST_USE;

/* The cause of a finding: the engine traces the ray again, alone; of a trial with steps also opened
 * anew with these options. Errors: STATUS_MEMORY. */
enum status stage_world_explain(const struct play_stage *stage, const struct seat *seat,
                                const struct engine_options *options, struct fuzz_finding *finding,
                                struct reason *reason) MUST_USE;

#endif
