/* The same pictures by other engines. On Vulkan drivers that need no GPU (the first; with
 * RAYDIFF_SLOW all of them, and more scenes) each segment of each path has the C renderer's bits,
 * and each pixel its value, or the other one where the colour lies within the bound of a rounding
 * border. */
#include "scenes/render/diff_frames.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/pictures.h"

#define WIDTH  56u
#define HEIGHT 42u
#define PIXELS ((size_t)WIDTH * HEIGHT)

static bool slow; /* RAYDIFF_SLOW is set */

static const char *const cpu_drivers[] = {"stock", "mesa25", "swiftshader"};

/* What is drawn; `rtrs`: RTRS's members, too, can hold it. */
static const struct {
    const char *spec;
    bool rtrs;
} scenes[] = {
    {"rtrs", true},           {"cornell", false},    {"platonic", true},   {"flake:depth=1", false},
    {"needles:n=200", false}, {"stack:n=30", false}, {"sphere:n=6", true},
};

/* Pipelines are made for each scene, which takes drivers long: without RAYDIFF_SLOW the first of
 * the scenes on the first driver. */
#define QUICK_SCENES 3

static const struct look looks[] = {
    {.profile = PROFILE_REPAIRED, .bounces = 5, .ambience = 0.125f, .camera_light = 0.5f},
    {.profile = PROFILE_RTRS, .bounces = 4, .camera_light = 0.25f},
};

static struct picture make(size_t scene, struct look look)
{
    struct scene made;
    struct reason reason = {""};
    if (scene_open(scenes[scene].spec, 1, &made, &reason))
        fail_msg("%s", reason.text);
    picture_nearer(&made, 0.5f);
    bool rtrs = look.profile == PROFILE_RTRS && scenes[scene].rtrs;
    struct picture p = picture_of(made, look, rtrs, WIDTH, HEIGHT);
    for (uint32_t i = 0; i < p.shading.material_count; i++) /* mirrors everywhere: longer paths */
        if (p.shading.material[i].reflective == 0)
            p.shading.material[i].reflective = 0.5f;
    return p;
}

static struct renderer *open_on(const char *engine, const char *driver, bool waves)
{
    struct renderer *renderer;
    struct reason reason = {""};
    const struct engine_options options = {.driver = driver, .device = -1};
    enum status status = renderer_open(engine_find(engine), &options, waves, &renderer, &reason);
    if (status == STATUS_UNSUPPORTED)
        print_message("SKIP %s\n", reason.text);
    else if (status)
        fail_msg("%s", reason.text);
    return renderer;
}

static void draw(struct renderer *renderer, struct picture *p, struct frame *frame)
{
    struct reason reason = {""};
    picture_settle(p);
    if (renderer_prepare(renderer, &p->job, &reason) ||
        renderer_frame(renderer, &p->view, frame, &p->report, &reason))
        fail_msg("%s", reason.text);
}

/* Draws a scene by both and counts pixels whose value differs, which rounding must allow. */
static size_t compare(struct renderer *cpu, struct renderer *other, size_t scene, struct look look,
                      size_t *second)
{
    struct picture p = make(scene, look), q = make(scene, look);
    size_t borders = 0;
    draw(cpu, &p, &p.frame);
    struct frame wanted = q.frame;
    wanted.bound = NULL; /* which the renderer in C alone knows */
    draw(other, &q, &wanted);
    for (size_t i = 0; i < PIXELS; i++) {
        const struct segment *a = &p.frame.segment[i * look.bounces];
        const struct segment *b = &q.frame.segment[i * look.bounces];
        uint32_t index;
        enum path_field field = path_first(a, b, look.bounces, &index);
        if (field != PATH_SAME)
            fail_msg("%s, profile %d, pixel %zu: %s of segment %u is another", scenes[scene].spec,
                     (int)look.profile, i, path_field_name(field), index);
        *second += look.bounces > 1 && a[1].prim < ABI_NO_SEGMENT;
        borders += p.frame.pixel[i] != q.frame.pixel[i];
        if (!pixel_within(p.frame.color + 3 * i, p.frame.bound[i], q.frame.pixel[i]))
            fail_msg("%s, profile %d, pixel %zu: %08x, not %08x", scenes[scene].spec,
                     (int)look.profile, i, q.frame.pixel[i], p.frame.pixel[i]);
    }
    picture_free(&p);
    picture_free(&q);
    return borders;
}

/* All scenes in both profiles. */
static void engines_agree(const char *engine, bool waves)
{
    struct renderer *cpu = open_on("cpu", NULL, true);
    size_t ran = 0;
    for (size_t d = 0; d < (slow ? ARRAY_COUNT(cpu_drivers) : 1); d++) {
        struct renderer *other = open_on(engine, cpu_drivers[d], waves);
        size_t borders = 0, second = 0;
        if (!other)
            continue;
        for (size_t s = 0; s < (slow ? ARRAY_COUNT(scenes) : QUICK_SCENES); s++)
            for (size_t l = 0; l < ARRAY_COUNT(looks); l++)
                borders += compare(cpu, other, s, looks[l], &second);
        print_message("%s on %s, %s: %zu pixels at rounding borders, %zu paths reflected\n", engine,
                      cpu_drivers[d], waves ? "by waves" : "on its own", borders, second);
        assert_true(second > 1000);
        renderer_close(other);
        ran++;
    }
    renderer_close(cpu);
    if (!ran)
        skip();
}

static void engines_vulkan_by_waves(void **state)
{
    (void)state;
    engines_agree("vulkan", true);
}

static void engines_vulkan_on_its_own(void **state)
{
    (void)state;
    if (!engine_find("vulkan")->renderer) {
        print_message("SKIP engine vulkan has no renderer of its own\n");
        skip();
    }
    engines_agree("vulkan", false);
}

/* A picture by Embree differs where its answers do; here at some edges. */
static void engines_embree_shows_the_same_scene(void **state)
{
    (void)state;
    struct renderer *cpu = open_on("cpu", NULL, true);
    struct renderer *embree = open_on("embree_robust", NULL, true);
    if (!embree) {
        renderer_close(cpu);
        skip();
    }
    struct picture p = make(1, looks[0]), q = make(1, looks[0]);
    size_t apart = 0, hit = 0;
    draw(cpu, &p, &p.frame);
    draw(embree, &q, &q.frame);
    for (size_t i = 0; i < PIXELS; i++) {
        apart += p.frame.pixel[i] != q.frame.pixel[i];
        hit += p.frame.segment[i * looks[0].bounces].prim != ABI_NO_PRIM;
    }
    assert_true(hit > PIXELS / 2);
    assert_true(apart < PIXELS / 50);
    picture_free(&p);
    picture_free(&q);
    renderer_close(embree);
    renderer_close(cpu);
}

int main(void)
{
    slow = getenv("RAYDIFF_SLOW") != NULL;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(engines_vulkan_by_waves),
        cmocka_unit_test(engines_vulkan_on_its_own),
        cmocka_unit_test(engines_embree_shows_the_same_scene),
    };
    return cmocka_run_group_tests_name("vulkan_render", tests, NULL, NULL);
}
