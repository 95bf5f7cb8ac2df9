/* Whole pictures explained: all pixels at once are the sum of each alone, in either order, and what
 * is wrong is excused of the side that is as published. RTRS's tree loses hits that brute finds. */
#include "scenes/render/diff_engines.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/pictures.h"

#include <math.h>

#define WIDTH  96u
#define HEIGHT 72u

static struct picture picture;
static struct side side[2]; /* RTRS's tree; every triangle, by another test */
static struct oracle *oracle;
static struct reason reason;

static int begin(void **state)
{
    (void)state;
    const struct engine_options options = {.threads = 2, .device = -1};
    const struct look look = {.profile = PROFILE_RTRS, .bounces = 4};
    picture = picture_make("rtrs", look, WIDTH, HEIGHT);
    picture_settle(&picture);
    struct frame_job other = picture.job;
    other.job.packed = NULL;
    other.job.tri = tri_test_find("mt");
    if (side_open(engine_find("cpu"), &options, &picture.job, false, &side[0], &reason) ||
        side_open(engine_find("brute"), &options, &other, false, &side[1], &reason) ||
        oracle_make(&picture.scene, &oracle, &reason) ||
        side_draw(&side[0], &picture.view, &reason) || side_draw(&side[1], &picture.view, &reason))
        fail_msg("%s", reason.text);
    return 0;
}

static int end(void **state)
{
    (void)state;
    side_close(&side[0]);
    side_close(&side[1]);
    oracle_free(oracle);
    picture_free(&picture);
    return 0;
}

static size_t compare(unsigned first, struct pair *pair, size_t **pixel)
{
    size_t count;
    if (pair_compare(&side[first], &side[1 - first], pair, pixel, &count, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(pair->asked, count);
    return count;
}

static void explain(unsigned first, const size_t *pixel, size_t count, struct pair *pair)
{
    if (pair_explain(&side[first], &side[1 - first], &picture.view, oracle, pixel, count, pair,
                     &reason))
        fail_msg("%s", reason.text);
}

static void all_are_the_sum_of_each(void **state)
{
    (void)state;
    for (unsigned first = 0; first < 2; first++) {
        static struct pair all, parts;
        size_t *pixel, count = compare(first, &all, &pixel), sum = 0, allowed = 0;
        size_t why[WHY_COUNT] = {0}, verdict[VERDICT_COUNT] = {0};
        double over = 0;
        parts = all;
        explain(first, pixel, count, &all);
        explain(first, pixel, count / 3, &parts);
        explain(first, pixel + count / 3, count - count / 3, &parts);
        assert_memory_equal(all.why, parts.why, sizeof all.why);
        assert_memory_equal(all.verdict, parts.verdict, sizeof all.verdict);
        assert_true(all.over == parts.over);
        for (size_t i = 0; i < count; i++) {
            static struct pair one;
            memset(&one, 0, sizeof one);
            explain(first, &pixel[i], 1, &one);
            for (enum why k = WHY_SAME; k < WHY_COUNT; k++) {
                const struct pixel_why *found = &one.example[k][0], *kept;
                if (one.why[k] == 0)
                    continue;
                assert_int_equal(one.why[k], 1);
                assert_int_equal(found->pixel, pixel[i]);
                if (why[k] < PAIR_KEPT) { /* the first ones are kept, in order */
                    kept = &all.example[k][why[k]];
                    assert_true(kept->pixel == pixel[i] && kept->apart == found->apart);
                    assert_true(kept->field == found->field && kept->segment == found->segment);
                    assert_true(kept->why.side == found->why.side);
                }
                verdict[found->why.verdict] += k == WHY_ALLOWED;
                over = fmax(over, found->why.over);
                why[k]++;
                sum++;
            }
        }
        for (enum verdict k = VERDICT_RIGHT; k < VERDICT_COUNT; k++)
            allowed += all.verdict[k];
        assert_memory_equal(all.why, why, sizeof why);
        assert_memory_equal(all.verdict, verdict, sizeof verdict);
        assert_true(sum == count && all.over == over && over > 0);
        assert_int_equal(allowed, all.why[WHY_ALLOWED]);
        assert_int_equal(all.verdict[VERDICT_RIGHT], 0);
        assert_true(all.why[WHY_WRONG] > 4);
        free(pixel);
    }
}

static void what_is_published_is_excused(void **state)
{
    (void)state;
    for (unsigned first = 0; first < 2; first++)
        for (unsigned published = 0; published < 4; published++) {
            static struct pair pair;
            size_t *pixel, count = compare(first, &pair, &pixel);
            side[0].published = published & 1;
            side[1].published = published >> 1;
            explain(first, pixel, count, &pair);
            bool excused = side[0].published; /* brute is right */
            assert_int_equal(pair.why[WHY_PUBLISHED] > 4, excused);
            assert_int_equal(pair.why[WHY_WRONG] > 4, !excused);
            assert_int_equal(pair.why[WHY_PUBLISHED] * pair.why[WHY_WRONG], 0);
            assert_int_equal(pair_agrees(&pair), excused);
            assert_int_equal(pair.example[excused ? WHY_PUBLISHED : WHY_WRONG][0].why.side, first);
            free(pixel);
        }
    side[0].published = side[1].published = false;
}

/* Sides agree if every pixel asked for is explained by no fault, and, where the same bits are
 * demanded, no path is apart and no value exceeds the bound, if there is one. */
static void a_pair_agrees_without_a_fault(void **state)
{
    (void)state;
    for (unsigned look = 0; look < 16; look++)
        for (int why = -1; why < WHY_COUNT; why++) /* -1: no pixel was asked for */
            for (size_t unexplained = 0; unexplained < 3; unexplained++) {
                const bool same = look & 1, bounded = look & 2, apart = look & 4, over = look & 8;
                static struct pair pair;
                pair = (struct pair){.same_bits = same, .bounded = bounded};
                pair.diff.paths_apart = apart;
                pair.diff.excess = over;
                pair.asked = (size_t)(3 * (why >= 0)) + unexplained;
                if (why >= 0)
                    pair.why[why] = 3;
                const bool fault =
                    why == WHY_RENDERER || why == WHY_WRONG || why == WHY_UNEXPLAINED;
                const bool bits = same && (apart || (bounded && over));
                assert_int_equal(pair_agrees(&pair), !fault && !bits && unexplained == 0);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_are_the_sum_of_each),
        cmocka_unit_test(what_is_published_is_excused),
        cmocka_unit_test(a_pair_agrees_without_a_fault),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
