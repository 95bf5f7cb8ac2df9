/* Baselines of known findings, and the waivers of the conformance suite (a first byte of 1). */
#define _POSIX_C_SOURCE 200809L
#include "fuzz/findings/baseline.h"
#include "tests/readers/reader_entry.h"

#include <stdlib.h>
#include <string.h>

static void must_answer(struct baseline *baseline)
{
    static const char *const signature[] = {"cpu.rtrs_rf.missed.rounded_inward",
                                            "vulkan.f32.crash.unexplained",
                                            "embree.none.phantom.outside"};
    for (size_t i = 0; i < ARRAY_COUNT(signature); i++) {
        struct fuzz_signature parsed;
        struct baseline_answer answer;
        struct reason reason = {""};
        if (fuzz_signature_parse(signature[i], &parsed, &reason))
            continue;
        baseline_ask(baseline, &parsed, "raydiff 0.1.0\nembree 4.3.3", "2026-01-31", &answer);
        READER_MUST(answer.state <= BASELINE_EXPIRED);
        READER_MUST((answer.state == BASELINE_NEW) == (answer.text[0] == '\0'));
    }
}

static bool play_baseline(const char *bytes, size_t size)
{
    struct baseline baseline = {0};
    struct fuzz_field field = {0};
    struct reason reason = {""};
    const char *path;
    enum status status = baseline_add(&baseline, "fuzz", bytes, size, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status)
        reader_must_be_reason(&reason);
    must_answer(&baseline);
    READER_MUST(!baseline_unused(&baseline, &field, "", &(size_t){0}, &path));
    baseline_close(&baseline);
    return status == STATUS_OK;
}

static bool play_waivers(const char *bytes, size_t size)
{
    struct waivers waivers;
    struct reason reason = {""};
    char *text = malloc(size + 1);
    READER_MUST(text);
    memcpy(text, bytes, size);
    text[size] = '\0';
    enum status status = waivers_parse("fuzz", text, size, false, &waivers, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status)
        reader_must_be_reason(&reason);
    for (size_t i = 0; i < waivers.count; i++) {
        READER_MUST(waivers.waiver[i].pattern[0] && waivers.waiver[i].reason[0] &&
                    waivers.waiver[i].link[0]);
        (void)waiver_judge(&waivers.waiver[i], true, "");
    }
    (void)waivers_note(&waivers, "sphere.cpu.f32.median.robust.mt", WAIVER_FAILED, "embree 4.3.3");
    waivers_free(&waivers);
    return status == STATUS_OK;
}

static bool play(const char *bytes, size_t size)
{
    if (size > 0 && bytes[0] == '\1')
        return play_waivers(bytes + 1, size - 1);
    return play_baseline(bytes, size);
}

const struct reader_entry reader_entry = {"baseline", 1 << 18, play};
