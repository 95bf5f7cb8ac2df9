#include "scenes/render/shade.h"

#include <math.h>

static struct vec3 negate(struct vec3 v)
{
    return (struct vec3){-v.x, -v.y, -v.z};
}

static bool is_zero(struct vec3 v)
{
    return v.x == 0 && v.y == 0 && v.z == 0;
}

struct vec3 shade_unit(struct vec3 v)
{
    float square = vec3_dot(v, v);
    if (!(square > 0 && square < INFINITY))
        return (struct vec3){0, 0, 0};
    float length = sqrtf(square);
    return (struct vec3){v.x / length, v.y / length, v.z / length};
}

void shade_begin(const struct frame_job *job, const struct view *view, uint32_t x, uint32_t y,
                 struct shade_path *out)
{
    float nx = ((float)x + view->centre) / (float)job->width - 0.5f;
    float ny = ((float)(job->height - 1 - y) + view->centre) / (float)job->height - 0.5f;
    struct vec3 right = vec3_scale(vec3_of(view->right), nx),
                up = vec3_scale(vec3_of(view->up), ny);
    *out = (struct shade_path){
        .org = vec3_of(view->pos),
        .dir = shade_unit(vec3_add(vec3_add(right, up), vec3_of(view->forward))),
        .weight = 1,
    };
}

struct ray shade_ray(const struct frame_job *job, const struct shade_path *path)
{
    return (struct ray){{path->org.x, path->org.y, path->org.z},
                        job->tmin,
                        {path->dir.x, path->dir.y, path->dir.z},
                        job->tmax};
}

/* The unit normal interpolated between the corners. */
static struct vec3 blend(const struct shade_tri *tri, float wa, float wb, float wc)
{
    struct vec3 ab = vec3_add(vec3_scale(vec3_of(tri->na), wa), vec3_scale(vec3_of(tri->nb), wb));
    return shade_unit(vec3_add(ab, vec3_scale(vec3_of(tri->nc), wc)));
}

static void place_repaired(const struct shade_tri *tri, const struct hit *hit, struct vec3 a,
                           struct vec3 e1, struct vec3 e2, struct shade_path *path)
{
    path->p = vec3_add(a, vec3_add(vec3_scale(e1, hit->u), vec3_scale(e2, hit->v)));
    path->n = blend(tri, (1.0f - hit->u) - hit->v, hit->u, hit->v);
    path->g = vec3_of(tri->plane);
    if (vec3_dot(path->g, path->dir) > 0)
        path->g = negate(path->g);
    if (is_zero(path->n))
        path->n = path->g;
    if (vec3_dot(path->n, path->g) < 0)
        path->n = negate(path->n);
}

static void place_rtrs(const struct shade_tri *tri, const struct hit *hit, struct vec3 a,
                       struct vec3 e1, struct vec3 e2, struct shade_path *path)
{
    path->p = vec3_add(path->org, vec3_scale(path->dir, hit->t));
    struct vec3 q = vec3_sub(path->p, a);
    float d00 = vec3_dot(e1, e1), d01 = vec3_dot(e1, e2), d11 = vec3_dot(e2, e2);
    float d20 = vec3_dot(q, e1), d21 = vec3_dot(q, e2);
    float den = d00 * d11 - d01 * d01;
    float v = (d11 * d20 - d01 * d21) / den;
    float w = (d00 * d21 - d01 * d20) / den;
    path->n = blend(tri, (1.0f - v) - w, v, w);
}

bool shade_hit(const struct frame_job *job, const struct hit *hit, struct shade_path *path)
{
    path->segment = (struct segment){.prim = ABI_NO_PRIM};
    path->d = path->s = 0;
    path->s_error = 0;
    if (hit->prim == ABI_NO_PRIM)
        return false;
    path->segment.t = hit->t;
    path->segment.prim = hit->prim;
    float v[3][3];
    scene_tri(job->job.scene, hit->prim, v);
    struct vec3 a = vec3_of(v[0]), e1 = vec3_sub(vec3_of(v[1]), a), e2 = vec3_sub(vec3_of(v[2]), a);
    const struct shade_tri *tri = &job->shade[hit->prim];
    if (job->look.profile == PROFILE_RTRS)
        place_rtrs(tri, hit, a, e1, e2, path);
    else
        place_repaired(tri, hit, a, e1, e2, path);
    return true;
}

bool shade_ask(const struct frame_job *job, const struct view *view, uint32_t light,
               struct shade_path *path, struct ray *out)
{
    bool rtrs = job->look.profile == PROFILE_RTRS;
    bool eye = light == 0 && job->look.camera_light > 0;
    struct vec3 lamp = vec3_of(eye ? view->pos : job->light[light].pos);
    struct vec3 way = vec3_sub(lamp, path->p);
    struct vec3 to = shade_unit(way);
    path->far = sqrtf(vec3_dot(way, way));
    path->nl = vec3_dot(path->n, to);
    struct vec3 mirrored = vec3_sub(vec3_scale(path->n, 2.0f * path->nl), to);
    path->rv = -vec3_dot(mirrored, path->dir);
    if (is_zero(to) || (!rtrs && !(path->nl > 0 && vec3_dot(path->g, to) > 0)))
        return false;
    struct vec3 lift = vec3_scale(rtrs ? path->n : path->g, job->offset);
    bool behind = rtrs && path->nl < 0;
    struct vec3 org = behind ? vec3_sub(path->p, lift) : vec3_add(path->p, lift);
    *out = (struct ray){
        {org.x, org.y, org.z}, job->tmin, {to.x, to.y, to.z}, rtrs ? job->tmax : path->far};
    path->segment.asked |= 1u << light;
    return true;
}

/* The difference that rounding adds to a sum or product whose operands differ between two
 * renderers. Each result is rounded by half a unit in the last place: together 2^-23 of the result,
 * or 2^-149 if it is subnormal. */
static double apart(double result)
{
    return 0x1p-23 * fabs(result) + 0x1p-149;
}

/* Vulkan's precision, appendix "Precision and Operation of SPIR-V Instructions": pow(x, y) is
 * inherited from exp2(y log2(x)). The error of log2 is 3 ULP, for x in [0.5, 2] 2^-21; that of
 * exp2(z) is 3 + 2 |z| ULP; that of a product without a required rounding mode is 1 ULP. One ULP is
 * at most 2^-23 of the number, or 2^-149.
 *   l = log2 x, |l^ - l| <= dl;  z = y l, |z^ - z| <= dz = |y| dl + 2^-23 |y| (|l| + dl)
 *   2^z^ = 2^z 2^(z^ - z), so pow is within a factor 2^dz (1 + 2^-23 (3 + 2 (|z| + dz))) of x^y
 * above; below by less. The error of powf is at most 1 ULP (the GNU C library's manual), which is
 * added, as is 2^-126, below which a shader may flush to 0. A factor 1 + 2^-20 covers the rounding
 * of the doubles here and the use of powf for x^y. */
double shade_pow_error(float x, float y)
{
    double l = log2((double)x), size = fabs((double)y);
    double dl = x >= 0.5f && x <= 2.0f ? 0x1p-21 : 3 * 0x1p-23 * fabs(l);
    double dz = size * dl + 0x1p-23 * size * (fabs(l) + dl) + 0x1p-149;
    double z = size * fabs(l) + dz;
    double p = pow((double)x, (double)y);
    double relative = exp2(dz) * (1 + 0x1p-23 * (3 + 2 * z)) - 1;
    double error = (1 + 0x1p-20) * (p * (relative + 0x1p-23)) + 0x1p-126;
    return p + error < 0x1p127 ? error : INFINITY; /* one renderer may overflow, the other not */
}

/* Adds strength pow(rv, spec) to s, and the possible difference from another renderer's to
 * s_error. */
static void add_specular(float strength, float spec, struct shade_path *path)
{
    bool raised = path->rv > 0;
    float power = raised ? powf(path->rv, spec) : spec == 0 ? 1.0f : 0.0f;
    float term = strength * power;
    float sum = path->s + term;
    if (raised && path->bounded) {
        double error = (double)strength * shade_pow_error(path->rv, spec);
        error += apart((double)term + error);
        path->s_error += error;
        path->s_error += apart((double)sum + path->s_error);
    }
    path->s = sum;
}

void shade_answer(const struct frame_job *job, uint32_t light, const struct hit *hit,
                  struct shade_path *path)
{
    bool rtrs = job->look.profile == PROFILE_RTRS;
    if (hit->prim != ABI_NO_PRIM && (!rtrs || hit->t < path->far)) {
        path->segment.shadowed |= 1u << light;
        return;
    }
    const struct shade_tri *tri = &job->shade[path->segment.prim];
    float strength = job->light[light].strength, spec = job->material[tri->material].spec;
    path->d = path->d + strength * (path->nl > 0 ? path->nl : 0.0f);
    if (rtrs || path->rv > 0)
        add_specular(strength, spec, path);
}

/* Adds to path->error what total may differ from another renderer's: `error` of the added colour,
 * and `roundings` roundings of numbers up to `peak`, the largest |channel| of any result. If
 * nothing differs, both renderers have the same bits. */
static void carry_error(double error, double peak, int roundings, struct shade_path *path)
{
    if (error == 0 && path->error == 0)
        return;
    path->error += error;
    for (int i = 0; i < roundings; i++)
        path->error += apart(peak + path->error);
}

static float channel(const struct frame_job *job, const struct shade_material *material,
                     uint32_t index, float color, float total, double *peak,
                     const struct shade_path *path)
{
    float shine = path->s * material->specular, added;
    if (job->look.profile == PROFILE_RTRS) {
        added = (color * path->d) * material->diffuse + shine;
        *peak = fmax(*peak, fabs((double)added));
        if (index > 0)
            added = added * material->reflective;
    } else {
        added = (color * (job->look.ambience + path->d)) * material->diffuse + shine;
        *peak = fmax(*peak, fabs((double)added));
        added = added * path->weight;
    }
    *peak = fmax(fmax(*peak, fabs((double)added)), fabs((double)(total + added)));
    return total + added;
}

static void add_color(const struct frame_job *job, uint32_t index, struct shade_path *path)
{
    const struct shade_tri *tri = &job->shade[path->segment.prim];
    const struct shade_material *material = &job->material[tri->material];
    double peak = fabs((double)path->s * (double)material->specular);
    path->total.x = channel(job, material, index, material->color[0], path->total.x, &peak, path);
    path->total.y = channel(job, material, index, material->color[1], path->total.y, &peak, path);
    path->total.z = channel(job, material, index, material->color[2], path->total.z, &peak, path);
    double factor = path->weight;
    if (job->look.profile == PROFILE_RTRS)
        factor = index > 0 ? material->reflective : 1;
    /* Roundings, in order: s specular; its sum with diffuse; the product with a factor that may be
     * above 1; the sum with total. The first two are scaled by the factor. */
    double shine = path->s_error * (double)material->specular;
    if (path->s_error > 0)
        shine += 2 * apart(peak + shine);
    carry_error(shine * factor, peak, 2, path);
}

bool shade_next(const struct frame_job *job, uint32_t index, struct shade_path *path)
{
    add_color(job, index, path);
    if (index + 1 >= job->look.bounces)
        return false;
    bool rtrs = job->look.profile == PROFILE_RTRS;
    float along = 2.0f * vec3_dot(path->n, path->dir);
    struct vec3 dir = shade_unit(vec3_sub(path->dir, vec3_scale(path->n, along)));
    struct vec3 lift = vec3_scale(rtrs ? path->n : path->g, job->offset);
    if (is_zero(dir))
        return false;
    if (!rtrs) {
        const struct shade_tri *tri = &job->shade[path->segment.prim];
        path->weight = path->weight * job->material[tri->material].reflective;
        if (!(path->weight > 0 && vec3_dot(dir, path->g) > 0))
            return false;
    }
    bool behind = rtrs && vec3_dot(dir, path->n) < 0;
    path->org = behind ? vec3_sub(path->p, lift) : vec3_add(path->p, lift);
    path->dir = dir;
    return true;
}

/* One channel of a pixel. NaN gives 0. */
static uint32_t level(float total)
{
    float clamped = total > 0 ? total : 0.0f;
    clamped = clamped < 1 ? clamped : 1.0f;
    return (uint32_t)floorf(255.0f * clamped + 0.5f);
}

uint32_t shade_pixel(struct vec3 total)
{
    return level(total.x) | level(total.y) << 8 | level(total.z) << 16 | 255u << 24;
}

float shade_bound(const struct shade_path *path)
{
    if (path->error == 0)
        return 0.0f;
    /* 255 times a channel and its sum with 0.5 are below 256, so each is rounded by up to 2^-17 in
     * either renderer. */
    double bound = 255 * path->error + 4 * 0x1p-17;
    return bound < 0x1p20 ? nextafterf((float)bound, INFINITY) : INFINITY;
}
