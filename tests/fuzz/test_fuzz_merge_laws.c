/* Laws of merging folders of findings, by the bytes of all files: the order of the folders, and
 * what was merged before, do not matter; a folder merged with what it already gave adds nothing;
 * and what a merge counts and keeps is what the sets of findings have, made anew here. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz/findings/findings.h"
#include "ref/base/rng.h"
#include "ref/files/file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/fuzz/campaigns.h"

#define KINDS   5u
#define LOWEST  40u
#define BEYOND  340u
#define RAYS    2u /* rays on which a finding may be seen; the third is none */
#define PER_ONE (RAYS + 1)

/* Who found something: trials `first` to `end`, every `step`, each on some of its rays. */
struct finder {
    const char *name;
    uint64_t first, end, step;
    const char *opinion, *versions, *recipe;
    uint64_t shrinks; /* this trial is offered again with one ray; 0: none */
};

/* Each has trials that others have, too, with other words beside them; those that the first
 * has in common with the last are the first and the smallest of some signatures. */
static const struct finder finders[] = {
    {"f0", 40, 200, 1, "missed", "test 2", "of two", 0},
    {"f1", 120, 340, 1, "lost", "test 1", "of one", 150},
    {"f2", 42, 300, 3, "gone", "test 3", "of one", 0},
    {"f3", 41, 260, 2, "gone", "test 1", "of two", 241},
};

static bool is_seen(const struct finder *finder, uint64_t i, uint32_t ray)
{
    bool has = i >= finder->first && i < finder->end && (i - finder->first) % finder->step == 0;
    /* Most trials fail on one ray; some on several, and not each finder sees all. */
    return has && (ray == i % PER_ONE || (i % 4 == 0 && ray == finder->step % PER_ONE));
}

static uint32_t ray_of(uint32_t ray)
{
    return ray == RAYS ? FINDINGS_NO_RAY : ray;
}

static struct finding_file found(const struct finder *finder, uint64_t i)
{
    struct finding_file file = made(i);
    strcpy(file.versions, finder->versions);
    strcpy(file.trial.origin.recipe, finder->recipe);
    return file;
}

static void fill(const struct finder *finder)
{
    struct findings *findings;
    struct findings_news news;
    assert_int_equal(findings_open(in_root(finder->name), &findings, &reason), STATUS_OK);
    for (uint64_t i = finder->first; i < finder->end; i++)
        for (uint32_t ray = 0; ray < PER_ONE; ray++) {
            struct finding_file file = found(finder, i);
            if (is_seen(finder, i, ray))
                assert_int_equal(
                    findings_add(findings, &file, ray_of(ray), finder->opinion, &news, &reason),
                    STATUS_OK);
            finding_file_free(&file);
        }
    if (finder->shrinks) {
        struct finding_file file = found(finder, finder->shrinks);
        file.trial.ray_count = 1;
        assert_int_equal(findings_offer(findings, &file, &news, &reason), STATUS_OK);
        finding_file_free(&file);
    }
    assert_int_equal(findings_checkpoint(findings, "end", &reason), STATUS_OK);
    findings_close(findings);
}

/* Merges folders of the root, by their names with blanks between them, into another. */
static void merge_named(const char *to, const char *from)
{
    char text[200], paths[8][400];
    const char *folder[8];
    size_t count = 0;
    snprintf(text, sizeof text, "%s", from);
    for (char *rest = NULL, *name = strtok_r(text, " ", &rest); name;
         name = strtok_r(NULL, " ", &rest)) {
        snprintf(paths[count], sizeof paths[count], "%s/%s", root, name);
        folder[count] = paths[count];
        count++;
    }
    assert_merge(folder, count, in_root(to));
}

static void must_be_same(const char *a, const char *b)
{
    assert_same_folders(in_root(a), in_root(b), 1 + 3 * KINDS);
}

static size_t kind_of(uint64_t i)
{
    struct finding_file file = made(i);
    char text[FUZZ_SIGNATURE_MOST];
    size_t kind = 0;
    fuzz_signature_print(&file.signature, text);
    while (strcmp(text, names[kind]) != 0)
        kind++;
    finding_file_free(&file);
    return kind;
}

static int size_order(const struct finder *finder, uint64_t i, bool shrunk,
                      struct fuzz_trial_size *least)
{
    struct finding_file file = found(finder, i);
    file.trial.ray_count = shrunk ? 1 : file.trial.ray_count;
    struct fuzz_trial_size size = fuzz_trial_size(&file.trial);
    int order = least->triangles ? fuzz_trial_size_compare(&size, least) : -1;
    if (order < 0)
        *least = size;
    finding_file_free(&file);
    return order;
}

/* What the union of some finders has of one signature. */
struct union_wanted {
    uint64_t count, first;
    struct fuzz_trial_size smallest;
};

static struct union_wanted union_of(const char *from, size_t kind)
{
    struct union_wanted want = {.first = UINT64_MAX};
    for (uint64_t i = LOWEST; i < BEYOND; i++) {
        bool seen[PER_ONE] = {false};
        if (kind_of(i) != kind)
            continue;
        for (size_t f = 0; f < ARRAY_COUNT(finders); f++)
            for (uint32_t ray = 0; ray < PER_ONE && strstr(from, finders[f].name); ray++)
                if (is_seen(&finders[f], i, ray)) {
                    seen[ray] = true;
                    (void)size_order(&finders[f], i, false, &want.smallest);
                    if (finders[f].shrinks == i)
                        (void)size_order(&finders[f], i, true, &want.smallest);
                    want.first = i < want.first ? i : want.first;
                }
        for (uint32_t ray = 0; ray < PER_ONE; ray++)
            want.count += seen[ray];
    }
    return want;
}

static void must_be_the_union(const char *merged, const char *from)
{
    struct findings *findings = look(in_root(merged));
    assert_int_equal(findings_count(findings), KINDS);
    for (size_t kind = 0; kind < KINDS; kind++) {
        struct union_wanted want = union_of(from, kind);
        struct fuzz_signature signature;
        assert_int_equal(fuzz_signature_parse(names[kind], &signature, &reason), STATUS_OK);
        const struct findings_entry *entry = findings_find(findings, &signature);
        assert_non_null(entry);
        assert_int_equal(entry->count, want.count);
        assert_int_equal(entry->lines, want.count);
        assert_int_equal(entry->first.index, want.first);
        assert_int_equal(fuzz_trial_size_compare(&entry->smallest, &want.smallest), 0);
    }
    findings_close(findings);
}

/* Of one signature the lines are in the order of their trials, and of a trial in that of the rays;
 * those of no ray are last. */
static void must_be_in_order(const char *merged)
{
    char *text = NULL, *path = join_path(in_root(merged), "findings.jsonl"), *rest = NULL;
    size_t size = 0, same = 0;
    assert_int_equal(file_read(path, &text, &size, &reason), STATUS_OK);
    const char *last[KINDS] = {NULL};
    for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest))
        for (size_t kind = 0; kind < KINDS; kind++) {
            char key[FUZZ_SIGNATURE_MOST + 20];
            snprintf(key, sizeof key, "\"signature\":\"%s\"", names[kind]);
            if (!strstr(line, key) || !strstr(line, "\"index\":\""))
                continue;
            uint64_t at[2], ray[2];
            for (int k = 0; k < 2 && last[kind]; k++) {
                const char *of = k ? line : last[kind], *has = strstr(of, "\"ray\":");
                at[k] = strtoull(strstr(of, "\"index\":\"") + 9, NULL, 10);
                ray[k] = has ? strtoull(has + 6, NULL, 10) : UINT64_MAX;
            }
            assert_true(!last[kind] || at[0] < at[1] || (at[0] == at[1] && ray[0] < ray[1]));
            same += last[kind] && at[0] == at[1];
            last[kind] = line;
        }
    assert_true(same > 10);
    free(text);
    free(path);
}

static void merging_is_a_union(void **state)
{
    (void)state;
    for (size_t f = 0; f < ARRAY_COUNT(finders); f++)
        fill(&finders[f]);
    merge_named("all", "f0 f1 f2 f3");
    must_be_the_union("all", "f0 f1 f2 f3");
    must_be_in_order("all");
    /* Any order. */
    static const char *const order[] = {"f3 f2 f1 f0", "f1 f3 f0 f2"};
    for (size_t k = 0; k < ARRAY_COUNT(order); k++) {
        char name[20];
        snprintf(name, sizeof name, "order%zu", k);
        merge_named(name, order[k]);
        must_be_same("all", name);
    }
    /* Any brackets: merges of merges, on either side. */
    merge_named("01", "f0 f1");
    merge_named("10", "f1 f0");
    must_be_same("01", "10");
    must_be_the_union("01", "f0 f1");
    merge_named("32", "f3 f2");
    merge_named("01-32", "01 32");
    must_be_same("all", "01-32");
    merge_named("12", "f1 f2");
    merge_named("0-12", "f0 12");
    merge_named("0-12-3", "0-12 f3");
    must_be_same("all", "0-12-3");
    /* What is in it already changes nothing, in whatever form. */
    merge_named("again", "all");
    must_be_same("all", "again");
    merge_named("more", "all again f2 01");
    must_be_same("all", "more");
    merge_named("f0-f0", "f0");
    merge_named("f0-f0-f0", "f0 f0-f0");
    must_be_same("f0-f0", "f0-f0-f0");
}

/* Nothing found, by a campaign and by a merge of nothing. */
static void what_found_nothing_changes_nothing(void **state)
{
    (void)state;
    const struct finder none = {"none", 0, 0, 1, "", "", "", 0};
    fill(&none);
    merge_named("none-merged", "none");
    merge_named("with-none", "f0 none f1 none-merged");
    must_be_same("01", "with-none");
}

/* Of one signature the log has the lowest findings, as many as there are lines, in their order. */
static void must_have_the_lowest(const char *merged, uint64_t all)
{
    char *text = NULL, *path = join_path(in_root(merged), "findings.jsonl"),
         key[FUZZ_SIGNATURE_MOST];
    size_t size = 0, lines = 0;
    uint64_t next = 0;
    assert_int_equal(file_read(path, &text, &size, &reason), STATUS_OK);
    snprintf(key, sizeof key, "\"signature\":\"%s\"", names[0]);
    for (char *rest = NULL, *line = strtok_r(text, "\n", &rest); line;
         line = strtok_r(NULL, "\n", &rest)) {
        const char *index = strstr(line, "\"index\":\"");
        if (!strstr(line, key) || !index)
            continue;
        while (next < all && kind_of(next) != 0)
            next++;
        assert_int_equal(strtoull(index + 9, NULL, 10), next++);
        lines++;
    }
    assert_int_equal(lines, FINDINGS_LINES_MOST);
    free(text);
    free(path);
}

/* Of one signature there are more findings than lines, from the third shard on: those without a
 * line are counted, in a merge of merges as well. */
static void what_has_no_line_is_counted_through_every_merge(void **state)
{
    (void)state;
    static const char *const names_of[] = {"s0", "s1", "s2", "s3"};
    const uint64_t all = 3000;
    uint64_t want = 0;
    for (uint64_t i = 0; i < 4; i++) {
        struct findings *findings;
        struct findings_news news;
        assert_int_equal(findings_open(in_root(names_of[i]), &findings, &reason), STATUS_OK);
        for (uint64_t k = i; k < all; k += 4)
            assert_int_equal(add(findings, k, &news), STATUS_OK);
        assert_int_equal(findings_checkpoint(findings, "end", &reason), STATUS_OK);
        findings_close(findings);
    }
    merge_named("many", "s0 s1 s2 s3");
    merge_named("three", "s2 s0 s1");
    merge_named("three-one", "three s3");
    must_be_same("many", "three-one");
    merge_named("two", "s3 s2");
    merge_named("two-1", "s1 two");
    merge_named("two-1-0", "two-1 s0");
    must_be_same("many", "two-1-0");
    struct findings *findings = look(in_root("two-1-0"));
    for (size_t k = 0; k < findings_count(findings); k++)
        want += findings_entry(findings, k)->count;
    assert_int_equal(want, all);
    findings_close(findings);
    must_have_the_lowest("two-1-0", all);
}

/* A name may end in any number of slashes, and a folder be named with some. */
static void slashes_at_the_end_change_nothing(void **state)
{
    (void)state;
    static const char *const ends[] = {"", "/", "//", "/////"};
    static const char *const own[] = {"g0", "g1", "g2"};
    char to[30], from[80];
    for (size_t i = 0; i < ARRAY_COUNT(own); i++) {
        struct finder finder = finders[i];
        finder.name = own[i];
        fill(&finder);
    }
    for (size_t i = 0; i < ARRAY_COUNT(ends); i++) {
        const size_t other = (i + 1) % ARRAY_COUNT(ends);
        snprintf(to, sizeof to, "slashes%zu%s", i, ends[i]);
        snprintf(from, sizeof from, "g0%s g1%s g2", ends[i], ends[other]);
        merge_named(to, from);
        to[strlen("slashes0")] = '\0';
        must_be_same("slashes0", to);
    }
}

/* Lines that folders share count once each, those that the merge has no line for as well. */
static void what_is_shared_counts_once_beyond_the_lines(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        uint32_t first, end, more, last; /* two ranges of findings of one signature */
    } have[] = {{"o0", 0, 300, 1000, 1400}, {"o1", 400, 1400, 0, 0}, {"o2", 900, 1500, 300, 500}};
    const uint32_t distinct = 1500;
    uint64_t *of_kind = calloc(distinct, sizeof *of_kind), all = 0;
    assert_non_null(of_kind);
    for (uint32_t n = 0; n < distinct; all++)
        if (kind_of(all) == 0)
            of_kind[n++] = all;
    for (size_t i = 0; i < ARRAY_COUNT(have); i++) {
        struct findings *findings;
        struct findings_news news;
        assert_int_equal(findings_open(in_root(have[i].name), &findings, &reason), STATUS_OK);
        for (uint32_t n = 0; n < distinct; n++)
            if ((n >= have[i].first && n < have[i].end) || (n >= have[i].more && n < have[i].last))
                assert_int_equal(add(findings, of_kind[n], &news), STATUS_OK);
        assert_int_equal(findings_checkpoint(findings, "end", &reason), STATUS_OK);
        findings_close(findings);
    }
    merge_named("shared", "o0 o1 o2");
    merge_named("shared-other", "o2 o0 o1");
    char *one = join_path(root, "shared"), *other = join_path(root, "shared-other");
    assert_same_folders(one, other, 4); /* the log, and three files of the signature */
    free(one);
    free(other);
    struct findings *findings = look(in_root("shared"));
    assert_int_equal(findings_count(findings), 1);
    assert_int_equal(findings_entry(findings, 0)->count, distinct);
    assert_int_equal(findings_entry(findings, 0)->lines, FINDINGS_LINES_MOST);
    findings_close(findings);
    must_have_the_lowest("shared", all);
    free(of_kind);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(merging_is_a_union),
        cmocka_unit_test(what_found_nothing_changes_nothing),
        cmocka_unit_test(what_has_no_line_is_counted_through_every_merge),
        cmocka_unit_test(what_is_shared_counts_once_beyond_the_lines),
        cmocka_unit_test(slashes_at_the_end_change_nothing),
    };
    return cmocka_run_group_tests_name("fuzz_merge_laws", tests, make_root, remove_root);
}
