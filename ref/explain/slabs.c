#include "ref/explain/slabs.h"
#include "ref/primitives/test_run.h"

#include <math.h>

struct slab_rule slab_rule_of(uint32_t id)
{
    struct slab_rule rule = {.id = id, .plain = true, .far = 1.0f, .near = 1.0f};
    /* A box flat in x at 100, where neither a widening of 2e-6 nor a factor shows. */
    const struct ray ray = {{100.0f, 0, 0}, 0, {1, 0, 0}, 1};
    const struct box flat = {{100.0f, -1, -1}, {100.0f, 1, 1}};
    struct slab_ray r = slab_ray_make(&ray);
    float entry;
    rule.closed = box_test_run(id, &r, &flat, ray.tmax, &entry);
    rule.by_order = id != ABI_BOX_RTRS;
    if (id == ABI_BOX_ROBUST)
        rule.far = SLAB_FAR;
    if (id == ABI_BOX_WATERTIGHT) {
        rule.near = SLAB_NEAR;
        rule.behind = SLAB_BEHIND;
    }
    return rule;
}

void slab_rule_place(const struct slab_rule *rule, struct slab_ray *r, const struct box *bounds)
{
    int k = r->main;
    float near = r->d[k] < 0.0f ? bounds->hi[k] : bounds->lo[k];
    float t = (near - r->o[k]) * r->inv[k];
    r->behind = t < 0.0f ? -t * rule->behind : 0.0f;
}

/* The distance of the plane at b along the ray. */
static float plane(enum slab_form form, float b, float o, float inv)
{
    if (form == SLAB_FORM_FUSED)
        return fmaf(b, inv, -(o * inv));
    if (form == SLAB_FORM_SPLIT) {
        float near = b * inv, from = o * inv;
        return near - from;
    }
    return (b - o) * inv;
}

/* True if the origin lies between the planes of axis k. */
static bool between(const struct slab_ray *r, const struct box *box, int k)
{
    return box->lo[k] <= r->o[k] && r->o[k] <= box->hi[k];
}

/* Both planes of axis k, which is not parallel; *leave with the far factor. */
static void planes(const struct slab_rule *rule, const struct slab_ray *r, const struct box *box,
                   int k, float *enter, float *leave)
{
    bool down = r->d[k] < 0.0f;
    *enter = plane(rule->form, down ? box->hi[k] : box->lo[k], r->o[k], r->inv[k]);
    *leave = plane(rule->form, down ? box->lo[k] : box->hi[k], r->o[k], r->inv[k]) * rule->far;
}

static bool compare(const struct slab_rule *rule, float near, float far)
{
    return rule->closed ? near <= far : near < far;
}

static bool slabs(const struct slab_rule *rule, const struct slab_ray *r, const struct box *box,
                  float tbest, float *entry)
{
    float tn = r->tmin, tf = tbest;
    bool ok = true;
    for (int k = 0; k < 3; k++) {
        if (r->parallel[k]) {
            ok = ok && between(r, box, k);
            continue;
        }
        float enter, leave;
        planes(rule, r, box, k, &enter, &leave);
        tn = enter > tn ? enter : tn;
        tf = leave < tf ? leave : tf;
    }
    *entry = tn * rule->near - r->behind;
    return ok && compare(rule, *entry, tf);
}

/* The two planes of axis k as the published test computes them, the lesser first. */
static void rtrs_planes(const struct slab_rule *rule, const struct slab_ray *r,
                        const struct box *box, int k, float *lesser, float *greater)
{
    float t0 = (box->lo[k] - SLAB_RTRS_EPS - r->o[k]) / r->d[k];
    float t1 = (box->hi[k] + SLAB_RTRS_EPS - r->o[k]) / r->d[k];
    if (rule->by_order && r->d[k] == 0.0f) {
        t0 = between(r, box, k) ? -INFINITY : INFINITY;
        t1 = INFINITY;
    }
    *lesser = t0 < t1 ? t0 : t1;
    *greater = t1 < t0 ? t0 : t1;
}

static bool rtrs(const struct slab_rule *rule, const struct slab_ray *r, const struct box *box,
                 float *entry)
{
    float tn, tf, lesser, greater;
    rtrs_planes(rule, r, box, 0, &tn, &tf);
    tf *= rule->far;
    for (int k = 1; k < 3; k++) {
        rtrs_planes(rule, r, box, k, &lesser, &greater);
        float low = lesser < -SLAB_RTRS_INF ? lesser : -SLAB_RTRS_INF;
        float high = greater > SLAB_RTRS_INF ? greater : SLAB_RTRS_INF;
        tn = low > tn ? low : tn;
        tf = high < tf ? high : tf;
    }
    *entry = tn;
    return compare(rule, tn, tf);
}

bool slab_by_rule(const struct slab_rule *rule, const struct slab_ray *r, const struct box *box,
                  float tbest, float *entry)
{
    if (rule->plain)
        return box_test_run(rule->id, r, box, tbest, entry);
    if (rule->id == ABI_BOX_RTRS)
        return rtrs(rule, r, box, entry);
    return slabs(rule, r, box, tbest, entry);
}

/* More than the rounding of a difference and a quotient of doubles. */
#define PAD 0x1p-48

static void exact_axis(const struct slab_ray *r, const struct box *box, int k, double *enter,
                       double *leave)
{
    double o = (double)r->o[k], d = (double)r->d[k];
    double lo = (double)box->lo[k], hi = (double)box->hi[k];
    if (d == 0.0) {
        *enter = between(r, box, k) ? -INFINITY : INFINITY;
        *leave = -*enter;
        return;
    }
    *enter = ((d < 0 ? hi : lo) - o) / d;
    *leave = ((d < 0 ? lo : hi) - o) / d;
}

bool slab_conservative(const struct slab_ray *r, const struct box *box, float tbest, float *entry)
{
    double tn = (double)r->tmin, tf = (double)tbest;
    *entry = r->tmin;
    for (int k = 0; k < 3; k++) {
        double enter, leave;
        exact_axis(r, box, k, &enter, &leave);
        if (r->d[k] == 0.0f && enter > leave)
            return false;
        enter -= fabs(enter) * PAD; /* -infinity stays */
        leave += fabs(leave) * PAD;
        tn = enter > tn ? enter : tn;
        tf = leave < tf ? leave : tf;
    }
    if (tn > (double)r->tmin)
        *entry = nextafterf((float)tn, -INFINITY);
    return tn <= tf;
}

void slab_axis_of(const struct slab_rule *rule, const struct slab_ray *r, const struct box *box,
                  int axis, struct slab_axis *out)
{
    exact_axis(r, box, axis, &out->exact_enter, &out->exact_leave);
    if (rule->id == ABI_BOX_RTRS) {
        rtrs_planes(rule, r, box, axis, &out->enter, &out->leave);
        out->leave *= axis == 0 ? rule->far : 1.0f;
    } else if (r->parallel[axis]) {
        out->enter = between(r, box, axis) ? -INFINITY : INFINITY;
        out->leave = -out->enter;
    } else {
        planes(rule, r, box, axis, &out->enter, &out->leave);
    }
}
