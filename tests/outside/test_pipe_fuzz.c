/* Laws of peers in fuzz/play/player.h: what ends a peer is a finding of its kind, with the ray; the
 * trial after it is played as if nothing had happened. The peers are this program
 * (tests/outside/peers.h).
 */
#define _GNU_SOURCE /* setenv, usleep */
#include "fuzz/gen/gen.h"
#include "fuzz/play/player.h"
#include "tests/outside/peers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <cmocka.h>

#define TRIALS 3

static const char *program;

static struct fuzz_player *open_peer(const char *what, uint32_t ms)
{
    char name[PIPE_NAME_MOST];
    const struct engine *engine;
    const struct engine_options options = {.peer_ms = ms, .peer_mb = UINT32_MAX};
    struct fuzz_field field;
    struct fuzz_player *player = NULL;
    struct reason reason = {""};
    assert_int_equal(setenv("PEER", what, 1), 0);
    snprintf(name, sizeof name, "pipe:%.100s --peer $PEER", program);
    if (pipe_engine(name, &engine, &reason) ||
        fuzz_field_make(&engine, 1, NULL, 0, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    return player;
}

/* Plays the same few trials; returns how many findings there were, the first of them in *out. */
static size_t play(const char *what, uint32_t ms, struct fuzz_finding *out, size_t *judged)
{
    const struct gen_options options = {.triangles_least = 20, .triangles_most = 30, .rays = 40};
    struct fuzz_player *player = open_peer(what, ms);
    struct fuzz_trial trial[TRIALS];
    struct fuzz_result result[TRIALS];
    struct reason reason = {""};
    size_t found = 0;
    *judged = 0;
    for (uint64_t i = 0; i < TRIALS; i++)
        assert_int_equal(gen_trial(1, i, &options, &trial[i], &reason), STATUS_OK);
    if (fuzz_play(player, trial, TRIALS, result, NULL, NULL, &reason))
        fail_msg("%s: %s", what, reason.text);
    for (size_t i = 0; i < TRIALS; i++) {
        if (result[i].finding_count && !found)
            *out = result[i].finding[0];
        found += result[i].finding_count;
        *judged += result[i].judged;
        fuzz_trial_free(&trial[i]);
    }
    fuzz_player_close(player);
    return found;
}

static void what_ends_a_peer_is_a_finding_and_play_goes_on(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        enum fuzz_kind kind;
        uint32_t ray;
    } cases[] = {
        {"dies", FUZZ_KIND_CRASH, 17},     {"crashes", FUZZ_KIND_CRASH, 0},
        {"exits", FUZZ_KIND_CRASH, 17},    {"hangs", FUZZ_KIND_HANG, 17},
        {"short", FUZZ_KIND_PROTOCOL, 0},  {"nan_id", FUZZ_KIND_PROTOCOL, 17},
        {"range", FUZZ_KIND_PROTOCOL, 17}, {"stderr_dies", FUZZ_KIND_CRASH, 0},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct fuzz_finding finding = {0};
        size_t judged;
        size_t found =
            play(cases[i].what, cases[i].kind == FUZZ_KIND_HANG ? 300 : 20000, &finding, &judged);
        if (found != TRIALS || finding.signature.kind != cases[i].kind ||
            finding.ray != cases[i].ray || judged != 0)
            fail_msg("%s: %zu findings, %s at ray %u, %zu judged", cases[i].what, found,
                     fuzz_kind_name(finding.signature.kind), (unsigned)finding.ray, judged);
        assert_string_equal(finding.signature.engine, "pipe:test_pipe_fuzz_--peer__PEER");
    }
}

static void an_honest_peer_is_judged_and_clean(void **state)
{
    (void)state;
    struct fuzz_finding finding = {0};
    size_t judged;
    size_t found = play("as_mt", 20000, &finding, &judged);
    if (found)
        fail_msg("%s", fuzz_kind_name(finding.signature.kind));
    assert_true(judged >= 100);
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--peer") == 0)
        return peer_main(argv[2]);
    program = argv[0];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_ends_a_peer_is_a_finding_and_play_goes_on),
        cmocka_unit_test(an_honest_peer_is_judged_and_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
