#include "ref/judge/judge_inner.h"
#include "ref/base/invariant.h"

/* A judge of rays of one mode. */
static struct judge of_mode(const struct judge *judge, struct ray_mode mode)
{
    struct judge out = *judge;
    invariant(judge->world);
    out.mode = mode;
    return out;
}

/* True of a kind that another instance's triangle may explain. */
static bool may_be_anothers(enum wrong wrong)
{
    return wrong == WRONG_PHANTOM || wrong == WRONG_TRIANGLE || wrong == WRONG_DISTANCE ||
           wrong == WRONG_BARYCENTRIC;
}

static bool is_ill(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    return judge->model.formula == TWIN_UNKNOWN && prim != ABI_NO_PRIM &&
           !judge_takes(judge, ray, prim);
}

enum status judge_world_answer(const struct judge *judge, const struct ray *ray,
                               struct ray_mode mode, const struct oracle_answer *truth,
                               const struct hit *answer, uint32_t tag, struct judgement *out)
{
    struct judge here = of_mode(judge, mode);
    bool hit = answer->prim != ABI_NO_PRIM, anothers = false;
    if (mode.flags & ABI_RAY_FIRST)
        here.query = QUERY_ANY;
    bool unnamed = here.query == QUERY_ANY && here.model.any_unnamed;
    enum wrong ruled = !hit && tag != 0 ? WRONG_INSTANCE : WRONG_NOT;
    if (hit && !unnamed)
        ruled = answer->prim < here.tri_count ? judge_ruled_out(&here, ray, answer, tag)
                                              : WRONG_PHANTOM;
    if (ruled) {
        *out =
            (struct judgement){.expected = truth->prim, .t_lo = truth->t_lo, .t_hi = truth->t_hi};
        judge_set_wrong(out, ruled);
        return STATUS_OK;
    }
    enum status status = judge_knowing(&here, ray, ray_in_contract(ray), truth, answer, NULL, out);
    if (!status && out->verdict == VERDICT_WRONG && hit && !unnamed && may_be_anothers(out->wrong))
        status = judge_is_anothers(&here, ray, answer, &anothers);
    if (anothers)
        out->wrong = WRONG_INSTANCE;
    if (status)
        *out = (struct judgement){.verdict = VERDICT_OUT_OF_CONTRACT, .expected = truth->prim};
    if (!unnamed || !hit)
        out->ill_conditioned =
            out->verdict == VERDICT_OUT_OF_CONTRACT &&
            ((hit && is_ill(&here, ray, answer->prim)) || is_ill(&here, ray, truth->prim));
    return status;
}

enum status judge_world_list(const struct judge *judge, const struct ray *ray, struct ray_mode mode,
                             const struct hit *hit, const uint32_t *tag, size_t count,
                             struct list_judgement *out)
{
    struct judge here = of_mode(judge, mode);
    return judge_list_tagged(&here, ray, hit, tag, count, out);
}
