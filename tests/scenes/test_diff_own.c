/* An engine with a renderer of its own that lies in one known way: it is held to the walk of its
 * own rays, pixel by pixel and in whole pictures, on either side. */
#include "scenes/render/diff_engines.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/pictures.h"

#include <math.h>

#define WIDTH   24u
#define HEIGHT  18u
#define PIXELS  (WIDTH * HEIGHT)
#define BOUNCES 4u

/* What the renderer draws otherwise, in one pixel. */
static struct {
    size_t pixel;
    uint32_t segment;
    enum path_field field; /* PATH_SAME: the value alone */
    uint32_t value;        /* xor */
    enum status status;    /* of drawing */
} lie;

static struct renderer *honest; /* draws in C */
static struct engine own;       /* engine cpu with that renderer */
static struct picture picture;
static struct side a, b; /* cpu; own */
static struct oracle *oracle;
static struct reason reason;

static enum status own_prepare(void *self, const struct frame_job *job, struct reason *why)
{
    (void)self;
    return renderer_prepare(honest, job, why);
}

static enum status own_draw(void *self, const struct view *view, struct frame *out,
                            struct trace_report *report, struct reason *why)
{
    (void)self;
    struct frame drawn = *out;
    drawn.bound = NULL; /* only the renderer in C has it */
    if (lie.status)
        return (fail)(why, lie.status, "the device is lost");
    enum status status = renderer_frame(honest, view, &drawn, report, why);
    struct segment *segment = out->segment + lie.pixel * BOUNCES + lie.segment;
    out->pixel[lie.pixel] ^= lie.value;
    if (lie.field == PATH_PRIM)
        segment->prim ^= 1u;
    if (lie.field == PATH_T)
        segment->t = nextafterf(segment->t, INFINITY);
    if (lie.field == PATH_ASKED)
        segment->asked ^= 2u;
    if (lie.field == PATH_SHADOWED)
        segment->shadowed ^= 2u;
    return status;
}

static const struct frame_renderer own_renderer = {.prepare = own_prepare, .draw = own_draw};

static int begin(void **state)
{
    (void)state;
    const struct engine_options options = {.threads = 2, .device = -1};
    const struct look look = {
        .profile = PROFILE_REPAIRED, .bounces = BOUNCES, .ambience = 0.1f, .camera_light = 0.25f};
    struct scene scene;
    assert_int_equal(scene_open("rtrs", 1, &scene, NULL), STATUS_OK);
    picture_nearer(&scene, 0.4f);
    picture = picture_of(scene, look, false, WIDTH, HEIGHT);
    picture_settle(&picture);
    for (uint32_t i = 0; i < picture.shading.material_count; i++) /* so that pow may differ more */
        picture.shading.material[i].specular = 3000;
    own = *engine_find("cpu");
    own.name = "own";
    own.renderer = &own_renderer;
    if (renderer_open(engine_find("cpu"), &options, true, &honest, &reason) ||
        side_open(engine_find("cpu"), &options, &picture.job, false, &a, &reason) ||
        side_open(&own, &options, &picture.job, false, &b, &reason) ||
        oracle_make(&picture.scene, &oracle, &reason))
        fail_msg("%s", reason.text);
    return 0;
}

static int end(void **state)
{
    (void)state;
    side_close(&a);
    side_close(&b);
    renderer_close(honest);
    oracle_free(oracle);
    picture_free(&picture);
    return 0;
}

static struct side_drawn drawn_at(struct side *side, size_t pixel, uint32_t *length)
{
    struct diff_walk walk;
    struct side_drawn drawn;
    if (side_walk_pixel(side, &picture.view, pixel, &walk, &drawn, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(walk.count, 1);
    if (length)
        *length = walk.length[0];
    walk_free(&walk);
    return drawn;
}

static void what_is_right_follows(void **state)
{
    (void)state;
    memset(&lie, 0, sizeof lie);
    for (size_t i = 0; i < PIXELS; i += 17) {
        struct side_drawn drawn = drawn_at(&b, i, NULL);
        assert_true(drawn.follows && drawn.field == PATH_SAME);
        drawn = drawn_at(&a, i, NULL);
        assert_true(drawn.follows && drawn.field == PATH_SAME);
    }
    assert_null(a.frame.pixel); /* there is nothing to compare */
    assert_non_null(b.frame.pixel);
}

/* Every field of every segment of a path, and its value. */
static void expect_lies_told(size_t pixel, uint32_t length)
{
    lie.pixel = pixel;
    for (lie.segment = 0; lie.segment < length; lie.segment++)
        for (lie.field = PATH_PRIM; lie.field < PATH_FIELD_COUNT; lie.field++) {
            struct side_drawn drawn = drawn_at(&b, pixel, NULL);
            assert_false(drawn.follows);
            assert_int_equal(drawn.field, lie.field);
            assert_int_equal(drawn.segment, lie.segment);
        }
    lie.segment = 0;
    assert_true(drawn_at(&b, (pixel + 1) % PIXELS, NULL).follows);
    lie.field = PATH_SAME;
    lie.value = 0x400000; /* blue by 64 */
    struct side_drawn drawn = drawn_at(&b, pixel, NULL);
    assert_true(!drawn.follows && drawn.field == PATH_SAME);
}

static void every_lie_is_named_where_it_is(void **state)
{
    (void)state;
    size_t told[BOUNCES + 1] = {0};
    for (size_t i = 0; i < PIXELS; i++) {
        uint32_t length;
        memset(&lie, 0, sizeof lie);
        drawn_at(&a, i, &length);
        if (told[length]++ < 3)
            expect_lies_told(i, length);
    }
    print_message("%zu, %zu and %zu paths of 1 to 3 segments\n", told[1], told[2], told[3]);
    assert_true(told[0] == 0 && told[1] >= 3 && told[2] >= 3);
}

/* Of the same code the same value; of another renderer one within the bound, or that very value. */
static void values_are_held_to_the_bound(void **state)
{
    (void)state;
    static size_t every[PIXELS];
    static const float bounds[] = {NAN, 0, 0.3f, 3};
    struct diff_walk walk;
    struct segment path[BOUNCES];
    size_t within = 0, beyond = 0;
    for (size_t i = 0; i < PIXELS; i++)
        every[i] = i;
    assert_int_equal(side_walk(&a, &picture.view, every, PIXELS, &walk, &reason), STATUS_OK);
    for (size_t i = 0; i + 1 < PIXELS; i++)
        for (size_t k = 0; k < ARRAY_COUNT(bounds); k++) {
            uint32_t value = walk.frame.pixel[i];
            const uint32_t other[] = {value,         walk.frame.pixel[i + 1], value ^ 0x1u,
                                      value ^ 0x2u,  value ^ 0x100u,          value ^ 0x10000u,
                                      value ^ 0x40u, value ^ 0x1000000u};
            walk.frame.bound[i] = bounds[k];
            walk_segments(&walk, i, path);
            for (size_t c = 0; c < ARRAY_COUNT(other); c++) {
                bool same = other[c] == value;
                bool near = same || pixel_within(walk.frame.color + 3 * i, bounds[k], other[c]);
                assert_int_equal(why_walk_is_frame(&walk, i, path, other[c], true), same);
                assert_int_equal(why_walk_is_frame(&walk, i, path, other[c], false), near);
                within += near && !same;
                beyond += !near;
            }
            path[0].t = -1;
            assert_false(why_walk_is_frame(&walk, i, path, value, true));
            assert_false(why_walk_is_frame(&walk, i, path, value, false));
        }
    assert_true(within > PIXELS && beyond > PIXELS);
    walk_free(&walk);
}

/* A value beside a border: nothing to explain, and the bound of the C renderer. */
static void expect_border(uint32_t value, uint32_t other)
{
    struct side *const of[2] = {&a, &b};
    for (size_t side = 0; side < 2; side++)
        assert_int_equal(side_draw(of[side], &picture.view, &reason), STATUS_OK);
    for (size_t turned = 0; turned < 2; turned++) {
        struct pair pair;
        size_t *pixel, count;
        const struct pixel_border *border = &pair.border[0];
        assert_int_equal(pair_compare(of[turned], of[1 - turned], &pair, &pixel, &count, &reason),
                         STATUS_OK);
        assert_true(pair_agrees(&pair) && count == 0 && pair.asked == 0);
        assert_true(pair.diff.allowed == 1 && pair.border_count == 1);
        assert_int_equal(border->pixel, lie.pixel);
        assert_int_equal(border->value[turned], value);
        assert_int_equal(border->value[1 - turned], other);
        assert_true(border->bound == a.frame.bound[lie.pixel]);
        free(pixel);
    }
}

/* The value on the other side of a rounding border follows from the same path. */
static void values_beside_a_border_follow(void **state)
{
    (void)state;
    size_t found = 0;
    memset(&lie, 0, sizeof lie);
    for (size_t i = 0; i < PIXELS; i++) {
        struct diff_walk walk;
        assert_int_equal(side_walk(&a, &picture.view, &i, 1, &walk, &reason), STATUS_OK);
        for (unsigned k = 0; k < 6 && found < 4; k++) {
            uint32_t step = 1u << 8 * (k / 2), value = walk.frame.pixel[0];
            uint32_t other = k % 2 ? value + step : value - step;
            if (!pixel_within(walk.frame.color, walk.frame.bound[0], other))
                continue;
            lie.pixel = i;
            lie.value = value ^ other;
            assert_true(drawn_at(&b, i, NULL).follows);
            expect_border(value, other);
            found++;
        }
        walk_free(&walk);
    }
    print_message("%zu values beside a border\n", found);
    assert_true(found > 0);
}

/* The lie told by the second side, then by the first. */
static void pictures_are_held_to_it_on_either_side(void **state)
{
    (void)state;
    struct side *const of[2] = {&a, &b};
    memset(&lie, 0, sizeof lie);
    lie.pixel = PIXELS / 2 + WIDTH / 2;
    lie.field = PATH_T;
    lie.value = 0x80;
    for (size_t side = 0; side < 2; side++)
        assert_int_equal(side_draw(of[side], &picture.view, &reason), STATUS_OK);
    for (size_t turned = 0; turned < 2; turned++) {
        struct side *first = of[turned], *second = of[1 - turned];
        struct pair pair;
        size_t *pixel, count;
        if (pair_compare(first, second, &pair, &pixel, &count, &reason) ||
            pair_explain(first, second, &picture.view, oracle, pixel, count, &pair, &reason))
            fail_msg("%s", reason.text);
        const struct pixel_why *found = &pair.example[WHY_RENDERER][0];
        assert_true(pair.same_bits && pair.bounded && !pair_agrees(&pair));
        assert_int_equal(count, 1);
        assert_int_equal(pair.asked, 1);
        assert_int_equal(pair.why[WHY_RENDERER], 1);
        assert_int_equal(found->pixel, lie.pixel);
        assert_int_equal(found->field, PATH_T);
        assert_int_equal(found->segment, 0);
        assert_int_equal(found->apart, 0x80);
        assert_int_equal(found->why.side, 1 - turned);
        free(pixel);
    }
}

static void what_fails_is_told(void **state)
{
    (void)state;
    struct diff_walk walk;
    struct side_drawn drawn;
    memset(&lie, 0, sizeof lie);
    lie.status = STATUS_DEVICE;
    assert_int_equal(side_walk_pixel(&b, &picture.view, 0, &walk, &drawn, &reason), STATUS_DEVICE);
    assert_string_equal(reason.text, "the device is lost");
    walk_free(&walk);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_right_follows),
        cmocka_unit_test(every_lie_is_named_where_it_is),
        cmocka_unit_test(values_are_held_to_the_bound),
        cmocka_unit_test(values_beside_a_border_follow),
        cmocka_unit_test(pictures_are_held_to_it_on_either_side),
        cmocka_unit_test(what_fails_is_told),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
