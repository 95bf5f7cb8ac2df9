/* Trials and maps of test_fuzz_gen_coverage.c; includes cmocka.h. */
#ifndef COVERAGE_FIXTURE_H
#define COVERAGE_FIXTURE_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include "fuzz/play/coverage.h"
#include "fuzz/play/coverage_bits.h"
#include "ref/base/rng.h"
#include <cmocka.h>
#include "tests/fuzz/fuzz_gen_trials.h"

static bool has(const uint64_t map[COVERAGE_WORDS], const char *name)
{
    char text[COVERAGE_NAME_MOST];
    for (uint32_t bit = 0; bit < COVERAGE_BITS; bit++)
        if (coverage_name(bit, text) && strcmp(text, name) == 0)
            return map[bit / 64] >> bit % 64 & 1;
    fail_msg("no bit is called %s", name);
    return false;
}

/* The names of all bits of a map, separated by blanks. */
static void print_map(const uint64_t map[COVERAGE_WORDS], char *text, size_t bytes)
{
    size_t used = 0;
    text[0] = '\0';
    for (uint32_t bit = 0; bit < COVERAGE_BITS; bit++) {
        char name[COVERAGE_NAME_MOST];
        if (map[bit / 64] >> bit % 64 & 1) {
            assert_true(coverage_name(bit, name));
            used += (size_t)snprintf(text + used, bytes - used, "%s%s", used ? " " : "", name);
            assert_true(used < bytes);
        }
    }
}

/* A trial of n copies of one triangle, corners (0,0,z), (x,0,z), (0,x,z). */
static struct fuzz_trial copies(uint32_t n, float x, float z, uint32_t leaf)
{
    struct fuzz_trial trial;
    assert_int_equal(fuzz_trial_make(3, n, 0, &trial, NULL), STATUS_OK);
    trial.scene.vertex[3] = trial.scene.vertex[7] = x;
    trial.scene.vertex[2] = trial.scene.vertex[5] = trial.scene.vertex[8] = z;
    for (uint32_t i = 0; i < 3 * n; i++)
        trial.scene.index[i] = i % 3;
    trial.build.leaf = leaf;
    return trial;
}

static void add_all(uint64_t map[COVERAGE_WORDS], const struct fuzz_trial *trial,
                    const char *layout)
{
    struct bvh bvh;
    struct packed packed;
    assert_int_equal(trial->builder->build(&trial->scene, &trial->build, &bvh, NULL), STATUS_OK);
    coverage_add_tree(map, trial, &bvh);
    if (packed_make(layout_find(layout), &bvh, &trial->scene, &packed, NULL)) {
        coverage_add_refusal(map, layout_find(layout), trial, &bvh);
    } else {
        coverage_add_packed(map, &packed);
        packed_free(&packed);
    }
    bvh_free(&bvh);
}

#endif
