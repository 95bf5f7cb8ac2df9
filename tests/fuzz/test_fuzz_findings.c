/* Folders of findings: what is kept, counted and refused. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz/campaign/campaign_inner.h"
#include "ref/base/rng.h"
#include "ref/files/file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/fuzz/campaigns.h"

/* What the files of an entry hold, of the trials made(0) to made(199). */
static void holds_files(struct findings *findings, const struct fuzz_signature *signature,
                        const struct findings_entry *entry, uint64_t count)
{
    struct finding_file best = {0}, first = {0};
    for (uint64_t i = 0; i < 200; i++) {
        struct finding_file file = made(i);
        struct fuzz_trial_size size = fuzz_trial_size(&file.trial);
        if (fuzz_signature_same(&file.signature, signature)) {
            assert_true(fuzz_trial_size_compare(&entry->smallest, &size) <= 0);
            assert_true(entry->first.index <= i);
        }
        finding_file_free(&file);
    }
    char path[400], *text, want[40];
    size_t size;
    findings_path(findings, signature, "first.trial", path, sizeof path);
    assert_int_equal(finding_file_read(path, &first, &reason), STATUS_OK);
    assert_int_equal(first.trial.origin.index, entry->first.index);
    findings_path(findings, signature, "smallest.trial", path, sizeof path);
    assert_int_equal(finding_file_read(path, &best, &reason), STATUS_OK);
    assert_int_equal(fuzz_trial_hash(&best.trial), entry->smallest.hash);
    findings_path(findings, signature, "count", path, sizeof path);
    assert_int_equal(file_read(path, &text, &size, &reason), STATUS_OK);
    snprintf(want, sizeof want, "%llu\n", (unsigned long long)count);
    assert_string_equal(text, want);
    free(text);
    finding_file_free(&first);
    finding_file_free(&best);
}

static void a_folder_keeps_first_smallest_and_count(void **state)
{
    (void)state;
    struct findings *findings;
    struct findings_news news;
    const char *folder = in_root("plain");
    struct fuzz_signature signature;
    assert_int_equal(findings_open(folder, &findings, &reason), STATUS_OK);
    assert_string_equal(findings_state(findings), "");
    assert_int_equal(findings_count(findings), 0);
    uint64_t count[5] = {0};
    size_t signatures = 0;
    for (uint64_t step = 0; step <= 200;
         step++) { /* the lowest last, but for one that is behind all */
        uint64_t i = step < 200 ? 199 - step : step;
        struct finding_file file = made(i);
        assert_int_equal(add(findings, i, &news), STATUS_OK);
        assert_false(news.repeated);
        assert_true(news.first == (step < 200));
        signatures += news.signature;
        for (size_t k = 0; k < 5; k++) {
            assert_int_equal(fuzz_signature_parse(names[k], &signature, &reason), STATUS_OK);
            count[k] += fuzz_signature_same(&signature, &file.signature);
        }
        finding_file_free(&file);
        assert_int_equal(add(findings, i, &news), STATUS_OK);
        assert_true(news.repeated);
        assert_false(news.first || news.smallest || news.signature);
    }
    assert_int_equal(signatures, 5);
    assert_int_equal(findings_checkpoint(findings, "here", &reason), STATUS_OK);
    findings_close(findings);
    findings = look(folder);
    assert_string_equal(findings_state(findings), "here");
    assert_int_equal(findings_count(findings), 5);
    for (size_t k = 0; k < 5; k++) {
        assert_int_equal(fuzz_signature_parse(names[k], &signature, &reason), STATUS_OK);
        const struct findings_entry *entry = findings_find(findings, &signature);
        assert_non_null(entry);
        assert_int_equal(entry->count, count[k]);
        assert_int_equal(entry->lines, count[k]);
        assert_true(entry->has_first && entry->has_smallest);
        holds_files(findings, &signature, entry, count[k]);
    }
    findings_close(findings);
}

static void a_shrunk_trial_replaces_the_smallest_and_counts_nothing(void **state)
{
    (void)state;
    struct findings *findings;
    struct findings_news news;
    struct finding_file file = made(3);
    char text[40];
    assert_int_equal(findings_open(in_root("shrunk"), &findings, &reason), STATUS_OK);
    assert_int_equal(findings_offer(findings, &file, &news, &reason), STATUS_INPUT);
    assert_int_equal(findings_add(findings, &file, 0, "", &news, &reason), STATUS_OK);
    assert_true(news.signature && news.first && news.smallest);
    assert_int_equal(findings_add(findings, &file, 2, "", &news, &reason), STATUS_INPUT);
    assert_int_equal(findings_add(findings, &file, 5, "", &news, &reason), STATUS_INPUT);
    snprintf(text, sizeof text, ": ray 5 of %u", file.trial.ray_count);
    assert_non_null(strstr(reason.text, text));
    assert_int_equal(findings_offer(findings, &file, &news, &reason), STATUS_OK);
    assert_false(news.smallest);
    file.trial.ray_count = 1;
    assert_int_equal(findings_offer(findings, &file, &news, &reason), STATUS_OK);
    assert_true(news.smallest && !news.first && !news.signature);
    assert_int_equal(findings_find(findings, &file.signature)->count, 1);
    file.has_signature = false;
    assert_int_equal(findings_add(findings, &file, 0, "", &news, &reason), STATUS_INPUT);
    finding_file_free(&file);
    findings_close(findings);
}

/* Beyond the most lines only the number is kept, and it survives. */
static void many_findings_are_counted_not_listed(void **state)
{
    (void)state;
    const char *folder = in_root("many");
    assert_campaign(folder, 0, 1, 2500);
    struct findings *findings = look(folder);
    struct fuzz_signature signature;
    assert_int_equal(fuzz_signature_parse(names[0], &signature, &reason), STATUS_OK);
    const struct findings_entry *entry = findings_find(findings, &signature);
    uint64_t want = 0, all = 0;
    for (uint64_t i = 0; i < 2500; i++) {
        struct finding_file file = made(i);
        want += fuzz_signature_same(&file.signature, &signature);
        finding_file_free(&file);
    }
    assert_true(want > FINDINGS_LINES_MOST);
    assert_int_equal(entry->count, want);
    assert_int_equal(entry->lines, FINDINGS_LINES_MOST);
    for (size_t i = 0; i < findings_count(findings); i++)
        all += findings_entry(findings, i)->count;
    assert_int_equal(all, 2500);
    findings_close(findings);
}

static void append(const char *folder, const char *text)
{
    char path[500];
    snprintf(path, sizeof path, "%s/findings.jsonl", folder);
    FILE *stream = fopen(path, "ab");
    assert_non_null(stream);
    fputs(text, stream);
    assert_int_equal(fclose(stream), 0);
}

static void a_torn_line_is_cut_off_and_said(void **state)
{
    (void)state;
    const char *folder = in_root("torn");
    struct findings *findings;
    assert_campaign(folder, 0, 1, 30);
    append(folder, "{\"signature\":\"cpu.rf16.mi");
    findings = look(folder);
    assert_non_null(strstr(findings_said(findings), "a torn last line of 25 bytes, left out"));
    findings_close(findings);
    assert_int_equal(findings_open(folder, &findings, &reason), STATUS_OK);
    assert_non_null(strstr(findings_said(findings), "findings.jsonl:34: a torn last line"));
    assert_non_null(strstr(findings_said(findings), "cut off"));
    findings_close(findings);
    findings = look(folder);
    assert_string_equal(findings_said(findings), "");
    findings_close(findings);
    assert_campaign(folder, 0, 1, 60);
    assert_campaign(in_root("untorn"), 0, 1, 60);
    const char *const torn[] = {folder}, *const whole[] = {in_root("untorn")};
    assert_merge(torn, 1, in_root("torn-merged"));
    assert_merge(whole, 1, in_root("untorn-merged"));
    assert_same_folders(in_root("torn-merged"), in_root("untorn-merged"), 16);
}

static void what_is_no_log_is_refused_with_its_line(void **state)
{
    (void)state;
    static const struct {
        const char *line, *rule;
    } bad[] = {
        {"nonsense\n", "findings.jsonl:2: "},
        {"[]\n", "no JSON object"},
        {"{}\n", "neither a finding nor a checkpoint"},
        {"{\"signature\":\"a.b\"}\n", "is no signature"},
        {"{\"signature\":\"cpu.rf16.missed.stack\"}\n", "missing or wrong"},
        {"{\"signature\":\"cpu.rf16.missed.stack\",\"stream\":\"gen\",\"seed\":\"-1\",\"index\":"
         "\"0\",\"version\":1,\"trial\":\"00\"}\n",
         "missing or wrong"},
        {"{\"signature\":\"cpu.rf16.missed.stack\",\"stream\":\"gen\",\"seed\":\"1\",\"index\":"
         "\"0\",\"version\":1,\"trial\":\"00\",\"ray\":-1}\n",
         "ray is no number"},
        {"{\"checkpoint\":\"\"}\n", "a checkpoint has"},
        {"{\"checkpoint\":\"\",\"more\":{\"cpu.rf16.missed.stack\":-1}}\n", "not above 0"},
        {"{\"checkpoint\":\"\",\"more\":{\"../x\":1}}\n", "is no signature"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        char name[20];
        struct findings *findings;
        snprintf(name, sizeof name, "bad%zu", i);
        assert_int_equal(findings_open(in_root(name), &findings, &reason), STATUS_OK);
        assert_int_equal(findings_checkpoint(findings, "", &reason), STATUS_OK);
        findings_close(findings);
        append(in_root(name), bad[i].line);
        assert_int_equal(findings_look(in_root(name), &findings, &reason), STATUS_INPUT);
        assert_null(findings);
        if (!strstr(reason.text, bad[i].rule) || !strstr(reason.text, "findings.jsonl:2: "))
            fail_msg("'%s': %s", bad[i].line, reason.text);
    }
    struct findings *findings;
    assert_int_equal(findings_look(in_root("nowhere"), &findings, &reason), STATUS_INPUT);
    assert_int_equal(findings_open(in_root("no/where"), &findings, &reason), STATUS_INPUT);
    assert_int_equal(findings_open("/dev/null", &findings, &reason), STATUS_INPUT);
}

static void a_file_in_the_wrong_folder_is_refused(void **state)
{
    (void)state;
    const char *folder = in_root("wrong");
    char path[600];
    struct findings *findings;
    assert_campaign(folder, 0, 1, 30);
    struct finding_file file = made(0);
    assert_int_equal(fuzz_signature_parse("cpu.f32.missed.stack", &file.signature, &reason),
                     STATUS_OK);
    snprintf(path, sizeof path, "%s/%s/first.trial", folder, names[0]);
    assert_int_equal(finding_file_write(&file, path, &reason), STATUS_OK);
    finding_file_free(&file);
    assert_int_equal(findings_open(folder, &findings, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "first.trial: expects something else"));
}

/* Waits until a child has written a byte, does `what` here, and ends the child. */
static void only_one_writes_at_a_time(void **state)
{
    (void)state;
    const char *folder = in_root("locked");
    int ends[2];
    char byte;
    struct findings *findings;
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (findings_open(folder, &findings, &reason) || write(ends[1], "x", 1) != 1)
            _exit(1);
        pause();
        _exit(0);
    }
    assert_int_equal(read(ends[0], &byte, 1), 1);
    assert_int_equal(findings_open(folder, &findings, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "another process is writing"));
    assert_int_equal(findings_look(folder, &findings, &reason), STATUS_INPUT);
    kill(child, SIGKILL);
    assert_int_equal(waitpid(child, NULL, 0), child);
    assert_int_equal(findings_open(folder, &findings, &reason), STATUS_OK);
    findings_close(findings);
    close(ends[0]);
    close(ends[1]);
}

/* A disk that is full in the middle of a line: the log stays whole. */
static void a_line_that_does_not_fit_is_taken_back(void **state)
{
    (void)state;
    const char *folder = in_root("full");
    assert_campaign(folder, 0, 1, 300);
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        const char *path = in_root("full/findings.jsonl");
        struct stat before, after;
        struct findings *findings;
        struct findings_news news;
        bool added = findings_open(folder, &findings, &reason) == STATUS_OK;
        for (uint64_t i = 300; i < 305 && added; i++) /* lines of this run stay, too */
            added = add(findings, i, &news) == STATUS_OK;
        if (!added || stat(path, &before) != 0)
            _exit(1);
        struct rlimit most = {(rlim_t)before.st_size + 50, RLIM_INFINITY};
        signal(SIGXFSZ, SIG_IGN);
        setrlimit(RLIMIT_FSIZE, &most);
        for (uint64_t i = 305; i < 315; i++)
            if (add(findings, i, &news) != STATUS_INPUT || !strstr(reason.text, "cannot write"))
                _exit(2);
        if (stat(path, &after) != 0 || after.st_size != before.st_size)
            _exit(3);
        _exit(0);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    struct findings *findings = look(folder);
    assert_string_equal(findings_said(findings), "");
    findings_close(findings);
}

/* True if finding i counts as shown again by a report of one like it, of another cause. `part`: 0
 * nothing else, 1 its engine, 2 its layout, 3 its kind is another; -1: by a death. */
static bool shown_by(struct campaign *c, size_t i, int part)
{
    struct slot slot = {.task = SLOT_AGAIN, .entry = i};
    struct work_report report = {.findings = 2};
    struct work_finding finding[2] = {{.finding = {.ray = 0}}};
    struct work_parts parts = {.report = &report, .finding = finding};
    struct fuzz_signature *like = &finding[1].finding.signature;
    uint32_t shown = c->mark[i].shown, again = c->mark[i].played_again;
    *like = findings_entry(c->findings, i)->signature;
    like->cause = CAUSE_UNEXPLAINED;
    if (part == 1)
        fuzz_signature_set_engine(like, "vulkan");
    if (part == 2)
        like->layout = layout_find("rf16");
    if (part == 3)
        like->kind = (enum fuzz_kind)((like->kind + 1) % FUZZ_KIND_COUNT);
    finding[0].finding.signature = *like;
    fuzz_signature_set_engine(&finding[0].finding.signature, "embree");
    assert_int_equal(campaign_job_take(c, &slot, part < 0 ? NULL : &parts), STATUS_OK);
    assert_int_equal(slot.task, SLOT_IDLE);
    assert_int_equal(c->mark[i].played_again, again + 1);
    assert_true(c->mark[i].shown <= shown + 1);
    return c->mark[i].shown > shown;
}

/* Of every kind: another death shows a death, a report of the same engine, layout and kind the
 * rest. */
static void what_shows_it_again_is_its_kind(void **state)
{
    (void)state;
    static struct campaign c;
    static struct campaign_mark mark[FUZZ_KIND_COUNT];
    struct findings *findings;
    struct findings_news news;
    c = (struct campaign){.reason = &reason, .mark = mark, .marks = FUZZ_KIND_COUNT - 1};
    assert_int_equal(findings_open(in_root("again"), &findings, &reason), STATUS_OK);
    c.findings = findings;
    for (int kind = FUZZ_KIND_WRONG + 1; kind < FUZZ_KIND_COUNT; kind++) {
        struct finding_file file = made((uint64_t)kind);
        fuzz_signature_set_engine(&file.signature, "fragile");
        file.signature.layout = layout_find("f32");
        file.signature.kind = (enum fuzz_kind)kind;
        file.signature.cause = CAUSE_NOT_REPEATABLE;
        if (findings_add(findings, &file, FINDINGS_NO_RAY, "x", &news, &reason))
            fail_msg("%s", reason.text);
        finding_file_free(&file);
    }
    for (size_t i = 0; i < c.marks; i++) {
        const enum fuzz_kind kind = findings_entry(findings, i)->signature.kind;
        bool is_death = kind == FUZZ_KIND_CRASH || kind == FUZZ_KIND_HANG;
        for (int part = -1; part < 4; part++)
            if (shown_by(&c, i, part) != (part == 0 || (part < 0 && is_death)))
                fail_msg("kind %s: %s", fuzz_kind_name(kind),
                         part < 0 ? "a death" : "a report of something");
        assert_int_equal(mark[i].played_again, 5);
        assert_int_equal(mark[i].shown, 1 + is_death);
        assert_false(campaign_is_flaky(&mark[i]));
    }
    findings_close(findings);
}

static void states_have_a_length(void **state)
{
    (void)state;
    static char text[FINDINGS_STATE_MOST + 3];
    struct findings *findings;
    assert_int_equal(findings_open(in_root("state"), &findings, &reason), STATUS_OK);
    for (size_t length = FINDINGS_STATE_MOST - 2; length < FINDINGS_STATE_MOST + 2; length++) {
        bool fits = length < FINDINGS_STATE_MOST;
        memset(text, 'a', length);
        assert_int_equal(findings_checkpoint(findings, text, &reason), fits ? 0 : STATUS_INPUT);
        assert_int_equal(strlen(findings_state(findings)), fits ? length : FINDINGS_STATE_MOST - 1);
    }
    findings_close(findings);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_folder_keeps_first_smallest_and_count),
        cmocka_unit_test(a_shrunk_trial_replaces_the_smallest_and_counts_nothing),
        cmocka_unit_test(many_findings_are_counted_not_listed),
        cmocka_unit_test(a_torn_line_is_cut_off_and_said),
        cmocka_unit_test(what_is_no_log_is_refused_with_its_line),
        cmocka_unit_test(a_file_in_the_wrong_folder_is_refused),
        cmocka_unit_test(only_one_writes_at_a_time),
        cmocka_unit_test(a_line_that_does_not_fit_is_taken_back),
        cmocka_unit_test(what_shows_it_again_is_its_kind),
        cmocka_unit_test(states_have_a_length),
    };
    return cmocka_run_group_tests_name("fuzz_findings", tests, make_root, remove_root);
}
