/* What exported findings hold: right answers as the judge takes them, and the text of the program.
 */
#include "tests/gpu/exported.h"

#include "ref/base/rng.h"
#include "ref/trace/trace.h"
#include "ref/primitives/test_run.h"

static struct reason reason;

/* --- what is right --- */

/* A number some steps away, or anything. */
static float moved(struct rng *rng, float x)
{
    uint32_t choice = (uint32_t)(rng_u64(rng) >> 60);
    if (choice == 0)
        return x * 1.5f;
    uint32_t steps = (uint32_t)(rng_u64(rng) >> 32) % (choice < 8    ? 8u
                                                       : choice < 12 ? 256u
                                                                     : 65536u);
    return float_from_bits(float_bits(x) + (choice % 2 ? steps : -steps));
}

/* The middle of a right answer to any ray, one of its numbers moved to about an end. */
static struct hit some_answer(const struct export_case *the, struct rng *rng)
{
    const struct export_right *near = &the->right[rng_below(rng, (uint32_t)the->right_count)];
    uint32_t member = rng_below(rng, 3), end = rng_below(rng, 2);
    float number[3] = {0.5f * near->t[0] + 0.5f * near->t[1], 0.5f * near->u[0] + 0.5f * near->u[1],
                       0.5f * near->v[0] + 0.5f * near->v[1]};
    number[member] = moved(rng, member == 0   ? near->t[end]
                                : member == 1 ? near->u[end]
                                              : near->v[end]);
    if (near->prim == ABI_NO_PRIM)
        return (struct hit){.prim = ABI_NO_PRIM};
    return (struct hit){number[0], number[1], number[2], near->prim};
}

/* What a formula answers for a triangle whose vertices are moved by some steps; a miss if nothing.
 */
static struct hit near_answer(const struct export_case *the, uint32_t i, struct rng *rng)
{
    float v[3][3];
    struct hit hit;
    uint32_t prim = rng_below(rng, the->trial->scene.tri_count), most = 1 + rng_below(rng, 8);
    struct tri_ray made = tri_ray_make(&the->ray[i]);
    scene_tri(&the->trial->scene, prim, v);
    for (int k = 0; k < 9; k++)
        v[k / 3][k % 3] = float_from_bits(float_bits(v[k / 3][k % 3]) + rng_below(rng, most));
    hit.prim = prim;
    if (tri_test_run(rng_below(rng, 2) ? ABI_TRI_MT : ABI_TRI_WOOP, &made, v, &hit)) {
        hit.prim = prim;
        return hit;
    }
    return (struct hit){.prim = ABI_NO_PRIM};
}

/* Every answer that is tried is right by the list if and only if the judge takes it by its bounds.
 */
static size_t compare_with_the_judge(struct export_case *the, struct rng *rng, size_t taken[2])
{
    const struct fuzz_trial *trial = the->trial;
    struct judge *judge;
    size_t different = 0;
    assert_int_equal(judge_make(the->oracle, &the->model, trial->query, &judge, &reason),
                     STATUS_OK);
    judge_by_bounds(judge, true);
    for (uint32_t i = 0; i < the->ray_count; i++)
        for (int n = 0; n < (the->right_count ? 400 : 1); n++) {
            struct judgement judgement;
            struct hit hit = n ? some_answer(the, rng) : (struct hit){.prim = ABI_NO_PRIM};
            if (n % 8 == 7)
                hit.prim = rng_below(rng, trial->scene.tri_count);
            if (n % 2)
                hit = near_answer(the, i, rng);
            assert_int_equal(judge_answer(judge, &the->ray[i], &the->truth[i], &hit, &judgement),
                             STATUS_OK);
            bool takes = judgement.verdict != VERDICT_WRONG;
            if (!takes && export_is_followed(the)) /* u and v are for the program to look at */
                continue;
            taken[takes]++;
            if (takes == export_is_right(the, i, &hit))
                continue;
            different++;
            printf("ray %u: triangle %d at %.9g, %.9g, %.9g: %s by the judge\n", (unsigned)i,
                   (int)hit.prim, (double)hit.t, (double)hit.u, (double)hit.v,
                   verdict_name(judgement.verdict));
        }
    judge_free(judge);
    return different;
}

static void compare_trials(const char *const names[2], size_t taken[2])
{
    struct rng rng = rng_make(5, 0);
    for (uint64_t index = 0; index < 60; index++) {
        struct finding_file file = generated_file(index, 12, index % 3 ? QUERY_CLOSEST : QUERY_ANY);
        if (file.trial.scene.tri_count == 0) { /* which ray queries are not asked about */
            finding_file_free(&file);
            continue;
        }
        if (index % 7 == 0) /* ties, triangles without area, rays in planes */
            for (uint32_t i = 0; i < 12 && i < file.trial.scene.vertex_count; i++)
                file.trial.scene.vertex[3 * i + index % 3] = 0.0f;
        struct export_case the = make_case(&file, names[index % 2], "f32");
        size_t different = compare_with_the_judge(&the, &rng, taken);
        if (different)
            fail_msg("trial %u: %zu answers are judged otherwise", (unsigned)index, different);
        export_case_free(&the);
        finding_file_free(&file);
    }
    printf("%zu answers right, %zu not\n", taken[1], taken[0]);
}

static void right_is_what_the_judge_takes(void **state)
{
    (void)state;
    size_t taken[2] = {0, 0};
    compare_trials((const char *const[]){"vulkan", "vulkan_brute"}, taken);
    assert_true(taken[0] > 2000 && taken[1] > 2000);
}

/* Of an unknown formula: nothing that the judge takes is missing. */
static void nothing_right_is_missing(void **state)
{
    (void)state;
    size_t taken[2] = {0, 0};
    compare_trials((const char *const[]){"rayquery", "rayquery"}, taken);
    assert_true(taken[1] > 2000);
}

/* A triangle so thin that squares of its sides' products know no area. */
static void a_sliver_has_its_place(void **state)
{
    (void)state;
    static const float vertex[3][3] = {{-0x1.6e7604p-1f, -0x1.4a31e8p-1f, -0x1.fbfefp-3f},
                                       {0x1.b386f8p-2f, 0x1.06097p-2f, 0x1.8c034p-5f},
                                       {-0x1.e5a64cp-2f, -0x1.d12e88p-2f, -0x1.7b8a4p-3f}};
    struct finding_file file = generated_file(3, 1, QUERY_ANY);
    scene_free(&file.trial.scene);
    assert_int_equal(scene_make(3, 1, &file.trial.scene), STATUS_OK);
    memcpy(file.trial.scene.vertex, vertex, sizeof vertex);
    memcpy(file.trial.scene.index, (const uint32_t[]){0, 1, 2}, 12);
    file.trial.ray[0] = (struct ray){{-0x1.1a8604p-2f, -0x1.e37a06p-2f, -0x1.55cc88p+0f},
                                     0,
                                     {-0x1.46c324p-2f, -0x1.3d3c98p-4f, 0x1.1e53f4p+0f},
                                     INFINITY};
    struct export_case the = make_case(&file, "rayquery", NULL);
    assert_int_equal(the.truth[0].prim, 0);
    assert_true(export_is_right(&the, 0, &(struct hit){1.0f, 0x1.14f1cp-5f, 0x1.5c6ae8p-2f, 0}));
    export_case_free(&the);
    finding_file_free(&file);
}

/* Of an unknown formula the list says how far t may go, of Embree's any-hit only hit or miss. */
static void engines_without_a_formula_have_right_answers(void **state)
{
    (void)state;
    static const char *const names[] = {"rayquery", "embree", "embree_robust"};
    for (size_t e = 0; e < ARRAY_COUNT(names); e++)
        for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct finding_file file = generated_file(3 + e, 50, query);
            struct export_case the = make_case(&file, names[e], NULL);
            size_t hits = 0;
            for (uint32_t i = 0; i < the.ray_count; i++) {
                struct hit hit;
                trace_brute(&file.trial.scene, tri_test_find("woop"), query, &the.ray[i], &hit);
                if (export_is_unnamed(&the) && hit.prim != ABI_NO_PRIM)
                    hit = (struct hit){.prim = 0};
                hits += hit.prim != ABI_NO_PRIM;
                if (the.truth[i].tie_count <= 1 && the.truth[i].class == ORACLE_INSIDE &&
                    the.truth[i].margin > 0.01f)
                    assert_true(e > 0 || export_is_right(&the, i, &hit));
            }
            assert_true(hits > 10);
            export_case_free(&the);
            finding_file_free(&file);
        }
}

static void embree_is_not_asked_what_it_does_not_survive(void **state)
{
    (void)state;
    struct finding_file file = corpus_file("bad-rays");
    struct export_case the = make_case(&file, "embree", NULL);
    assert_true(the.left_out > 0 && the.ray_count > 0);
    assert_int_equal(the.left_out + the.ray_count, file.trial.ray_count);
    for (uint32_t i = 0; i < the.ray_count; i++)
        assert_memory_equal(&the.ray[i], &file.trial.ray[the.number[i]], sizeof(struct ray));
    export_case_free(&the);
    /* A finding that it dies has the ray that does it. */
    file.has_signature = true;
    file.signature = (struct fuzz_signature){.kind = FUZZ_KIND_CRASH, .cause = CAUSE_UNEXPLAINED};
    fuzz_signature_set_engine(&file.signature, "embree");
    the = make_case(&file, NULL, NULL);
    assert_int_equal(the.left_out, 0);
    assert_null(the.here);
    export_case_free(&the);
    finding_file_free(&file);
}

/* --- the program's text --- */

static bool has(const char *text, const char *part)
{
    return strstr(text, part) != NULL;
}

static void nothing_of_a_template_is_left(void **state)
{
    (void)state;
    static const char *const names[] = {"vulkan", "vulkan_brute", "rayquery", "embree",
                                        "embree_robust"};
    for (size_t e = 0; e < ARRAY_COUNT(names); e++)
        for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct finding_file file = generated_file(3, 2, query);
            struct export_options options = options_of(EXPORT_C, names[e], NULL);
            options.engines.driver = NO_DRIVER;
            char *program = exported(&file, &options, NULL);
            bool embree = strncmp(names[e], "embree", 6) == 0;
            assert_null(strstr(program, "EXPORT_"));
            assert_null(strstr(program, "#include \""));
            assert_int_equal(has(program, "RTC_SCENE_FLAG_ROBUST);"),
                             strcmp(names[e], "embree_robust") == 0);
            assert_int_equal(has(program, "rayQuery = VK_TRUE"), strcmp(names[e], "rayquery") == 0);
            assert_int_equal(has(program, "#if EMBREE == 4\n"), embree); /* the program's own */
            assert_int_equal(has(program, "rtcOccluded1"), embree && query == QUERY_ANY);
            free(program);
            finding_file_free(&file);
        }
}

static void what_was_not_asked_is_said(void **state)
{
    (void)state;
    struct finding_file file = corpus_file("sentinel");
    struct export_options options = options_of(EXPORT_C, "vulkan", NULL);
    struct export_said said;
    options.engines.driver = NO_DRIVER;
    char *program = exported(&file, &options, &said);
    assert_non_null(strstr(said.text, "not run here: "));
    assert_non_null(strstr(program, "it was not run where this file was written"));
    assert_non_null(strstr(program, "that Vulkan's specification asks for"));
    assert_non_null(strstr(program, cause_text(CAUSE_SENTINEL)));
    free(program);
    options.ray = 1;
    FILE *to = fopen("/dev/null", "w");
    assert_non_null(to);
    assert_int_equal(export_write(&file, &options, to, &said, &reason), STATUS_INPUT);
    fclose(to);
    finding_file_free(&file);
}

static void what_shows_no_answer_is_refused(void **state)
{
    (void)state;
    static const enum fuzz_kind kinds[] = {FUZZ_KIND_TREE, FUZZ_KIND_REFUSED, FUZZ_KIND_PROTOCOL};
    struct finding_file file = corpus_file("sentinel");
    struct export_options options = options_of(EXPORT_C, NULL, NULL);
    struct export_said said;
    FILE *to = fopen("/dev/null", "w");
    assert_non_null(to);
    for (size_t i = 0; i < ARRAY_COUNT(kinds); i++) {
        file.signature.kind = kinds[i];
        fuzz_signature_set_engine(&file.signature, "vulkan");
        assert_int_equal(export_write(&file, &options, to, &said, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "raydiff replay"));
    }
    fclose(to);
    finding_file_free(&file);
}

/* --- which rays --- */

/* Ray k of what is exported is ray number[k] of the file, bit by bit; the text names it where the
 * two are not the same. What Embree does not promise to survive is left out of its own. */
static void check_rays(const struct finding_file *file, const char *engine, uint32_t only,
                       size_t *left_out)
{
    struct export_options options = options_of(EXPORT_C, engine, NULL);
    struct export_case the;
    const struct fuzz_trial *trial = &file->trial;
    uint32_t at = 0;
    options.ray = only;
    options.engines.driver = NO_DRIVER;
    if (export_case_make(file, &options, &the, &reason))
        fail_msg("%s", reason.text);
    char *text = exported(file, &options, NULL);
    for (uint32_t i = 0; i < trial->ray_count; i++) {
        char line[60];
        bool taken = (only == EXPORT_ALL_RAYS || only == i) &&
                     (strncmp(engine, "embree", 6) != 0 || ray_in_contract(&trial->ray[i]));
        snprintf(line, sizeof line, "    /* ray %u of the finding */\n", (unsigned)i);
        assert_int_equal(strstr(text, line) != NULL, taken && at != i);
        if (!taken)
            continue;
        assert_true(at < the.ray_count);
        assert_int_equal(the.number[at], i);
        assert_memory_equal(&the.ray[at], &trial->ray[i], sizeof(struct ray));
        at++;
    }
    assert_int_equal(the.ray_count, at);
    assert_int_equal(the.left_out, only == EXPORT_ALL_RAYS ? trial->ray_count - at : 0);
    *left_out += the.left_out;
    free(text);
    export_case_free(&the);
}

static void rays_keep_the_numbers_of_the_file(void **state)
{
    (void)state;
    struct finding_file file = generated_file(1, 9, QUERY_CLOSEST);
    size_t left_out = 0;
    file.trial.ray[1].org[0] = file.trial.ray[4].dir[2] = file.trial.ray[5].org[1] = 0x1p50f;
    for (uint32_t only = 0; only <= file.trial.ray_count; only++) {
        uint32_t ray = only < file.trial.ray_count ? only : EXPORT_ALL_RAYS;
        check_rays(&file, "vulkan", ray, &left_out);
        check_rays(&file, "vulkan_brute", ray, &left_out);
        assert_int_equal(left_out, 0);
    }
    if (engine_find("embree"))
        for (uint32_t only = 0; only <= file.trial.ray_count; only++)
            if (only == file.trial.ray_count || ray_in_contract(&file.trial.ray[only]))
                check_rays(&file, "embree", only < file.trial.ray_count ? only : EXPORT_ALL_RAYS,
                           &left_out);
    assert_true(!engine_find("embree") || left_out >= 3);
    struct export_options options = options_of(EXPORT_C, "vulkan", NULL);
    struct export_case the;
    options.ray = file.trial.ray_count;
    assert_int_equal(export_case_make(&file, &options, &the, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "there is no ray 9: the file has 9");
    finding_file_free(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(right_is_what_the_judge_takes),
        cmocka_unit_test(nothing_right_is_missing),
        cmocka_unit_test(a_sliver_has_its_place),
        cmocka_unit_test(engines_without_a_formula_have_right_answers),
        cmocka_unit_test(embree_is_not_asked_what_it_does_not_survive),
        cmocka_unit_test(nothing_of_a_template_is_left),
        cmocka_unit_test(what_was_not_asked_is_said),
        cmocka_unit_test(what_shows_no_answer_is_refused),
        cmocka_unit_test(rays_keep_the_numbers_of_the_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
