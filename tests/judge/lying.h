/* Lies about worlds, made of what is exactly hit. Include after cmocka.h and after
 * the headers of the judge. */
#ifndef TESTS_LYING_H
#define TESTS_LYING_H

#include "ref/judge/judge_inner.h"
#include "tests/judge/honest_world.h"
#include "tests/support/stand.h"

#include <math.h>

#define OWN 5 /* of formulas */

/* One ray of one world before one judge. */
struct lying {
    const struct judged_world *w;
    const struct judge *judge;
    struct ray ray;
    struct ray_mode mode;
    struct oracle_answer truth;
    uint32_t caught[WRONG_COUNT], open[WRONG_COUNT]; /* lies of each kind */
};

static inline const struct instance *instance_of(const struct lying *l, uint32_t prim)
{
    return &l->w->world.instance[world_instance_of(&l->w->world, prim)];
}

static inline struct twin twin_at(const struct lying *l, uint32_t prim)
{
    struct judge here = *l->judge;
    here.mode = l->mode;
    return judge_twin(&here, &l->ray, prim, NULL);
}

/* The exact answer, rounded. */
static inline struct hit exact_hit(const struct lying *l, uint32_t prim,
                                   const struct oracle_pair *pair)
{
    double u[2], v[2];
    oracle_weights(l->w->oracle, &l->ray, prim, u, v);
    return (struct hit){(float)(pair->t_lo / 2 + pair->t_hi / 2), (float)u[0], (float)v[0], prim};
}

static inline uint32_t exact_tag(const struct lying *l, uint32_t prim,
                                 const struct oracle_pair *pair)
{
    bool front = oracle_is_front(l->w->oracle, pair, prim);
    return instance_of(l, prim)->custom | (front ? ABI_TAG_FRONT : 0);
}

static inline struct judgement judged(const struct lying *l, const struct hit *hit, uint32_t tag)
{
    struct judgement out;
    assert_int_equal(judge_world_answer(l->judge, &l->ray, l->mode, &l->truth, hit, tag, &out),
                     STATUS_OK);
    return out;
}

/* The lie must be found to be of that kind; `open`: unless rounding excuses it. */
static inline void lie(struct lying *l, struct hit hit, uint32_t tag, enum wrong kind, bool open)
{
    struct judgement j = judged(l, &hit, tag);
    if (open && j.wrong != kind) {
        l->open[kind]++; /* perhaps WRONG for what lies before it */
        return;
    }
    if (j.wrong != kind) {
        char line[400];
        judge_line(&l->ray, &j, &hit, line, sizeof line);
        fail_msg("%s (%s), not %s: %s", verdict_name(j.verdict), wrong_name(j.wrong),
                 wrong_name(kind), line);
    }
    l->caught[kind]++;
}

static inline int side_at(const struct lying *l, uint32_t prim)
{
    struct twin_ray placed;
    float v[3][3];
    judge_tri(l->judge, prim, v);
    judge_take_along(l->judge, &l->ray, prim, &placed);
    return twin_placed_side(l->judge->model.rounding, &placed, v);
}

/* A hit that no evaluation can help finding, by the judge's twins and the oracle's rules. */
static inline bool is_certain(const struct lying *l, const struct oracle_crossing *c)
{
    struct twin twin = twin_at(l, c->prim);
    double du = twin.u_err * 1.001, dv = twin.v_err * 1.001;
    struct twin_ray placed;
    judge_take_along(l->judge, &l->ray, c->prim, &placed);
    return twin.certain && placed.in_contract && isfinite(du) && isfinite(dv) &&
           !oracle_filter_is_open(l->w->oracle, &l->ray, l->mode, c->prim, du, dv) &&
           side_at(l, c->prim) && c->pair.t_lo > 1e-20;
}

/* What is at fault stands in the list with that tag, or is a miss; its kind tells whether another
 * instance has the triangle there, unless the world rules it out whatever the numbers. */
static inline void check_fault(const struct lying *l, const struct hit *hit, const uint32_t *tag,
                               size_t count, const struct list_judgement *out)
{
    enum wrong wrong = out->judgement.wrong;
    struct judge here = *l->judge;
    bool listed = false, anothers = false;
    here.mode = l->mode;
    for (size_t i = 0; i < count; i++)
        listed =
            listed || (memcmp(&hit[i], &out->at_fault, sizeof *hit) == 0 && tag[i] == out->tag);
    if (out->at_fault.prim == ABI_NO_PRIM) {
        assert_true(out->tag == 0 && (wrong == WRONG_NOT || wrong == WRONG_MISSED));
        return;
    }
    assert_true(listed && wrong != WRONG_NOT && wrong != WRONG_MISSED);
    if ((wrong != WRONG_INSTANCE && wrong != WRONG_PHANTOM && wrong != WRONG_DISTANCE) ||
        judge_ruled_out(&here, &l->ray, &out->at_fault, out->tag))
        return;
    assert_int_equal(judge_is_anothers(&here, &l->ray, &out->at_fault, &anothers), STATUS_OK);
    assert_int_equal(anothers, wrong == WRONG_INSTANCE);
}

static inline struct list_judgement list_judged(const struct lying *l, const struct hit *hit,
                                                const uint32_t *tag, size_t count)
{
    struct list_judgement out;
    assert_int_equal(judge_world_list(l->judge, &l->ray, l->mode, hit, tag, count, &out),
                     STATUS_OK);
    check_fault(l, hit, tag, count, &out);
    return out;
}

static inline struct model model_of(size_t f, bool loose)
{
    return (struct model){.formula = formulas[f].formula,
                          .rounding = loose ? ROUNDING_VULKAN : ROUNDING_IEEE,
                          .bits = !loose,
                          .open = formulas[f].formula == TWIN_MT_RTRS};
}

#endif
