/* A made-up campaign that fills folders of findings, and their comparison. Include after cmocka.h
 * and after fuzz/findings/findings.h, ref/base/rng.h and ref/files/file.h; needs _GNU_SOURCE. */
#ifndef TESTS_CAMPAIGNS_H
#define TESTS_CAMPAIGNS_H

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/root.h"

static struct reason reason;

static inline const char *in_root(const char *name)
{
    static char path[8][400];
    static int next;
    next = (next + 1) % 8;
    snprintf(path[next], sizeof path[next], "%s/%s", root, name);
    return path[next];
}

static const char *const names[] = {"cpu.rf16.missed.rounded_inward", "cpu.rf16.missed.stack",
                                    "vulkan.rtrs_rf.phantom.shader", "pipe:a.b.-.crash.unexplained",
                                    "cpu.rf16.triangle.index_truncated"};

#define BATCH 10

/* Finding i of a campaign: a pure function of i. */
static inline struct finding_file made(uint64_t i)
{
    struct rng rng = rng_make(7, i);
    struct finding_file file = {.has_signature = true};
    struct fuzz_trial *trial = &file.trial;
    uint32_t kind = rng_below(&rng, 10), triangles = 1 + rng_below(&rng, 12);
    if (fuzz_trial_make(3, triangles, 2, trial, &reason) ||
        fuzz_signature_parse(names[kind < 6 ? 0 : kind - 5], &file.signature, &reason))
        abort();
    for (int k = 0; k < 9; k++)
        trial->scene.vertex[k] = rng_range(&rng, -1, 1);
    for (uint32_t k = 0; k < 3 * triangles; k++)
        trial->scene.index[k] = rng_below(&rng, 3);
    trial->ray[1].dir[2] = rng_range(&rng, -1, 1);
    trial->origin = (struct fuzz_origin){.seed = UINT64_MAX, .index = i, .version = 1};
    snprintf(trial->origin.recipe, sizeof trial->origin.recipe, "number %llu",
             (unsigned long long)i);
    strcpy(file.versions, "test 1");
    return file;
}

static inline enum status add(struct findings *findings, uint64_t i, struct findings_news *news)
{
    struct finding_file file = made(i);
    enum status status = findings_add(findings, &file, i % 2 ? 1 : FINDINGS_NO_RAY,
                                      "missed \"it\"\n\x80", news, &reason);
    finding_file_free(&file);
    return status;
}

/* The findings of `first` + k * `step` below `end`, in batches; goes on where the folder says. */
static inline int campaign(const char *folder, uint64_t first, uint64_t step, uint64_t end)
{
    struct findings *findings;
    struct findings_news news;
    if (findings_open(folder, &findings, &reason))
        return 1;
    uint64_t at = strtoull(findings_state(findings), NULL, 10);
    for (at = at ? at : first; at < end;) {
        char state[32];
        for (int k = 0; k < BATCH && at < end; k++, at += step)
            if (add(findings, at, &news))
                return 2;
        snprintf(state, sizeof state, "%llu", (unsigned long long)at);
        if (findings_checkpoint(findings, state, &reason))
            return 3;
    }
    findings_close(findings);
    return 0;
}

static inline void assert_campaign(const char *folder, uint64_t first, uint64_t step, uint64_t end)
{
    int code = campaign(folder, first, step, end);
    if (code)
        fail_msg("%d: %s", code, reason.text);
}

static inline struct findings *look(const char *folder)
{
    struct findings *findings;
    reason.text[0] = '\0';
    if (findings_look(folder, &findings, &reason))
        fail_msg("%s", reason.text);
    return findings;
}

/* The caller frees it. */
static inline char *join_path(const char *folder, const char *name)
{
    char *path = NULL;
    if (asprintf(&path, "%s/%s", folder, name) < 0)
        abort();
    return path;
}

static inline size_t compare_folders(const char *a, const char *b)
{
    DIR *listing = opendir(a);
    assert_non_null(listing);
    size_t files = 0;
    struct dirent *one;
    while ((one = readdir(listing)) != NULL) {
        char *left = NULL, *right = NULL;
        size_t left_size = 0, right_size = 0;
        struct stat about;
        if (one->d_name[0] == '.')
            continue;
        char *x = join_path(a, one->d_name), *y = join_path(b, one->d_name);
        assert_int_equal(stat(x, &about), 0);
        if (S_ISDIR(about.st_mode)) {
            files += compare_folders(x, y);
            free(x);
            free(y);
            continue;
        }
        if (file_read(x, &left, &left_size, &reason) || file_read(y, &right, &right_size, &reason))
            fail_msg("%s", reason.text);
        if (left_size != right_size || memcmp(left, right, left_size) != 0)
            fail_msg("%s and %s differ", x, y);
        free(left);
        free(right);
        free(x);
        free(y);
        files++;
    }
    closedir(listing);
    return files;
}

static inline void assert_same_folders(const char *a, const char *b, size_t files)
{
    assert_int_equal(compare_folders(a, b), files);
    assert_int_equal(compare_folders(b, a), files);
}

static inline void assert_merge(const char *const *folder, size_t count, const char *to)
{
    if (findings_merge(folder, count, to, &reason))
        fail_msg("%s", reason.text);
}

#endif
