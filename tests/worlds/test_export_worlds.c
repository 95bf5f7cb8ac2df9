/* The right answers that an export of a world lists, as its text has them: each is right by the
 * judge, with the side that it names and no other; and what the judge takes is listed. */
#include "tests/gpu/exported.h"

#include "ref/base/rng.h"
#include "ref/judge/ray_triangle.h"

#include <float.h>

#define WORLDS         40
#define RAYS           12
#define INSTANCES_MOST 12
#define SIDES          2 /* 0: back, 1: front */

static struct reason reason;

/* A line of the text; prim is ABI_NO_PRIM of a miss. */
struct listed {
    uint32_t ray, prim;
    bool side[SIDES];
    float t[2];
};

/* Placed triangles are few: each is asked about for each ray. Some rays are out of contract. */
static struct finding_file world_file(uint64_t index)
{
    const struct gen_options options = {
        .triangles_least = 8, .triangles_most = 16, .rays = RAYS, .worlds = true};
    struct finding_file file = {0};
    if (gen_trial(23, index, &options, &file.trial, &reason))
        fail_msg("%s", reason.text);
    if (file.trial.world.instance_count > INSTANCES_MOST)
        file.trial.world.instance_count = INSTANCES_MOST;
    file.trial.ray[index % RAYS].org[index % 3] = index % 2 ? NAN : 0x1p50f;
    file.trial.ray[(index + 1) % RAYS].tmin = INFINITY;
    return file;
}

static uint32_t prim_at(const struct world *world, const uint32_t place[3])
{
    for (uint32_t prim = 0; prim < world_tri_count(world); prim++) {
        struct place is = world_place(world, prim);
        if (is.instance == place[0] && is.geometry == place[1] && is.tri == place[2])
            return prim;
    }
    fail_msg("instance %u has no geometry %u with triangle %u", place[0], place[1], place[2]);
    return 0;
}

/* False: it is no line of a right answer. */
static bool read_line(const char *line, const struct world *world, struct listed *out)
{
    uint32_t place[3];
    char side[16], rest[256];
    int used = 0;
    *out = (struct listed){.prim = ABI_NO_PRIM, .t = {-FLT_MAX, FLT_MAX}};
    if (sscanf(line, "# ray %u, right: %n", &out->ray, &used) != 1 || used == 0)
        return false;
    if (strncmp(line + used, "a miss\n", 7) == 0)
        return true;
    assert_int_equal(sscanf(line + used,
                            "instance %u, geometry %u, triangle %u, %15[a-z ], %255[^\n]",
                            &place[0], &place[1], &place[2], side, rest),
                     5);
    out->prim = prim_at(world, place);
    out->side[0] = strcmp(side, "front") != 0;
    out->side[1] = strcmp(side, "back") != 0;
    assert_true(!out->side[0] || !out->side[1] || strcmp(side, "either side") == 0);
    assert_true(sscanf(rest, "t in [%g, %g]", &out->t[0], &out->t[1]) == 2 ||
                strncmp(rest, "any t", 5) == 0);
    return true;
}

/* All lines; the caller frees them. */
static struct listed *read_text(const char *text, const struct world *world, size_t *count)
{
    struct listed *out = calloc(strlen(text) / 8 + 1, sizeof *out);
    assert_non_null(out);
    *count = 0;
    for (const char *line = text; *line; line += strcspn(line, "\n") + 1)
        *count += read_line(line, world, &out[*count]);
    return out;
}

/* u and v of the ray's point at t, seen along the axis on which the triangle is largest, or of a
 * point of the triangle near it. */
static struct hit hit_at(const struct export_case *the, uint32_t i, uint32_t prim, float t)
{
    float v[3][3];
    double b[3], c[3], p[3], best = 0, u = 0, w = 0;
    export_tri(the, prim, v);
    for (int k = 0; k < 3; k++) {
        b[k] = (double)v[1][k] - (double)v[0][k];
        c[k] = (double)v[2][k] - (double)v[0][k];
        p[k] =
            (double)the->ray[i].org[k] + (double)t * (double)the->ray[i].dir[k] - (double)v[0][k];
    }
    for (int k = 0; k < 3; k++) {
        int x = (k + 1) % 3, y = (k + 2) % 3;
        double area = b[x] * c[y] - b[y] * c[x];
        if (fabs(area) <= fabs(best))
            continue;
        best = area;
        u = (p[x] * c[y] - p[y] * c[x]) / area;
        w = (b[x] * p[y] - b[y] * p[x]) / area;
    }
    u = fmin(fmax(u, 0), 1);
    w = fmin(fmax(w, 0), 1 - u);
    return (struct hit){t, (float)u, (float)w, prim};
}

static struct judgement judged(const struct export_case *the, const struct judge *judge, uint32_t i,
                               const struct hit *hit, int side)
{
    struct judgement out;
    uint32_t tag = 0;
    if (hit->prim != ABI_NO_PRIM)
        tag = the->world->instance[world_instance_of(the->world, hit->prim)].custom |
              (side ? ABI_TAG_FRONT : 0);
    assert_int_equal(
        judge_world_answer(judge, &the->ray[i], the->mode[i], &the->truth[i], hit, tag, &out),
        STATUS_OK);
    return out;
}

static float between(const float t[2], int step)
{
    double lo = fmax((double)t[0], -1e30), hi = fmin((double)t[1], 1e30);
    return step == 0 ? t[0] : step == 4 ? t[1] : (float)(lo + (hi - lo) * step / 4);
}

/* Whether the text tells that the ray is out of contract. */
static bool is_out(const char *text, uint32_t i)
{
    char line[160];
    snprintf(line, sizeof line,
             "# ray %u is out of contract: a miss is right, and any hit of what mask, flags and "
             "filter let it meet, as the side that it sees\n",
             i);
    return strstr(text, line) != NULL;
}

/* What is listed is right as the sides that it names, whatever u and v (which the reader is to
 * compare with the ray's point), and as no other. */
static void check_listed(const struct export_case *the, const struct judge *judge,
                         const struct listed *one, size_t seen[4])
{
    if (one->prim == ABI_NO_PRIM) {
        const struct hit miss = {.prim = ABI_NO_PRIM};
        assert_int_not_equal(judged(the, judge, one->ray, &miss, 0).verdict, VERDICT_WRONG);
        return;
    }
    assert_true(one->side[0] || one->side[1]);
    seen[one->side[0] + 2 * one->side[1]]++;
    for (int step = 0; step < 5; step++)
        for (int side = 0; side < SIDES; side++) {
            struct hit hit = hit_at(the, one->ray, one->prim, between(one->t, step));
            struct judgement is = judged(the, judge, one->ray, &hit, side);
            bool right =
                is.verdict != VERDICT_WRONG || is.wrong == WRONG_BARYCENTRIC ||
                is.wrong == WRONG_INSTANCE; /* with its u and v: the custom index is right */
            if (right != one->side[side])
                fail_msg("ray %u, triangle %u, t %.9g, %s: listed as %s, by the judge %s %s",
                         one->ray, one->prim, (double)hit.t, side ? "front" : "back",
                         one->side[side] ? "right" : "not right", verdict_name(is.verdict),
                         is.verdict == VERDICT_WRONG ? wrong_name(is.wrong) : "");
        }
}

static bool has_lines(const struct listed *list, size_t count, uint32_t i)
{
    for (size_t k = 0; k < count; k++)
        if (list[k].ray == i)
            return true;
    return false;
}

static bool is_listed(const struct listed *list, size_t count, uint32_t i, const struct hit *hit,
                      int side)
{
    for (size_t k = 0; k < count; k++)
        if (list[k].ray == i && list[k].prim == hit->prim &&
            (hit->prim == ABI_NO_PRIM ||
             (list[k].side[side] && hit->t >= list[k].t[0] && hit->t <= list[k].t[1])))
            return true;
    return false;
}

/* Where the ray meets the triangle, or another t that some answer may have. */
static float some_t(const struct export_case *the, uint32_t i, uint32_t prim, int which,
                    struct rng *rng)
{
    struct oracle_pair pair;
    float v[3][3], t = the->ray[i].tmin;
    export_tri(the, prim, v);
    if (which < 2)
        t = (float)judge_plane_t(&the->ray[i], v);
    if (which < 2 && float_is_finite(t)) {
        oracle_pair(the->oracle, &the->ray[i], prim, &pair);
        t = oracle_is_hit(&pair) ? (float)(0.5 * (pair.t_lo + pair.t_hi)) : t;
    }
    if (which == 1)
        t = float_from_bits(float_bits(t) + rng_below(rng, 64) - 32);
    return float_is_finite(t) ? t : 0;
}

/* Of a ray that is out of contract anything is right but what mask, flags, filter and side rule
 * out. */
static size_t check_any(const struct export_case *the, const struct judge *judge, uint32_t i,
                        struct rng *rng)
{
    size_t taken = 0;
    for (uint32_t prim = 0; prim < world_tri_count(the->world); prim++)
        for (int which = 0; which < 3; which++)
            for (int side = 0; side < SIDES; side++) {
                struct hit hit = hit_at(the, i, prim, some_t(the, i, prim, which, rng));
                struct judgement is = judged(the, judge, i, &hit, side);
                bool ruled = is.wrong == WRONG_MASKED || is.wrong == WRONG_OPACITY ||
                             is.wrong == WRONG_CULLED || is.wrong == WRONG_FACING;
                assert_true(is.verdict == VERDICT_WRONG ? ruled
                                                        : is.verdict == VERDICT_OUT_OF_CONTRACT);
                taken += is.verdict != VERDICT_WRONG;
            }
    return taken;
}

/* What the judge takes is listed. */
static size_t check_taken(const struct export_case *the, const struct judge *judge, uint32_t i,
                          const struct listed *list, size_t count, struct rng *rng)
{
    const struct hit miss = {.prim = ABI_NO_PRIM};
    const struct judgement none = judged(the, judge, i, &miss, 0);
    size_t taken = 0;
    assert_true(has_lines(list, count, i) || none.verdict == VERDICT_OUT_OF_CONTRACT);
    if (!has_lines(list, count, i))
        return check_any(the, judge, i, rng);
    assert_int_equal(is_listed(list, count, i, &miss, 0), none.verdict != VERDICT_WRONG);
    for (uint32_t prim = 0; prim < world_tri_count(the->world); prim++)
        for (int which = 0; which < 3; which++)
            for (int side = 0; side < SIDES; side++) {
                struct hit hit = hit_at(the, i, prim, some_t(the, i, prim, which, rng));
                if (judged(the, judge, i, &hit, side).verdict == VERDICT_WRONG)
                    continue;
                taken++;
                if (!is_listed(list, count, i, &hit, side))
                    fail_msg("ray %u, triangle %u, t %.9g, %s: right, but not listed", i, prim,
                             (double)hit.t, side ? "front" : "back");
            }
    return taken;
}

static void what_is_listed_is_what_the_judge_takes(void **state)
{
    (void)state;
    size_t seen[4] = {0}, taken = 0, out = 0;
    struct rng rng = rng_make(6, 0);
    for (uint64_t index = 0; index < WORLDS; index++) {
        struct finding_file file = world_file(index);
        struct export_options options = options_of(EXPORT_TEXT, NULL, NULL);
        struct export_case the;
        struct judge *judge;
        size_t count;
        if (export_case_make(&file, &options, &the, &reason))
            fail_msg("%s", reason.text);
        char *text = exported(&file, &options, NULL);
        struct listed *list = read_text(text, the.world, &count);
        assert_int_equal(judge_make(the.oracle, &the.model, file.trial.query, &judge, &reason),
                         STATUS_OK);
        judge_by_bounds(judge, true);
        for (size_t k = 0; k < count; k++)
            check_listed(&the, judge, &list[k], seen);
        for (uint32_t i = 0; i < the.ray_count; i++) {
            out += is_out(text, i);
            taken += check_taken(&the, judge, i, list, count, &rng);
            assert_int_equal(is_out(text, i), !has_lines(list, count, i));
        }
        judge_free(judge);
        free(list);
        free(text);
        export_case_free(&the);
        finding_file_free(&file);
    }
    printf("%zu listed as back, %zu as front, %zu as either; %zu taken\n", seen[1], seen[2],
           seen[3], taken);
    assert_true(seen[1] > 100 && seen[2] > 100 && seen[3] > 5 && taken > 500 && out > 70);
}

/* --- one ray of several ----------------------------------------------------------------------- */

/* The lines that begin as told, without that; the caller frees them. */
static char *lines_of(const char *text, const char *begin)
{
    char *out = calloc(strlen(text) + 1, 1);
    assert_non_null(out);
    for (const char *line = text; *line; line += strcspn(line, "\n") + 1)
        if (strncmp(line, begin, strlen(begin)) == 0)
            strncat(out, line + strlen(begin), strcspn(line + strlen(begin), "\n") + 1);
    return out;
}

static void an_export_of_one_ray_is_its_part_of_all(void **state)
{
    (void)state;
    for (uint64_t index = 0; index < 12; index++) {
        struct finding_file file = world_file(index);
        struct export_options options = options_of(EXPORT_TEXT, NULL, NULL);
        char *all = exported(&file, &options, NULL), *rays = lines_of(all, "r "), *ray = rays;
        for (options.ray = 0; options.ray < RAYS; options.ray++) {
            char begin[40];
            snprintf(begin, sizeof begin, "# ray %u, right: ", options.ray);
            char *one = exported(&file, &options, NULL), *its = lines_of(one, "r ");
            char *right = lines_of(one, "# ray 0, right: "), *want = lines_of(all, begin);
            assert_string_equal(right, want);
            size_t length = strcspn(ray, "\n") + 1;
            assert_int_equal(strlen(its), length);
            assert_memory_equal(its, ray, length);
            ray += length;
            free(one);
            free(its);
            free(right);
            free(want);
        }
        assert_int_equal(*ray, '\0');
        free(all);
        free(rays);
        finding_file_free(&file);
    }
}

/* Of a scene: a ray has right answers, or any answer is right. */
static void a_ray_of_a_scene_has_right_answers_or_any(void **state)
{
    (void)state;
    struct finding_file file = corpus_file("bad-rays");
    struct export_options options = options_of(EXPORT_TEXT, NULL, NULL);
    uint32_t any = 0;
    options.engines.driver = NO_DRIVER;
    char *text = exported(&file, &options, NULL);
    for (uint32_t i = 0; i < file.trial.ray_count; i++) {
        char begin[80];
        snprintf(begin, sizeof begin, "\n# ray %u, right: ", i);
        bool listed = strstr(text, begin) != NULL;
        snprintf(begin, sizeof begin, "\n# ray %u is out of contract: any answer is right\n", i);
        assert_int_equal(strstr(text, begin) == NULL, listed);
        assert_int_equal(listed, ray_in_contract(&file.trial.ray[i]));
        any += !listed;
    }
    assert_true(any > 0);
    free(text);
    finding_file_free(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_listed_is_what_the_judge_takes),
        cmocka_unit_test(an_export_of_one_ray_is_its_part_of_all),
        cmocka_unit_test(a_ray_of_a_scene_has_right_answers_or_any),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
