#include "scenes/render/diff_why.h"

#include "scenes/render/diff_frames.h"

#include <string.h>

const char *why_name(enum why why)
{
    static const char *const names[WHY_COUNT] = {"same",      "rounding", "allowed", "drift",
                                                 "published", "renderer", "wrong",   "unexplained"};
    return why < WHY_COUNT ? names[why] : "unknown";
}

void why_judges_free(struct why_judges *judges)
{
    for (unsigned side = 0; side < 2; side++) {
        judge_free(judges->closest[side]);
        judge_free(judges->shadow[side]);
    }
    *judges = (struct why_judges){0};
}

enum status why_judges_make(const struct oracle *oracle, const struct model model[2],
                            enum query shadow_query, struct why_judges *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    *out = (struct why_judges){.oracle = oracle};
    for (unsigned side = 0; side < 2 && !status; side++) {
        status = judge_make(oracle, &model[side], QUERY_CLOSEST, &out->closest[side], reason);
        if (!status)
            status = judge_make(oracle, &model[side], shadow_query, &out->shadow[side], reason);
    }
    if (status)
        why_judges_free(out);
    return status;
}

enum status why_judge(const struct why_judges *judges, unsigned side, bool shadow,
                      const struct ray *ray, const struct hit *hit, struct why_answer *out,
                      struct reason *reason)
{
    *out = (struct why_answer){.judged = true, .ray = *ray, .hit = *hit};
    enum status status = oracle_closest(judges->oracle, ORACLE_TREE, ORACLE_CLOSED, ray, 1, 1,
                                        &out->truth, NULL, reason);
    if (!status) {
        const struct judge *judge = shadow ? judges->shadow[side] : judges->closest[side];
        status = judge_answer(judge, ray, &out->truth, hit, &out->judgement);
        if (status)
            fail(reason, status, "no memory to judge a ray");
    }
    return status;
}

/* State of following two paths. */
struct following {
    const struct why_judges *judges;
    bool apart; /* a bit of a ray or hit differed before */
    struct path_why *out;
    struct reason *reason;
};

/* Sets why and where the paths part. */
static void part(struct following *f, enum why why, uint32_t segment, uint32_t light)
{
    f->out->why = why;
    f->out->segment = segment;
    f->out->light = light;
}

static bool same_ray(const struct ray *a, const struct ray *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

static void unjudged(struct path_why *out)
{
    out->answer[0].judged = out->answer[1].judged = false;
}

/* Judges both answers if rays or hits differ in any bit. Returns true if one is wrong. */
static bool judge_both(struct following *f, uint32_t segment, uint32_t light,
                       const struct ray *const ray[2], const struct hit *const hit[2],
                       enum status *status)
{
    struct path_why *out = f->out;
    unjudged(out);
    if (same_ray(ray[0], ray[1]) && memcmp(hit[0], hit[1], sizeof *hit[0]) == 0)
        return false;
    for (unsigned side = 0; side < 2 && !*status; side++) {
        struct why_answer *answer = &out->answer[side];
        *status = why_judge(f->judges, side, light != WHY_NO_LIGHT, ray[side], hit[side], answer,
                            f->reason);
        if (answer->judgement.over > out->over)
            out->over = answer->judgement.over;
    }
    for (unsigned side = 0; side < 2 && !*status; side++) {
        bool published = f->judges->published[side];
        if (out->answer[side].judgement.verdict != VERDICT_WRONG ||
            (published && out->why == WHY_WRONG))
            continue;
        part(f, published ? WHY_PUBLISHED : WHY_WRONG, segment, light);
        out->side = side;
    }
    return out->why == WHY_WRONG || out->why == WHY_PUBLISHED;
}

/* The paths part and neither answer is wrong: sets whether a verdict, earlier drift or nothing
 * explains it. */
static void part_allowed(struct following *f, uint32_t segment, uint32_t light, bool rays_differ)
{
    for (unsigned side = 0; side < 2; side++) {
        const struct why_answer *answer = &f->out->answer[side];
        if (!answer->judged || answer->judgement.verdict == VERDICT_RIGHT)
            continue;
        f->out->verdict = answer->judgement.verdict;
        f->out->side = side;
        part(f, WHY_ALLOWED, segment, light);
        return;
    }
    part(f, rays_differ ? WHY_DRIFT : WHY_UNEXPLAINED, segment, light);
}

/* Returns true if the paths part at this light. */
static bool follow_light(struct following *f, const struct walk_light *a,
                         const struct walk_light *b, uint32_t segment, uint32_t light,
                         enum status *status)
{
    const struct ray *const ray[2] = {&a->ray, &b->ray};
    const struct hit *const hit[2] = {&a->hit, &b->hit};
    if (a->asked != b->asked) {
        unjudged(f->out);
        part(f, f->apart ? WHY_DRIFT : WHY_UNEXPLAINED, segment, light);
        return true;
    }
    if (!a->asked)
        return false;
    if (judge_both(f, segment, light, ray, hit, status) || *status)
        return true;
    bool rays_differ = !same_ray(&a->ray, &b->ray) || float_bits(a->far) != float_bits(b->far);
    f->apart = f->apart || rays_differ;
    if (a->shadowed == b->shadowed)
        return false;
    /* PROFILE_RTRS traces the closest hit and compares its t with the light's distance. Two right
     * answers to the same ray may have t on either side of it. */
    if (!rays_differ && a->hit.prim == b->hit.prim && a->hit.prim != ABI_NO_PRIM &&
        f->out->answer[0].judged && f->out->answer[1].judged && /* so the hits differ */
        f->out->answer[0].judgement.verdict == VERDICT_RIGHT &&
        f->out->answer[1].judgement.verdict == VERDICT_RIGHT) {
        f->out->verdict = VERDICT_BORDER;
        part(f, WHY_ALLOWED, segment, light);
    } else {
        part_allowed(f, segment, light, rays_differ);
    }
    return true;
}

/* Returns true if the paths part at this segment's own ray. */
static bool follow_hit(struct following *f, const struct walk_step *a, const struct walk_step *b,
                       uint32_t segment, enum status *status)
{
    const struct ray *const ray[2] = {&a->ray, &b->ray};
    const struct hit *const hit[2] = {&a->hit, &b->hit};
    if (judge_both(f, segment, WHY_NO_LIGHT, ray, hit, status) || *status)
        return true;
    bool rays_differ = !same_ray(&a->ray, &b->ray);
    f->apart = f->apart || rays_differ || memcmp(&a->hit, &b->hit, sizeof a->hit) != 0;
    if (a->hit.prim == b->hit.prim)
        return false;
    part_allowed(f, segment, WHY_NO_LIGHT, rays_differ);
    return true;
}

enum status why_paths(const struct why_judges *judges, const struct diff_walk *a,
                      const struct diff_walk *b, size_t index, struct path_why *out,
                      struct reason *reason)
{
    struct following f = {.judges = judges, .out = out, .reason = reason};
    enum status status = STATUS_OK;
    uint32_t length[2] = {a->length[index], b->length[index]};
    *out = (struct path_why){.light = WHY_NO_LIGHT};
    for (uint32_t i = 0; i < length[0] || i < length[1]; i++) {
        if (i >= length[0] || i >= length[1]) { /* only one path continues */
            unjudged(out);
            part(&f, f.apart ? WHY_DRIFT : WHY_UNEXPLAINED, i, WHY_NO_LIGHT);
            return STATUS_OK;
        }
        const struct walk_step *of_a = walk_step_of(a, index, i);
        if (follow_hit(&f, of_a, walk_step_of(b, index, i), i, &status))
            return status;
        for (uint32_t light = 0; light < a->lights && of_a->hit.prim != ABI_NO_PRIM; light++)
            if (follow_light(&f, walk_light_of(a, index, i, light),
                             walk_light_of(b, index, i, light), i, light, &status))
                return status;
    }
    unjudged(out);
    part(&f, f.apart ? WHY_ROUNDING : WHY_SAME, length[0], WHY_NO_LIGHT);
    return STATUS_OK;
}

bool why_walk_is_frame(const struct diff_walk *walk, size_t index, const struct segment *segment,
                       uint32_t pixel, bool by_waves)
{
    struct segment path[FRAME_BOUNCES_MOST];
    uint32_t at;
    walk_segments(walk, index, path);
    if (path_first(path, segment, walk->bounces, &at) != PATH_SAME)
        return false;
    if (pixel == walk->frame.pixel[index])
        return true;
    return !by_waves &&
           pixel_within(&walk->frame.color[3 * index], walk->frame.bound[index], pixel);
}
