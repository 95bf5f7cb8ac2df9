/* Engines on a match's scene or world; for the match's own files. */
#ifndef MATCH_ENGINE_H
#define MATCH_ENGINE_H

#include "ref/match/match.h"

/* Prepares an opened engine for the match's query, by all steps of its life. Errors: as
 * engine.prepare; STATUS_UNSUPPORTED an engine that traces no worlds, or lists no hits, where they
 * are asked for. */
enum status match_prepare(const struct match *match, const struct engine *engine, void *self,
                          struct reason *reason) MUST_USE;

/* Traces the first `count` rays on an engine that is prepared.
 *   tag   room for `count` if the match is of a world; else NULL
 * Errors: as engine.trace. */
enum status match_trace(const struct match *match, const struct engine *engine, void *self,
                        size_t count, struct hit *hit, uint32_t *tag, struct trace_report *report,
                        struct reason *reason) MUST_USE;

/* What ray i may meet of the world. */
static inline struct ray_mode match_mode(const struct match *match, size_t i)
{
    return match->mode ? match->mode[i] : ray_mode_all();
}

/* What an engine without a world is prepared with; of a life, at its last step. */
struct job match_job(const struct match *match, const struct engine *engine);

/* The same of a world. */
struct world_job match_world_job(const struct match *match, const struct engine *engine);

/* What the judge assumes of an opened engine's arithmetic, also said in the row. */
struct model match_model(const struct match *match, const struct engine *engine, void *self,
                         struct row *row);

/* Fills in row->life, but for `updated`, which the opened engine decides. */
void match_row_life(const struct match *match, const struct engine *engine, struct row *row);

/* Of a row with WRONG answers after steps: opens and prepares the engine anew and judges what it
 * then answers to the same rays: row->life.again. Nothing is changed where that cannot be done, or
 * for lists. Errors: STATUS_MEMORY, in row->reason too. */
enum status match_again(const struct match *match, const struct engine *engine,
                        struct row *row) MUST_USE;

/* As job_keeps_watertight. */
bool match_keeps_watertight(const struct match *match, const struct engine *engine);

/* True if two answers to one ray have the same bits; tags may be NULL. */
bool match_same_bits(const struct hit *a, const struct hit *b, const uint32_t *a_tag,
                     const uint32_t *b_tag, size_t i);

/* Fills in the bytes of the row's tree, storage and, if they are read, meshes. */
void match_row_bytes(const struct match *match, struct row *row);

/* Packs both levels of a world. Errors: as packed_world_make; the match then has no layout. */
enum status match_pack_world(struct match *match, const struct layout *layout,
                             struct reason *reason) MUST_USE;

/* The same in the first of layouts_auto that holds both levels; `refused` as packed_make_auto's. */
enum status match_pack_world_auto(struct match *match, char *refused, size_t refused_bytes,
                                  struct reason *reason) MUST_USE;

/* Builds the trees of a world by the options. Errors: as world_trees_make. */
enum status match_rebuild_world(struct match *match, struct reason *reason) MUST_USE;

#endif
