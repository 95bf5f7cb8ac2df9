/* Paths by hand: scenes small enough for every number of theirs to be worked out on paper. */
#include "scenes/render/shade.h"

#include "ref/trace/trace.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/pictures.h"

static const struct look repaired = {.profile = PROFILE_REPAIRED, .bounces = 4};
static const struct look rtrs = {.profile = PROFILE_RTRS, .bounces = 4};

static const struct material plain = {
    .color = {.5f, .25f, .125f}, .albedo = {.5f, .25f, 0}, .spec = 2};

/* A wall in the plane z = 0 around the origin, seen from (0, 0, 4). */
static const float wall[3][3] = {{-3, -3, 0}, {5, -3, 0}, {-3, 5, 0}};
static const struct camera front = {.pos = {0, 0, 4}, .at = {0, 0, 0}};

static void assert_color(const struct picture *p, double red, double green, double blue)
{
    const float *c = p->frame.color;
    if (!(fabs((double)c[0] - red) <= 1e-6 && fabs((double)c[1] - green) <= 1e-6 &&
          fabs((double)c[2] - blue) <= 1e-6))
        fail_msg("(%.8g %.8g %.8g) is not (%g %g %g)", (double)c[0], (double)c[1], (double)c[2],
                 red, green, blue);
}

/* The picture of 1 x 1 pixels, what is ahead; a published one would look through its corner. */
static struct picture one_pixel(struct scene scene, struct look look)
{
    struct picture p = picture_of(scene, look, false, 1, 1);
    p.view.centre = 0.5f;
    assert_true(picture_draw(&p, "cpu", 1, true, &p.frame));
    return p;
}

static void shade_light_ahead(void **state)
{
    (void)state;
    const struct light light = {{0, 0, 2}, 2};
    struct look look = repaired;
    look.ambience = 0.5f;
    struct picture p = one_pixel(picture_scene(wall, 1, &plain, &light, 1, front), look);
    /* D = S = 2: color (0.5 + 2) 0.5 + 2 0.25 */
    assert_color(&p, 1.125, 0.8125, 0.65625);
    assert_int_equal(p.frame.pixel[0], 255u | 207u << 8 | 167u << 16 | 255u << 24);
    assert_true(p.frame.segment[0].t == 4 && p.frame.segment[0].prim == 0);
    assert_int_equal(p.frame.segment[0].asked, 1);
    assert_int_equal(p.frame.segment[0].shadowed, 0);
    assert_int_equal(p.frame.segment[1].prim, ABI_NO_SEGMENT);
    assert_true(p.frame.bound[0] > 0); /* 1 to any power, but by a logarithm that errs */
    picture_free(&p);
    look.profile = PROFILE_RTRS; /* the ambience is not read, reflections always go on */
    p = one_pixel(picture_scene(wall, 1, &plain, &light, 1, front), look);
    assert_color(&p, 1.0, 0.75, 0.625);
    assert_int_equal(p.frame.segment[1].prim, ABI_NO_PRIM);
    assert_int_equal(p.frame.segment[2].prim, ABI_NO_SEGMENT);
    picture_free(&p);
}

static void shade_lights_aslant_add_up(void **state)
{
    (void)state;
    /* L = (0.6, 0, 0.8): nl = 0.8, the mirrored ray meets the eye at 0.8, to the power of 2 */
    const struct light light[] = {{{3, 0, 4}, 1}, {{0, 0, 2}, 0}, {{-3, 0, 4}, 0.5f}};
    struct picture p = one_pixel(picture_scene(wall, 1, &plain, light, 3, front), repaired);
    assert_int_equal(p.job.light_count, 2); /* that of no strength is left out */
    double d = 1.5 * 0.8, s = 1.5 * 0.64;
    assert_color(&p, 0.25 * d + 0.25 * s, 0.125 * d + 0.25 * s, 0.0625 * d + 0.25 * s);
    assert_int_equal(p.frame.segment[0].asked, 3);
    picture_free(&p);
}

static void shade_light_behind_the_wall(void **state)
{
    (void)state;
    const struct light light = {{0, 0, -2}, 2};
    struct picture p = one_pixel(picture_scene(wall, 1, &plain, &light, 1, front), repaired);
    assert_color(&p, 0, 0, 0);
    assert_int_equal(p.frame.segment[0].asked, 0);
    assert_true(p.frame.bound[0] == 0);
    picture_free(&p);
    /* The published one asks, from behind the wall, and adds nothing diffuse; R = (0, 0, -1) is
     * seen from behind as if it were ahead: rv < 0. */
    p = one_pixel(picture_scene(wall, 1, &plain, &light, 1, front), rtrs);
    assert_color(&p, 0, 0, 0);
    assert_int_equal(p.frame.segment[0].asked, 1);
    assert_int_equal(p.frame.segment[0].shadowed, 0);
    picture_free(&p);
}

/* The wall, and a small triangle on the way to the light at (0, 3, 3), or as far beyond it. */
static struct picture shadowed(double share, struct look look)
{
    float corner[6][3];
    const struct light light = {{0, 3, 3}, 1};
    const struct material both[2] = {plain, plain};
    memcpy(corner, wall, sizeof wall);
    float at = (float)(3 * share);
    const float small[3][3] = {{-1, at, at - 1}, {1, at, at - 1}, {0, at, at + 1}};
    memcpy(corner + 3, small, sizeof small);
    return one_pixel(picture_scene((const float(*)[3])corner, 2, both, &light, 1, front), look);
}

static void shade_shadow_ends_at_the_light(void **state)
{
    (void)state;
    const struct look look[] = {repaired, rtrs};
    for (int i = 0; i < 2; i++) {
        struct picture p = shadowed(0.5, look[i]);
        assert_int_equal(p.frame.segment[0].asked, 1);
        assert_int_equal(p.frame.segment[0].shadowed, 1);
        assert_color(&p, 0, 0, 0);
        picture_free(&p);
        p = shadowed(1.5, look[i]);
        assert_int_equal(p.frame.segment[0].shadowed, 0);
        assert_true(p.frame.color[0] > 0.17f);
        picture_free(&p);
    }
}

static void shade_eye_gives_light(void **state)
{
    (void)state;
    struct look look = repaired;
    look.camera_light = 0.5f;
    const struct light none = {{0, 0, 0}, 0};
    struct picture p = one_pixel(picture_scene(wall, 1, &plain, &none, 1, front), look);
    assert_int_equal(p.job.light_count, 1);
    assert_color(&p, 0.25 * 0.5 + 0.25 * 0.5, 0.125 * 0.5 + 0.25 * 0.5, 0.0625 * 0.5 + 0.25 * 0.5);
    picture_free(&p);
}

/* A mirror in the plane y = 0 that the eye at (0, 3, 4) sees at the origin, and a wall in the plane
 * z = -8: the ray meets it at (0, 6, -8). */
static struct picture mirrored(float at_mirror, float at_wall, struct look look)
{
    static const float corner[6][3] = {{-9, 0, 9},   {9, 0, 9},   {0, 0, -9},
                                       {-90, 0, -8}, {90, 0, -8}, {0, 90, -8}};
    struct material material[2] = {plain, plain};
    material[0].albedo[0] = material[0].albedo[1] = 0;
    material[0].albedo[2] = at_mirror;
    material[1].albedo[1] = 0;
    material[1].albedo[2] = at_wall;
    const struct light light = {{0, 6, 0}, 1};
    const struct camera camera = {.pos = {0, 3, 4}, .at = {0, 0, 0}};
    return one_pixel(picture_scene(corner, 2, material, &light, 1, camera), look);
}

static void shade_mirror_shows_the_wall(void **state)
{
    (void)state;
    struct picture p = mirrored(0.5f, 0.25f, repaired);
    const struct segment *segment = p.frame.segment;
    assert_int_equal(segment[0].prim, 0);
    assert_true(fabsf(segment[0].t - 5) < 1e-5f);
    assert_int_equal(segment[1].prim, 1);
    assert_true(fabsf(segment[1].t - 10) < 1e-3f);
    /* The light stands straight before the wall; the mirror's weight counts. */
    assert_color(&p, 0.5 * 0.25, 0.5 * 0.125, 0.5 * 0.0625);
    picture_free(&p);
    p = mirrored(0.5f, 0.25f, rtrs); /* the weight of what is seen in the mirror counts */
    assert_color(&p, 0.25 * 0.25, 0.25 * 0.125, 0.25 * 0.0625);
    picture_free(&p);
    p = mirrored(0, 0.25f, repaired); /* no weight: the path ends at the mirror */
    assert_color(&p, 0, 0, 0);
    assert_int_equal(p.frame.segment[1].prim, ABI_NO_SEGMENT);
    picture_free(&p);
    struct look look = repaired;
    look.bounces = 1;
    p = mirrored(0.5f, 0.25f, look);
    assert_color(&p, 0, 0, 0);
    picture_free(&p);
}

/* The mirror, the wall, which reflects, too, and a ceiling in the plane y = 12: the path meets them
 * at (0, 0, 0), (0, 6, -8) and (0, 12, 0), and the light stands straight before the last two. */
static struct picture mirrored_twice(struct look look)
{
    static const float corner[9][3] = {{-9, 0, 9},   {9, 0, 9},   {0, 0, -9},
                                       {-90, 0, -8}, {90, 0, -8}, {0, 90, -8},
                                       {-9, 12, 9},  {0, 12, -9}, {9, 12, 9}};
    static const float reflective[3] = {0.5f, 0.25f, 0.125f};
    struct material material[3] = {plain, plain, plain};
    for (int i = 0; i < 3; i++) {
        material[i].albedo[0] = i > 0 ? 0.5f : 0;
        material[i].albedo[1] = 0;
        material[i].albedo[2] = reflective[i];
    }
    const struct light light = {{0, 6, 0}, 1};
    const struct camera camera = {.pos = {0, 3, 4}, .at = {0, 0, 0}};
    return one_pixel(picture_scene(corner, 3, material, &light, 1, camera), look);
}

static void shade_weights_of_reflections_multiply(void **state)
{
    (void)state;
    struct picture p = mirrored_twice(repaired);
    assert_int_equal(p.frame.segment[2].prim, 2);
    double share = 0.5 * (0.5 + 0.5 * 0.25);
    assert_color(&p, share * 0.5, share * 0.25, share * 0.125);
    picture_free(&p);
    p = mirrored_twice(rtrs); /* each by the weight of what is seen alone */
    assert_int_equal(p.frame.segment[2].prim, 2);
    share = 0.5 * (0.25 + 0.125);
    assert_color(&p, share * 0.5, share * 0.25, share * 0.125);
    picture_free(&p);
}

static void shade_pixel_clamps_and_rounds(void **state)
{
    (void)state;
    assert_int_equal(shade_pixel((struct vec3){0, 1, 2}), 0xFFFFFF00u);
    assert_int_equal(shade_pixel((struct vec3){-1, NAN, INFINITY}), 0xFFFF0000u);
    assert_int_equal(shade_pixel((struct vec3){0.5f, 1 / 255.0f, 0.4f / 255}), 0xFF000180u);
}

/* pow by the worst roads that Vulkan allows: each step off by all it may be, one way or the other.
 */
static double skewed(double x, double y, double way)
{
    double l = log2(x);
    l += way * (x >= 0.5 && x <= 2 ? 0x1p-21 : 3 * 0x1p-23 * fabs(l)) * (y < 0 ? -1 : 1);
    double z = y * l * (1 + way * (y * l < 0 ? -1 : 1) * 0x1p-23);
    return exp2(z) * (1 + way * 0x1p-23 * (3 + 2 * fabs(z)));
}

static void shade_pow_error_covers_the_worst_pow(void **state)
{
    (void)state;
    static const float exponent[] = {0, 0.5f, 1, 2, 10, 50, 1000, 12345, -3};
    double tightest = 0;
    for (size_t i = 0; i < ARRAY_COUNT(exponent); i++)
        for (float x = 0x1p-20f; x < 1.01f; x *= 1.01f) {
            double error = shade_pow_error(x, exponent[i]), p = (double)powf(x, exponent[i]);
            for (int way = -1; way <= 1; way += 2) {
                double off = fabs(skewed((double)x, (double)exponent[i], way) - p);
                if (!(off <= error))
                    fail_msg("pow(%a, %g) is off by %g, not %g", (double)x, (double)exponent[i],
                             off, error);
                if (error > 0x1p-100)
                    tightest = fmax(tightest, off / error);
            }
        }
    assert_true(tightest > 0.9);
}

/* A ray has the range of its job, whatever the look, from where its path stands. */
static void shade_ray_has_the_range_of_its_job(void **state)
{
    (void)state;
    for (int i = 0; i < 40; i++) {
        const float k = (float)i;
        const struct frame_job job = {
            .look = i % 2 ? rtrs : repaired, .tmin = 0.25f * k, .tmax = ldexpf(1.5f, 3 * i)};
        const struct shade_path path = {.org = {k, k + 1, k + 2}, .dir = {k + 3, k + 4, -k}};
        const struct ray ray = shade_ray(&job, &path);
        assert_true(ray.tmin == job.tmin && ray.tmax == job.tmax);
        assert_true(ray.org[0] == k && ray.org[1] == k + 1 && ray.org[2] == k + 2);
        assert_true(ray.dir[0] == k + 3 && ray.dir[1] == k + 4 && ray.dir[2] == -k);
    }
}

/* A shadow ray begins off the surface, on the side of the light: along the shading normal as
 * published, else along the triangle's. It goes to the light, as far as that is or beyond. */
static void shadow_rays_begin_on_the_side_of_the_light(void **state)
{
    (void)state;
    size_t asked[2] = {0};
    for (int i = 0; i < 64; i++) {
        const float up = i & 1 ? 3 : -3;
        const struct shade_light light = {{i & 2 ? 1 : -2, up, i & 4 ? 2 : -1}, 1};
        const struct frame_job job = {.look = i & 8 ? rtrs : repaired,
                                      .light = &light,
                                      .light_count = 1,
                                      .tmax = 77,
                                      .offset = 0.125f};
        const bool published = i & 8;
        const float n = i & 16 ? 1 : -1; /* the normals, which agree or do not */
        struct shade_path path = {.n = {0, n, 0}, .g = {0, i & 32 ? n : -n, 0}, .dir = {0, -1, 0}};
        const struct view view = {.right = {1}};
        struct ray ray;
        const bool lit = n * up > 0, seen = path.g.y * up > 0;
        assert_int_equal(shade_ask(&job, &view, 0, &path, &ray), published || (lit && seen));
        if (!published && !(lit && seen))
            continue;
        assert_true(ray.org[1] == (up > 0 ? 0.125f : -0.125f));
        assert_true(ray.org[0] == 0 && ray.org[2] == 0);
        assert_true(ray.dir[1] * up > 0 && ray.dir[0] * light.pos[0] > 0);
        float far = sqrtf(9 + light.pos[0] * light.pos[0] + light.pos[2] * light.pos[2]);
        assert_true(ray.tmax == (published ? 77 : far) && path.far == far);
        assert_int_equal(path.segment.asked, 1);
        asked[published]++;
    }
    assert_true(asked[0] == 8 && asked[1] == 32);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shade_light_ahead),
        cmocka_unit_test(shade_lights_aslant_add_up),
        cmocka_unit_test(shade_light_behind_the_wall),
        cmocka_unit_test(shade_shadow_ends_at_the_light),
        cmocka_unit_test(shade_eye_gives_light),
        cmocka_unit_test(shade_mirror_shows_the_wall),
        cmocka_unit_test(shade_weights_of_reflections_multiply),
        cmocka_unit_test(shadow_rays_begin_on_the_side_of_the_light),
        cmocka_unit_test(shade_ray_has_the_range_of_its_job),
        cmocka_unit_test(shade_pixel_clamps_and_rounds),
        cmocka_unit_test(shade_pow_error_covers_the_worst_pow),
    };
    return cmocka_run_group_tests_name("shade", tests, NULL, NULL);
}
