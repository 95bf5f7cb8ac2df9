/* Whole pictures: against a renderer in double that was written from the formulas alone, and
 * against themselves path by path. */
#include "tests/scenes/render_fixture.h"
#include "ref/store.h"

static double dot(const vec a, const vec b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void add_scaled(const vec a, const vec b, double s, vec out)
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] + b[k] * s;
}

static void normal(vec v)
{
    double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; k++)
        v[k] /= length;
}

static bool blocked(const struct picture *p, const vec org, const vec dir, double tmin, double tmax)
{
    struct ray ray = {.tmin = (float)tmin, .tmax = (float)tmax};
    struct hit hit;
    for (int k = 0; k < 3; k++) {
        ray.org[k] = (float)org[k];
        ray.dir[k] = (float)dir[k];
    }
    trace_brute(&p->scene, tri_test_find("mt"), QUERY_CLOSEST, &ray, &hit);
    return hit.prim != ABI_NO_PRIM && (double)hit.t < tmax;
}

/* Light at a place: diffuse and specular, by the book of either profile. */
static void gather(const struct picture *p, const vec at, const vec n, const vec g, const vec dir,
                   double spec, double *diffuse, double *specular)
{
    bool rtrs = p->job.look.profile == PROFILE_RTRS;
    for (uint32_t i = 0; i < p->job.light_count; i++) {
        const struct shade_light *light = &p->job.light[i];
        bool eye = i == 0 && p->job.look.camera_light > 0;
        vec to, org;
        for (int k = 0; k < 3; k++)
            to[k] = (double)(eye ? p->view.pos : light->pos)[k] - at[k];
        double far = sqrt(dot(to, to));
        normal(to);
        double nl = dot(n, to), rv = -(2 * nl * dot(n, dir) - dot(to, dir));
        if (!rtrs && (nl <= 0 || dot(g, to) <= 0))
            continue;
        add_scaled(at, rtrs ? n : g, (rtrs && nl < 0 ? -1 : 1) * (double)p->job.offset, org);
        if (blocked(p, org, to, (double)p->job.tmin, far))
            continue;
        *diffuse += (double)light->strength * fmax(nl, 0);
        *specular += rv > 0 ? (double)light->strength * pow(rv, spec) : 0;
    }
}

static void look_along(const struct picture *p, vec org, vec dir, vec color)
{
    bool rtrs = p->job.look.profile == PROFILE_RTRS;
    double weight = 1;
    color[0] = color[1] = color[2] = 0;
    for (uint32_t i = 0; i < p->job.look.bounces; i++) {
        struct ray ray = {.tmin = p->job.tmin, .tmax = p->job.tmax};
        struct hit hit;
        vec at, n, g, next;
        for (int k = 0; k < 3; k++) {
            ray.org[k] = (float)org[k];
            ray.dir[k] = (float)dir[k];
        }
        trace_brute(&p->scene, tri_test_find("mt"), QUERY_CLOSEST, &ray, &hit);
        if (hit.prim == ABI_NO_PRIM)
            return;
        const struct shade_tri *tri = &p->job.shade[hit.prim];
        const struct shade_material *m = &p->job.material[tri->material];
        add_scaled(org, dir, (double)hit.t, at);
        for (int k = 0; k < 3; k++) {
            n[k] = (1 - (double)hit.u - (double)hit.v) * (double)tri->na[k] +
                   (double)hit.u * (double)tri->nb[k] + (double)hit.v * (double)tri->nc[k];
            g[k] = (double)tri->plane[k];
        }
        normal(n);
        for (int k = 0, away = dot(g, dir) > 0; k < 3; k++)
            g[k] *= away ? -1 : 1;
        for (int k = 0, away = !rtrs && dot(n, g) < 0; k < 3; k++)
            n[k] *= away ? -1 : 1;
        double diffuse = rtrs ? 0 : (double)p->job.look.ambience, specular = 0;
        gather(p, at, n, g, dir, (double)m->spec, &diffuse, &specular);
        double share = rtrs ? (i > 0 ? (double)m->reflective : 1) : weight;
        for (int k = 0; k < 3; k++)
            color[k] += share * ((double)m->color[k] * diffuse * (double)m->diffuse +
                                 specular * (double)m->specular);
        add_scaled(dir, n, -2 * dot(n, dir), next);
        weight *= (double)m->reflective;
        if (!rtrs && (weight <= 0 || dot(next, g) <= 0))
            return;
        add_scaled(at, rtrs ? n : g, (rtrs && dot(next, n) < 0 ? -1 : 1) * (double)p->job.offset,
                   org);
        memcpy(dir, next, sizeof next);
        normal(dir);
    }
}

static void render_equals_the_formulas(void **state)
{
    (void)state;
    static const char *const spec[] = {"rtrs", "platonic", "cornell"};
    for (size_t s = 0; s < ARRAY_COUNT(spec); s++)
        for (size_t l = 0; l < ARRAY_COUNT(looks); l++) {
            struct scene scene;
            assert_int_equal(scene_open(spec[s], 1, &scene, NULL), STATUS_OK);
            picture_nearer(&scene, 0.4f);
            struct look look = looks[l];
            look.camera_light = scene.light_count ? look.camera_light : 1;
            struct picture p = picture_of(scene, look, false, 72, 48);
            assert_true(picture_draw(&p, "cpu", 2, true, &p.frame));
            size_t apart = 0, lit = 0, pixels = (size_t)p.job.width * p.job.height;
            for (uint32_t i = 0; i < pixels; i++) {
                double nx = (i % 72 + (double)p.view.centre) / 72 - 0.5;
                double ny = (47 - i / 72 + (double)p.view.centre) / 48 - 0.5;
                vec org, dir, color;
                for (int k = 0; k < 3; k++) {
                    org[k] = (double)p.view.pos[k];
                    dir[k] = nx * (double)p.view.right[k] + ny * (double)p.view.up[k] +
                             (double)p.view.forward[k];
                }
                normal(dir);
                look_along(&p, org, dir, color);
                double off = 0;
                for (int k = 0; k < 3; k++)
                    off = fmax(off,
                               fabs(color[k] - (double)p.frame.color[3 * (size_t)i + (size_t)k]));
                apart += !(off < 1e-3);
                lit += p.frame.pixel[i] != 0xFF000000u;
            }
            print_message("%s, profile %d: %zu of %zu pixels lit, %zu apart\n", spec[s],
                          (int)look.profile, lit, pixels, apart);
            assert_true(lit > 100);
            assert_true(apart * 100 <= pixels); /* edges, of shadows too */
            picture_free(&p);
        }
}

/* One path alone, ray after ray. */
static void walk(const struct picture *p, uint32_t x, uint32_t y, struct shade_path *path,
                 struct segment *segment)
{
    bool any = p->job.look.profile == PROFILE_REPAIRED, on = p->job.look.bounces > 0;
    shade_begin(&p->job, &p->view, x, y, path);
    path->bounded = true;
    for (uint32_t i = 0; i < p->job.look.bounces; i++) {
        segment[i] = (struct segment){.prim = ABI_NO_SEGMENT};
        if (!on)
            continue;
        struct ray ray = shade_ray(&p->job, path);
        struct hit hit;
        const struct job *job = &p->job.job;
        assert_int_equal(trace_ray(&(struct job){.scene = job->scene,
                                                 .packed = job->packed,
                                                 .box = job->box,
                                                 .tri = job->tri,
                                                 .query = QUERY_CLOSEST},
                                   &ray, &hit, NULL),
                         STATUS_OK);
        on = shade_hit(&p->job, &hit, path);
        for (uint32_t light = 0; on && light < p->job.light_count; light++)
            if (shade_ask(&p->job, &p->view, light, path, &ray)) {
                assert_int_equal(trace_ray(&(struct job){.scene = job->scene,
                                                         .packed = job->packed,
                                                         .box = job->box,
                                                         .tri = job->tri,
                                                         .query = any ? QUERY_ANY : QUERY_CLOSEST},
                                           &ray, &hit, NULL),
                                 STATUS_OK);
                shade_answer(&p->job, light, &hit, path);
            }
        segment[i] = path->segment;
        on = on && shade_next(&p->job, i, path);
    }
}

/* More pixels than a strip has: what waves make of them is what each path is alone. */
static void render_waves_are_paths(void **state)
{
    (void)state;
    for (size_t l = 0; l < ARRAY_COUNT(looks); l++) {
        struct picture p = picture_make("rtrs", looks[l], 700, 450);
        assert_true(picture_draw(&p, "cpu", 0, true, &p.frame));
        for (uint32_t i = 0; i < 700 * 450; i += 97) {
            struct shade_path path;
            struct segment segment[4];
            walk(&p, i % 700, i / 700, &path, segment);
            assert_memory_equal(&path.total, p.frame.color + 3 * (size_t)i, sizeof path.total);
            assert_memory_equal(segment, p.frame.segment + 4 * (size_t)i, sizeof segment);
            assert_int_equal(shade_pixel(path.total), p.frame.pixel[i]);
            assert_true(shade_bound(&path) == p.frame.bound[i]);
        }
        picture_free(&p);
    }
}

static void render_is_the_same_on_any_threads(void **state)
{
    (void)state;
    struct picture a = picture_make("rtrs", looks[0], 161, 97);
    struct picture b = picture_make("rtrs", looks[0], 161, 97);
    assert_true(picture_draw(&a, "cpu", 1, true, &a.frame));
    assert_true(picture_draw(&b, "cpu", 5, true, &b.frame));
    assert_memory_equal(a.frame.pixel, b.frame.pixel, 161 * 97 * sizeof *a.frame.pixel);
    assert_memory_equal(a.frame.color, b.frame.color, 161 * 97 * 3 * sizeof *a.frame.color);
    assert_memory_equal(a.frame.bound, b.frame.bound, 161 * 97 * sizeof *a.frame.bound);
    assert_memory_equal(a.frame.segment, b.frame.segment, 161 * 97 * 4 * sizeof *a.frame.segment);
    assert_int_equal(a.report.boxes, b.report.boxes);
    /* Arrays that are not wanted may be missing. */
    struct frame alone = {.pixel = b.frame.pixel};
    assert_true(picture_draw(&b, "cpu", 2, true, &alone));
    assert_memory_equal(a.frame.pixel, b.frame.pixel, 161 * 97 * sizeof *a.frame.pixel);
    picture_free(&a);
    picture_free(&b);
}

/* RTRS shows its default scene without the dodecahedron's last triangle (F2); a naive handler
 * shows it, and so do repaired members. */
static void render_profiles_differ_by_their_members(void **state)
{
    (void)state;
    struct picture p = picture_make("rtrs", looks[1], 96, 64);
    struct frame frame = p.frame;
    assert_true(picture_draw(&p, "cpu", 2, true, &frame));
    size_t missing = 0, all = 96 * 64;
    struct picture q = picture_make("rtrs", looks[1], 96, 64);
    q.job.job.tri = tri_test_find("mt");
    assert_true(picture_draw(&q, "brute", 2, true, &q.frame));
    for (size_t i = 0; i < all; i++)
        missing += p.frame.segment[4 * i].prim != q.frame.segment[4 * i].prim;
    assert_true(missing > 10 && missing < all / 4);
    picture_free(&p);
    picture_free(&q);
}

static void render_blank_and_no_bounces_are_black(void **state)
{
    (void)state;
    struct look look = looks[0];
    struct picture p = picture_make("rtrs", look, 40, 30);
    struct packed none = {.layout = layout_find("f32"), .store = tri_stores[0]};
    struct packed kept = p.packed;
    p.packed = none;
    assert_true(picture_draw(&p, "cpu", 1, true, &p.frame));
    p.packed = kept;
    for (size_t i = 0; i < 40 * 30; i++) {
        assert_int_equal(p.frame.pixel[i], 0xFF000000u);
        assert_int_equal(p.frame.segment[4 * i].prim, ABI_NO_PRIM);
        assert_int_equal(p.frame.segment[4 * i + 1].prim, ABI_NO_SEGMENT);
    }
    picture_free(&p);
    look.bounces = 0;
    p = picture_make("rtrs", look, 40, 30);
    memset(p.frame.pixel, 0x55, 40 * 30 * sizeof *p.frame.pixel);
    assert_true(picture_draw(&p, "cpu", 1, true, &p.frame));
    for (size_t i = 0; i < 40 * 30; i++)
        assert_int_equal(p.frame.pixel[i], 0xFF000000u);
    picture_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(render_equals_the_formulas),
        cmocka_unit_test(render_waves_are_paths),
        cmocka_unit_test(render_is_the_same_on_any_threads),
        cmocka_unit_test(render_profiles_differ_by_their_members),
        cmocka_unit_test(render_blank_and_no_bounces_are_black),
    };
    return cmocka_run_group_tests_name("render", tests, NULL, NULL);
}
