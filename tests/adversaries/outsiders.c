/* Lies of somebody who has read the judge's source, but for what it draws by chance. */
#include "tests/adversaries/spoil.h"

#include "ref/judge/judge_inner.h"

#include <math.h>
#include <string.h>

static bool is_hit(const struct hit *hit)
{
    return hit->prim != ABI_NO_PRIM;
}

static const struct hit nothing = {.prim = ABI_NO_PRIM};

/* Would the judge let this answer pass? */
static bool passes(const struct lie *lie, size_t i, const struct hit *hit)
{
    struct judgement out;
    const struct oracle_answer *truth =
        &lie->match->truth[lie->ray - lie->match->ray + (ptrdiff_t)i];
    return !judge_answer(lie->judge, &lie->ray[i], truth, hit, &out) &&
           out.verdict != VERDICT_WRONG;
}

/* What is exactly right. A formula that no engine of C has, Embree's, is imitated by that. */
static struct hit right_answer(const struct lie *lie, size_t i)
{
    const struct oracle_answer *truth =
        &lie->match->truth[lie->ray - lie->match->ray + (ptrdiff_t)i];
    float v[3][3];
    if (truth->prim == ABI_NO_PRIM)
        return nothing;
    scene_tri(lie->match->scene, truth->prim, v);
    struct judge_rounding r = judge_rounding_of(&lie->ray[i], v);
    return (struct hit){(float)(r.t / r.det), (float)(r.edge[1] / r.det),
                        (float)(r.edge[2] / r.det), truth->prim};
}

/* Every hit whose loss the judge would excuse. */
void drops_what_is_excused(const struct lie *lie, size_t i, struct hit *hit)
{
    if (is_hit(hit) && passes(lie, i, &nothing))
        *hit = nothing;
    else if (!passes(lie, i, hit))
        *hit = right_answer(lie, i);
}

/* The last triangle of the scene has no area; any answer of it that would be excused. */
void claims_the_degenerate(const struct lie *lie, size_t i, struct hit *hit)
{
    static const float weight[][2] = {{0.25f, 0.25f}, {0, 0}, {1, 0}, {0, 1}, {0.5f, 0.5f}};
    if (is_hit(hit) && !passes(lie, i, hit))
        *hit = right_answer(lie, i);
    for (int part = 1; is_hit(hit) && part < 8; part += 3)
        for (size_t w = 0; w < ARRAY_COUNT(weight); w++) {
            struct hit claim = {hit->t * (float)part / 8.0f, weight[w][0], weight[w][1],
                                lie->match->scene->tri_count - 1};
            if (!passes(lie, i, &claim))
                continue;
            *hit = claim;
            return;
        }
}

/* The same of the last triangles, which are lines. */
void claims_a_line(const struct lie *lie, size_t i, struct hit *hit)
{
    uint32_t count = lie->match->scene->tri_count;
    struct hit was = *hit;
    if (is_hit(hit) && !passes(lie, i, hit))
        was = *hit = right_answer(lie, i);
    for (uint32_t k = 1; is_hit(&was) && k <= CHEAT_LINES && k <= count; k++)
        for (int part = 1; part < 8; part += 3) {
            struct hit claim = {was.t * (float)part / 8.0f, 0.25f, 0.25f, count - k};
            if (!passes(lie, i, &claim))
                continue;
            *hit = claim;
            return;
        }
}

/* What the judge cannot see: the largest t that it lets pass. */
void stretches_t(const struct lie *lie, size_t i, struct hit *hit)
{
    struct hit far = *hit;
    float step = (float)lie->amount * hit->t;
    for (int bit = 0; is_hit(hit) && bit < 24; bit++, step *= 0.5f) {
        far.t = hit->t + step;
        if (far.t > hit->t && passes(lie, i, &far)) {
            *hit = far;
            return;
        }
    }
}

void lies_alone(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)i;
    if (lie->count == 1)
        *hit = nothing;
}

void lies_in_batches(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)i;
    if (lie->count > 1)
        *hit = nothing;
}

/* Right for so many calls: somebody who only tries it out never sees the others. */
void lies_later(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)i;
    if (lie->calls > (size_t)lie->amount)
        *hit = nothing;
}

void lies_to_odd_rays(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)lie;
    if (i % 2 == 1 && is_hit(hit))
        hit->t *= 1.0f + 0x1p-10f;
}

void lies_once_in_a_while(const struct lie *lie, size_t i, struct hit *hit)
{
    size_t hits = 0;
    for (size_t k = 0; k <= i; k++)
        hits += is_hit(&lie->right[k]);
    if (is_hit(hit) && hits % (size_t)lie->amount == 0)
        *hit = nothing;
}

void forgets_backs(const struct lie *lie, size_t i, struct hit *hit)
{
    float v[3][3];
    double facing = 0;
    if (!is_hit(hit))
        return;
    scene_tri(lie->match->scene, hit->prim, v);
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        double n = ((double)v[1][a] - (double)v[0][a]) * ((double)v[2][b] - (double)v[0][b]) -
                   ((double)v[1][b] - (double)v[0][b]) * ((double)v[2][a] - (double)v[0][a]);
        facing += n * (double)lie->ray[i].dir[k];
    }
    if (facing > 0)
        *hit = nothing;
}

void forgets_axes(const struct lie *lie, size_t i, struct hit *hit)
{
    const float *d = lie->ray[i].dir;
    if (d[0] == 0.0f || d[1] == 0.0f || d[2] == 0.0f)
        *hit = nothing;
}

void forgets_the_end(const struct lie *lie, size_t i, struct hit *hit)
{
    if (is_hit(hit) && hit->t == lie->ray[i].tmax)
        *hit = nothing;
}

void stops_at_the_end(const struct lie *lie, size_t i, struct hit *hit)
{
    if (is_hit(hit))
        hit->t = lie->ray[i].tmax;
}

void takes_anothers_place(const struct lie *lie, size_t i, struct hit *hit)
{
    if (i > 0 && is_hit(hit) && is_hit(&lie->right[i - 1])) {
        hit->u = lie->right[i - 1].u;
        hit->v = lie->right[i - 1].v;
    }
}

void answers_no_number(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)lie, (void)i;
    if (is_hit(hit))
        hit->t = NAN;
}

void answers_next_to_0(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)lie;
    if (is_hit(hit))
        hit->t = i % 2 ? -0.0f : 0x1p-149f;
}

/* A miss has no numbers, so whatever they hold says nothing. */
void fills_misses(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)lie, (void)i;
    if (!is_hit(hit))
        *hit = (struct hit){NAN, -1.0f, INFINITY, ABI_NO_PRIM};
}

void names_the_next_triangle(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)i;
    if (is_hit(hit))
        hit->prim = (hit->prim + 1) % lie->match->scene->tri_count;
}

/* Whatever is missed, with the numbers of the point where the line meets the triangle's plane. */
void sees_what_is_excused(const struct lie *lie, size_t i, struct hit *hit)
{
    for (uint32_t prim = 0; !is_hit(hit) && prim < lie->match->scene->tri_count; prim++) {
        float v[3][3];
        scene_tri(lie->match->scene, prim, v);
        struct judge_rounding r = judge_rounding_of(&lie->ray[i], v);
        float u = (float)(r.edge[1] / r.det), w = (float)(r.edge[2] / r.det);
        u = fminf(fmaxf(u, 0.0f), 1.0f);
        struct hit made = {(float)(r.t / r.det), u, fminf(fmaxf(w, 0.0f), 1.0f - u), prim};
        if (r.det != 0.0 && passes(lie, i, &made))
            *hit = made;
    }
}
