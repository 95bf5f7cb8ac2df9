/* Laws of fuzz_shrink_finding on real faults: what the generators find in layouts as published, and
 * in a peer with a planted bug, becomes a trial that a person can read and that shows the same when
 * somebody else plays it. */
#include "fuzz/gen/gen.h"
#include "ref/outside/pipe.h"
#include "fuzz/shrink/shrink.h"

#include <setjmp.h>
#include <stdarg.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRIALS_MOST 1500u
#define BYTES_MOST  4096u

static const struct engine_options engine_options = {.device = -1, .threads = 1};

static struct fuzz_player *open_player(const struct engine *engine, const struct layout *layout)
{
    struct fuzz_field field;
    struct fuzz_player *player = NULL;
    struct reason reason;
    if (fuzz_field_make(&engine, 1, &layout, 1, &engine_options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    return player;
}

static struct finding_file shrink(struct fuzz_player *player, const struct finding_file *file,
                                  struct shrink_stats *stats)
{
    const struct shrink_options options = {0};
    struct finding_file out;
    struct reason reason;
    if (fuzz_shrink_finding(player, file, &options, &out, stats, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(stats->end, SHRINK_FIXPOINT);
    return out;
}

/* What a player that was opened for this alone finds on the trial of a file. */
static void assert_shows(const struct engine *engine, const struct finding_file *file)
{
    struct fuzz_player *player = open_player(engine, file->signature.layout);
    struct fuzz_result result;
    struct reason reason;
    bool same = false;
    if (fuzz_play(player, &file->trial, 1, &result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < result.finding_count && !same; i++) {
        struct fuzz_finding finding = result.finding[i];
        assert_int_equal(fuzz_explain(player, &file->trial, &finding, &reason), STATUS_OK);
        same = fuzz_signature_same(&finding.signature, &file->signature);
    }
    fuzz_player_close(player);
    assert_true(same);
}

/* The text of a file, and that it can be read to the same trial. */
static void assert_readable(const struct finding_file *file)
{
    char *bytes;
    size_t size;
    struct finding_file again;
    struct reason reason;
    if (finding_file_print(file, &bytes, &size, &reason) ||
        finding_file_parse("shrunk", bytes, size, &again, &reason))
        fail_msg("%s", reason.text);
    assert_true(size < BYTES_MOST);
    assert_int_equal(fuzz_trial_hash(&again.trial), fuzz_trial_hash(&file->trial));
    finding_file_free(&again);
    free(bytes);
}

/* Shrinks a finding; it has then at most so many triangles and rays. */
static void check_shrunk(struct fuzz_player *player, const struct engine *engine,
                         const struct finding_file *file, uint32_t triangles, uint32_t rays)
{
    struct shrink_stats stats, again;
    struct finding_file out = shrink(player, file, &stats);
    char text[FUZZ_SIGNATURE_MOST];
    fuzz_signature_print(&file->signature, text);
    if (stats.after.triangles > triangles || stats.after.rays != rays || stats.after.bits > 120)
        fail_msg("%s: %u triangles, %u rays, %u bits", text, stats.after.triangles,
                 stats.after.rays, (unsigned)stats.after.bits);
    assert_true(fuzz_signature_same(&out.signature, &file->signature));
    assert_true(fuzz_signature_same(&stats.finding.signature, &file->signature));
    assert_true(rays == 0 || stats.finding.ray < out.trial.ray_count);
    assert_shows(engine, &out);
    assert_readable(&out);
    struct finding_file same = shrink(player, &out, &again);
    assert_int_equal(fuzz_trial_hash(&same.trial), fuzz_trial_hash(&out.trial));
    assert_int_equal(again.accepted, 0);
    printf("%-45s %3u triangles, %u rays, %4u bits, %4u asks\n", text, stats.after.triangles,
           stats.after.rays, (unsigned)stats.after.bits, (unsigned)stats.asks);
    finding_file_free(&same);
    finding_file_free(&out);
}

struct wanted {
    const char *signature;
    uint32_t triangles, rays; /* of what is left, at most and exactly */
    bool found;
};

/* Plays generated trials until every signature was found and shrunk. */
static void find_all(const char *engine_name, const char *layout_name, struct wanted *wanted,
                     size_t count)
{
    const struct gen_options options = {
        .triangles_least = 16, .triangles_most = 64, .rays = 200, .faithful = true};
    const struct engine *engine = engine_find(engine_name);
    struct fuzz_player *player = open_player(engine, layout_find(layout_name));
    size_t found = 0;
    for (uint64_t index = 0; index < TRIALS_MOST && found < count; index++) {
        struct finding_file file = {.has_signature = true};
        struct fuzz_result result;
        struct reason reason;
        if (gen_trial(5, index, &options, &file.trial, &reason))
            fail_msg("%s", reason.text);
        bool limit = file.trial.scene.tri_count > 1000;
        if (!limit && fuzz_play(player, &file.trial, 1, &result, NULL, NULL, &reason))
            fail_msg("%s", reason.text);
        for (size_t i = 0; !limit && i < result.finding_count; i++) {
            struct fuzz_finding *finding = &result.finding[i];
            char text[FUZZ_SIGNATURE_MOST];
            assert_int_equal(fuzz_explain(player, &file.trial, finding, &reason), STATUS_OK);
            file.signature = finding->signature;
            fuzz_signature_print(&file.signature, text);
            for (size_t k = 0; k < count; k++)
                if (!wanted[k].found && strcmp(text, wanted[k].signature) == 0) {
                    wanted[k].found = true;
                    found++;
                    check_shrunk(player, engine, &file, wanted[k].triangles, wanted[k].rays);
                }
        }
        fuzz_trial_free(&file.trial);
    }
    fuzz_player_close(player);
    for (size_t k = 0; k < count; k++)
        if (!wanted[k].found)
            fail_msg("%s was not found", wanted[k].signature);
}

static void faults_of_rtrs_rf(void **state)
{
    (void)state;
    struct wanted wanted[] = {
        {"cpu.rtrs_rf.missed.index_shifted", 2, 1, false},
        {"cpu.rtrs_rf.missed.rounded_inward", 2, 1, false},
        {"cpu.rtrs_rf.missed.half_overflow", 2, 1, false},
        {"cpu.rtrs_rf.missed.determinant_threshold", 2, 1, false},
        {"cpu.rtrs_rf.missed.cut_box", 2, 1, false},
        {"cpu.rtrs_rf.missed.slot_not_read", 20, 1, false}, /* leaves of 8 */
        {"cpu.rtrs_rf.missed.sentinel", 1, 1, false},
        {"cpu.rtrs_rf.tree.index_shifted", 2, 0, false},
    };
    find_all("cpu", "rtrs_rf", wanted, ARRAY_COUNT(wanted));
}

static void faults_of_rtrs_direct(void **state)
{
    (void)state;
    struct wanted wanted[] = {
        {"cpu.rtrs_direct.missed.wrong_item", 4, 1, false},
        {"cpu.rtrs_direct.missed.sentinel", 1, 1, false},
        {"cpu.rtrs_direct.missed.index_shifted", 2, 1, false},
        {"cpu.rtrs_direct.missed.determinant_threshold", 2, 1, false},
        {"cpu.rtrs_direct.tree.sentinel", 1, 0, false},
    };
    find_all("cpu", "rtrs_direct", wanted, ARRAY_COUNT(wanted));
}

static void faults_of_tests(void **state)
{
    (void)state;
    struct wanted wanted[] = {
        {"cpu.f32.missed.determinant_threshold", 1, 1, false},
        {"cpu.f32.missed.strict_comparison", 2, 1, false},
    };
    find_all("cpu", "f32", wanted, ARRAY_COUNT(wanted));
}

/* The sample tracer with a planted bug, beside this program. */
static const char *program;

static void a_peer_with_a_bug(void **state)
{
    (void)state;
    const struct gen_options options = {.triangles_least = 20, .triangles_most = 40, .rays = 100};
    const char *slash = strrchr(program, '/');
    char name[PIPE_NAME_MOST];
    const struct engine *engine;
    struct reason reason;
    snprintf(name, sizeof name, "pipe:%.*s/../samples/tracer_bug1",
             slash ? (int)(slash - program) : 1, slash ? program : ".");
    if (pipe_engine(name, &engine, &reason))
        fail_msg("%s", reason.text);
    struct fuzz_player *player = open_player(engine, NULL);
    bool found = false;
    for (uint64_t index = 0; index < 100 && !found; index++) {
        struct finding_file file = {.has_signature = true};
        struct fuzz_result result;
        if (gen_trial(5, index, &options, &file.trial, &reason) ||
            fuzz_play(player, &file.trial, 1, &result, NULL, NULL, &reason))
            fail_msg("%s", reason.text);
        if (result.finding_count > 0) {
            found = true;
            assert_int_equal(fuzz_explain(player, &file.trial, &result.finding[0], &reason),
                             STATUS_OK);
            file.signature = result.finding[0].signature;
            assert_string_equal(file.signature.engine, "pipe:tracer_bug1");
            check_shrunk(player, engine, &file, 2, 1);
        }
        fuzz_trial_free(&file.trial);
    }
    assert_true(found);
    fuzz_player_close(player);
}

/* Two rays are lost for two causes; the file says the cause of the second one. */
static void the_cause_behind_another_is_kept(void **state)
{
    (void)state;
    struct finding_file file, out;
    struct shrink_stats stats;
    struct reason reason;
    static const char text[] =
        "raydiff trial 1\n"
        "expect cpu.rtrs_rf_paper.missed.rounded_inward\n"
        "builder median leaf 4 eps 0.02\n"
        "box watertight\ntri mt\nquery closest\n"
        "vertices 6\n-100 -10 0\n-101 -10 0\n-100 -11 0\n"
        "0 0 0\n-0x1.4e2p+11 0x1.26p+10 0\n-0x1.4p+11 0 0\n"
        "triangles 2\n0 1 2\n3 4 5\n"
        "rays 2\n"
        "-100.25 -10.25 9 0 0 -1 0 inf\n" /* the sentinel hides the triangle */
        "-0x1.4e1p+11 0x1.25p+10 0x1p+11 0 0 -1 0 inf\nend\n";
    if (finding_file_parse("two", text, sizeof text - 1, &file, &reason))
        fail_msg("%s", reason.text);
    struct fuzz_player *player = open_player(engine_find("cpu"), file.signature.layout);
    out = shrink(player, &file, &stats);
    assert_int_equal(stats.after.rays, 1);
    assert_shows(engine_find("cpu"), &out);
    finding_file_free(&out);
    finding_file_free(&file);
    fuzz_player_close(player);
}

/* The signature of what is missed on one ray of a trial, played alone; false: nothing is. */
static bool missed_on(struct fuzz_player *player, const struct fuzz_trial *trial, uint32_t ray,
                      struct fuzz_signature *out)
{
    const struct fuzz_trial alone = fuzz_trial_rays_from(trial, ray, 1);
    struct fuzz_result result;
    struct reason reason;
    if (fuzz_play(player, &alone, 1, &result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < result.finding_count; i++)
        if (result.finding[i].signature.kind == fuzz_kind_of_wrong(WRONG_MISSED)) {
            assert_int_equal(fuzz_explain(player, &alone, &result.finding[i], &reason), STATUS_OK);
            *out = result.finding[i].signature;
            return true;
        }
    return false;
}

/* Asked of every cause in a trial, however many rays of other causes are before it: the ray that is
 * told is the first which shows it when it is played alone. Returns how many were behind two rays
 * of other causes, or more. */
static size_t rays_told(struct fuzz_player *player, const struct fuzz_trial *trial)
{
    const struct shrink_options options = {.asks = 1}; /* which nothing is smaller for */
    struct fuzz_signature shown[200];
    uint32_t ray[200];
    size_t count = 0, behind = 0;
    struct reason reason;
    for (uint32_t r = 0; r < trial->ray_count; r++) {
        ray[count] = r;
        count += missed_on(player, trial, r, &shown[count]);
    }
    for (size_t k = 0; k < count && k < 64; k++) {
        size_t first = 0;
        while (!fuzz_signature_same(&shown[first], &shown[k]))
            first++;
        if (first < k)
            continue;
        const struct finding_file file = {
            .trial = *trial, .has_signature = true, .signature = shown[k]};
        struct finding_file out;
        struct shrink_stats stats;
        assert_int_equal(fuzz_shrink_finding(player, &file, &options, &out, &stats, &reason),
                         STATUS_OK);
        assert_int_equal(stats.end, SHRINK_OUT_OF_ASKS);
        assert_int_equal(stats.finding.ray, ray[k]);
        behind += k > 1;
        fuzz_trial_free(&out.trial);
    }
    return behind;
}

static void the_ray_that_is_told_shows_it(void **state)
{
    (void)state;
    const struct gen_options options = {
        .triangles_least = 16, .triangles_most = 64, .rays = 200, .faithful = true};
    struct fuzz_player *player = open_player(engine_find("cpu"), layout_find("rtrs_rf"));
    size_t behind = 0;
    for (uint64_t index = 0; index < 60; index++) {
        struct fuzz_trial trial;
        struct reason reason;
        if (gen_trial(5, index, &options, &trial, &reason))
            fail_msg("%s", reason.text);
        if (trial.scene.tri_count < 1000 && trial.ray_count <= 200)
            behind += rays_told(player, &trial);
        fuzz_trial_free(&trial);
    }
    fuzz_player_close(player);
    assert_true(behind >= 5);
}

static void refuses_what_it_cannot_ask(void **state)
{
    (void)state;
    const struct shrink_options options = {0};
    struct fuzz_player *player = open_player(engine_find("cpu"), layout_find("f32"));
    struct finding_file file = {.has_signature = false}, out;
    struct shrink_stats stats;
    struct reason reason;
    if (fuzz_trial_make(3, 1, 1, &file.trial, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(fuzz_shrink_finding(player, &file, &options, &out, &stats, &reason),
                     STATUS_INPUT);
    assert_int_equal(fuzz_signature_parse("cpu.rf16.missed.cut_box", &file.signature, &reason),
                     STATUS_OK);
    file.has_signature = true;
    assert_int_equal(fuzz_shrink_finding(player, &file, &options, &out, &stats, &reason),
                     STATUS_INPUT);
    file.signature.layout = layout_find("f32");
    assert_int_equal(fuzz_shrink_finding(player, &file, &options, &out, &stats, &reason),
                     STATUS_OK);
    assert_int_equal(stats.end, SHRINK_NOT_SHOWN);
    assert_int_equal(fuzz_trial_hash(&out.trial), fuzz_trial_hash(&file.trial));
    finding_file_free(&out);
    finding_file_free(&file);
    fuzz_player_close(player);
}

int main(int argc, char **argv)
{
    (void)argc;
    program = argv[0];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faults_of_rtrs_rf),
        cmocka_unit_test(faults_of_rtrs_direct),
        cmocka_unit_test(faults_of_tests),
        cmocka_unit_test(a_peer_with_a_bug),
        cmocka_unit_test(the_cause_behind_another_is_kept),
        cmocka_unit_test(the_ray_that_is_told_shows_it),
        cmocka_unit_test(refuses_what_it_cannot_ask),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
