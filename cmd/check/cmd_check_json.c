/* The rows of raydiff check as JSON. */
#include "cmd/check/cmd_check.h"

#include "cmd/common/cmd_finding.h"
#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"
#include "ref/store.h"

#include <jansson.h>
#include <string.h>

/* Bit patterns are exact; t is also given as a number. */
static json_t *hit_json(const struct hit *hit)
{
    if (hit->prim == ABI_NO_PRIM)
        return json_null();
    return json_record("prim=%u t=%g t_bits=%p u_bits=%p v_bits=%p", hit->prim,
                       float_is_finite(hit->t) ? (double)hit->t : 0.0, json_bits(hit->t),
                       json_bits(hit->u), json_bits(hit->v));
}

/* JSON has no infinity; 1e300 replaces it. */
static double finite(double x)
{
    return x <= 1e300 ? x : 1e300;
}

static json_t *judgement_json(const struct judgement *j)
{
    if (j->expected == ABI_NO_PRIM)
        return json_record("wrong=%s expected=%p over=%g displacement=%g", wrong_name(j->wrong),
                           json_null(), finite(j->over), finite(j->displacement));
    json_t *out = json_record("wrong=%s expected=%u t_lo=%g t_hi=%g over=%g displacement=%g",
                              wrong_name(j->wrong), j->expected, j->t_lo, j->t_hi, finite(j->over),
                              finite(j->displacement));
    if (j->behind)
        json_add(out, "lost=%u", j->lost);
    return out;
}

static json_t *place_json(uint32_t prim, const struct place *place)
{
    if (prim == ABI_NO_PRIM)
        return json_null();
    return json_record("instance=%u geometry=%u triangle=%u", place->instance, place->geometry,
                       place->tri);
}

static json_t *finding_world_json(const struct finding *f)
{
    const struct world_finding *w = &f->world;
    uint32_t expected = f->bits ? f->expected.prim : f->judgement.expected;
    json_t *out =
        json_record("mask=%u flags=%u custom=%u front=%i got=%p expected=%p", w->mode.mask,
                    w->mode.flags, w->tag & ABI_TAG_CUSTOM, (w->tag & ABI_TAG_FRONT) != 0,
                    place_json(f->got.prim, &w->got), place_json(expected, &w->expected));
    if (f->bits)
        json_add(out, "expected_custom=%u expected_front=%i", w->expected_tag & ABI_TAG_CUSTOM,
                 (w->expected_tag & ABI_TAG_FRONT) != 0);
    return out;
}

static json_t *finding_json(const struct check_scene *scene, const struct row *row,
                            const struct finding *f)
{
    char command[EXPLAIN_COMMAND_MOST];
    json_t *out = json_record("ray=%zu against=%s ray_bits=%p got=%p", f->ray_index,
                              f->bits ? row->against->name : "truth", json_ray_bits(&f->ray),
                              hit_json(&f->got));
    if (f->bits)
        json_add(out, "expected=%p", hit_json(&f->expected));
    else
        json_add(out, "judgement=%p", judgement_json(&f->judgement));
    if (f->world.is)
        json_add(out, "world=%p", finding_world_json(f));
    const struct finding_of of = check_finding_of(scene);
    if (finding_command(row, f, &of, command))
        json_add(out, "explain=%s", command);
    return out;
}

static json_t *wrong_json(const struct row *row)
{
    json_t *counts = json_object();
    for (enum wrong w = WRONG_MISSED; w < WRONG_COUNT; w++)
        json_add(counts, "%s=%zu", wrong_name(w), row->wrong[w]);
    return counts;
}

static json_t *displacement_json(const struct row *row)
{
    if (row->displacement.count == 0)
        return json_null();
    json_t *edges = json_array();
    for (size_t c = 0; c < MATCH_EDGES; c++)
        json_array_append_new(edges, json_record("hits=%zu lost=%zu at_most=%g", row->edges[c].hits,
                                                 row->edges[c].lost,
                                                 match_edges_limit(c, row->edges[c].hits)));
    return json_record(
        "answers=%zu allowed=%g p50=%g p99=%g max=%g lost_in_closed_fans=%zu lost_beside_edges=%p "
        "beyond=%zu",
        row->displacement.count, row->displacement.allowed, row->displacement.p50,
        row->displacement.p99, finite(row->displacement.most), row->displacement.fan_lost, edges,
        row->edges_beyond);
}

static json_t *lists_json(const struct row *row)
{
    if (row->options.query != QUERY_ALL)
        return json_null();
    return json_record("triangles=%zu double_hits=%zu closed=%i parity_known=%zu parity_off=%zu",
                       row->lists.triangles, row->lists.doubles, row->lists.closed,
                       row->lists.parity, row->lists.parity_off);
}

static json_t *original_json(const struct row *row)
{
    if (row->original.judged == 0)
        return json_null();
    return json_record("judged=%zu beyond=%zu lost=%zu phantom=%zu other=%zu certified=%g "
                       "displacement=%g displacement_decoded=%g",
                       row->original.judged, row->original.beyond, row->original.lost,
                       row->original.phantom, row->original.other, finite(row->original.allowed),
                       finite(row->original.most), finite(row->original.most_decoded));
}

/* Of an engine that has no layout 0 is what it does not tell. */
static json_t *bytes_json(const struct row *row, uint64_t bytes)
{
    return row->layout ? json_integer((json_int_t)bytes) : json_known(bytes);
}

static json_t *compiled_json(const struct row *row)
{
    const struct engine_compiled *c = &row->compiled;
    return json_record("compiler=%s raw=%s decorated=%i translates=%i source=%u operations=%u "
                       "kept=%u open=%u lost=%u words=%u bits_free=%i moved=%zu",
                       c->compiler, c->raw->name, !c->free, c->translates, c->source, c->ops,
                       c->kept, c->foreign, engine_compiled_lost(c), c->words, !row->bits,
                       row->moved);
}

static json_t *row_json(const struct check_scene *scene, const struct row *row)
{
    const struct match_options *o = &row->options;
    json_t *out = json_record(
        "scene=%s layout=%p builder=%s leaf=%u engine=%p box=%p tri=%s query=%s node_bytes=%p "
        "item_bytes=%p memory_bytes=%p rays=%zu hits=%zu compared_with_brute=%zu",
        scene->spec, json_text(row->layout ? row->layout->name : NULL), o->builder->name,
        o->build.leaf, json_text(row->engine ? row->engine->name : NULL),
        json_text(strcmp(row_box_name(row), "-") ? row_box_name(row) : NULL), row_tri_name(row),
        query_name(o->query), bytes_json(row, row->node_bytes), bytes_json(row, row->item_bytes),
        json_known(row->memory_bytes), row->rays, row->hits, row->brute);
    if (!out)
        return NULL;
    json_add(out, "tree=%p",
             json_record("nodes=%u leaves=%u depth=%u largest_leaf=%u", row->stats.node_count,
                         row->stats.leaf_count, row->stats.depth, row->stats.largest_leaf));
    if (o->tree)
        json_add(out, "bvh=%s", o->tree->name);
    if (o->braid)
        json_add(out, "braid=%u", o->braid);
    json_add(out, "store=%p", json_text(row->layout && o->store ? o->store->name : NULL));
    if (row->options.life)
        json_add(out, "step=%p",
                 json_record("number=%u after=%s tree=%s updated=%i wrong_anew=%p", scene->step,
                             scene->after, check_fate_name(row->life.fate), row->life.updated,
                             row->life.again ? json_integer((json_int_t)row->life.wrong_again)
                                             : json_null()));
    if (scene->move > 0)
        json_add(out, "moved=%p",
                 json_record(
                     "extents=%g sah_before=%g sah_after=%g build_ns=%zu pack_ns=%zu refit_ns=%zu",
                     scene->move, row->refit.sah_before, row->refit.sah_after, row->refit.build_ns,
                     row->refit.pack_ns, row->refit.refit_ns));
    json_add(out,
             "scene_bytes=%p counts=%p wrong=%p err_over_bound=%g displacement=%p lists=%p "
             "original=%p bit_differences=%zu judged=%i differences=%zu mrays_per_s=%p "
             "box_tests=%zu triangle_tests=%zu status=%s reason=%s",
             bytes_json(row, row->scene_bytes), json_verdicts(row->count), wrong_json(row),
             finite(row->worst_over), displacement_json(row), lists_json(row), original_json(row),
             row->bit_differences, row->judged, row->differences,
             json_record("median=%g min=%g max=%g clock=%s", row->mrays[0], row->mrays[1],
                         row->mrays[2], row->device_clock ? "device" : "host"),
             row->boxes, row->tris, row_status_name(row->status), row->reason.text);
    if (row_counts_bits(row))
        json_add(out, "other_bits=%zu", row->moved);
    if (row->engine && row->engine->plain && row->against)
        json_add(out, "beside=%p",
                 json_record("engine=%s both_right=%zu alone_right=%zu other_right=%zu "
                             "neither_right=%zu",
                             row->against->name, row->beside.both, row->beside.own,
                             row->beside.plain, row->beside.neither));
    if (row->compiled.words > 0)
        json_add(out, "compiled=%p", compiled_json(row));
    json_t *findings = json_array();
    for (size_t i = 0; i < row->finding_count; i++)
        json_array_append_new(findings, finding_json(scene, row, &row->finding[i]));
    json_add(out, "findings=%p", findings);
    return out;
}

/* Writes why layouts refuse the scene, one per line: those that --layout auto passed over, and
 * others. */
static void refusals(const struct check_scene *scene, char *text, size_t text_bytes)
{
    snprintf(text, text_bytes, "%s", scene->vacuous ? CHECK_VACUOUS : scene->refused);
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        const size_t used = strlen(text);
        if (row->status == ROW_REFUSED && !strstr(text, row->reason.text))
            text_append(text, text_bytes, "%s%s", used && text[used - 1] != '\n' ? "\n" : "",
                        row->reason.text);
    }
}

enum status check_write_json(const char *path, const struct check_scene *scene, size_t scene_count,
                             const struct turnout *turnout, int exit_code, struct reason *reason)
{
    json_t *scenes = json_array(), *rows = json_array();
    for (size_t s = 0; s < scene_count; s++) {
        char refused[4096];
        refusals(&scene[s], refused, sizeof refused);
        json_t *one = json_record("scene=%s triangles=%u vertices=%u rays=%p count=%zu refused=%s",
                                  scene[s].spec, scene[s].tri_count, scene[s].vertex_count,
                                  json_text(scene[s].rays), scene[s].ray_count, refused);
        if (scene[s].modes)
            json_add(one, "instances=%u modes=%s scenes_only=%s", scene[s].instance_count,
                     scene[s].modes, scene[s].scenes_only);
        json_array_append_new(scenes, one);
        for (size_t i = 0; i < scene[s].row_count; i++)
            json_array_append_new(rows, row_json(&scene[s], &scene[s].row[i]));
    }
    json_t *root = json_record("raydiff=%s exit=%d scenes=%p named=%p rows=%p", RAYDIFF_VERSION,
                               exit_code, scenes, json_turnout(turnout), rows);
    return json_write(path, root, 9, reason);
}
