#include "cmd/explain/cmd_explain_world.h"

#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"
#include "scenes/rays/ray_modes.h"

static json_t *kinds_json(const struct world_why *why)
{
    json_t *out = json_object();
    for (int w = WRONG_NOT + 1; w < WRONG_COUNT; w++)
        json_object_set_new(out, wrong_name((enum wrong)w), json_integer((json_int_t)why->kind[w]));
    return out;
}

static json_t *attempts_json(const struct world_why *why)
{
    json_t *out = json_array();
    for (enum world_defect d = WORLD_DEFECT_NONE + 1; d < WORLD_DEFECT_COUNT; d++)
        json_array_append_new(out,
                              json_record("cause=%s defect=%s told_wrong=%u told_other=%u",
                                          world_cause_name(world_defect_about(d)->cause),
                                          world_defect_about(d)->text, why->attempt[d].told_wrong,
                                          why->attempt[d].told_other));
    return out;
}

static json_t *first_json(const struct explain_world *e)
{
    const size_t i = e->why.first;
    if (i == e->count)
        return json_null();
    const struct judgement *j = &e->judgement[i];
    return json_record("index=%zu ray=%p mask=%u flags=%u wrong=%s answer=%p tag=%u expected=%p", i,
                       json_ray_bits(&e->ray[i]), e->mode[i].mask, e->mode[i].flags,
                       wrong_name(j->wrong), json_hit(&e->hit[i]), e->tag[i],
                       json_prim(j->expected));
}

enum status explain_world_json(const struct explain_world *e, int exit_code, struct reason *reason)
{
    const struct explain_of *of = &e->options->of;
    const struct world_why *why = &e->why;
    const bool named = why->defect != WORLD_DEFECT_NONE;
    json_t *root = json_record(
        "raydiff=%s exit=%d world=%s instances=%u triangles=%u engine=%s layout=%p query=%s "
        "rays=%zu set=%s modes=%s wrong=%zu kinds=%p first=%p wrong_compared=%u other_compared=%u "
        "attempts=%p at_the_rim=%u tree_fault=%p cause=%s defect=%p",
        RAYDIFF_VERSION, exit_code, of->spec, e->world->instance_count, world_tri_count(e->world),
        of->engine->name, e->layout ? json_string(e->layout->name) : json_null(),
        query_name(of->query), e->count, explain_world_set(e), explain_world_modes(e), why->wrong,
        kinds_json(why), first_json(e), why->wrong_compared, why->other_compared,
        attempts_json(why), why->at_the_rim,
        e->tree_fault.text[0] ? json_string(e->tree_fault.text) : json_null(),
        world_cause_name(why->cause),
        named ? json_string(world_defect_about(why->defect)->text) : json_null());
    return json_write(e->options->json, root, 9, reason);
}
