/* Runs the commands that produce the parts of a report. */
#define _GNU_SOURCE /* AT_FDCWD */
#include "cmd/report/cmd_report_parts.h"

#include "fuzz/findings/baseline.h"
#include "fuzz/findings/findings.h"
#include "cmd/web/cmd_web.h"
#include "ref/outside/plugin_guard.h"
#include "ref/outside/plugin_shader.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/files/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PRINTED_MOST 40000u  /* bytes of an explanation */
#define DRAWING_MOST 400000u /* of its picture, more than explain draws */

void report_pass_on(struct line *line, const struct report_options *options, unsigned to)
{
    for (size_t i = 0; i < options->passed_count; i++)
        if ((options->passed[i].to & to) &&
            report_line_uses(line, options, to, options->passed[i].flag)) {
            line_word(line, options->passed[i].flag);
            line_word(line, options->passed[i].value);
        }
}

const char *report_passed(const struct report_options *options, unsigned to, const char *flag)
{
    const char *value = NULL;
    for (size_t i = 0; i < options->passed_count; i++)
        if ((options->passed[i].to & to) && strcmp(options->passed[i].flag, flag) == 0)
            value = options->passed[i].value;
    return value;
}

void report_option(struct line *line, const char *flag, const char *value)
{
    line_word(line, flag);
    line_word(line, value);
}

void report_layout(struct line *line, const char *name)
{
    const char *shader = plugin_shader_of(name);
    report_option(line, "--layout", name);
    if (shader)
        report_option(line, "--shader", shader);
}

static void number(struct line *line, const char *flag, uint64_t value)
{
    char text[24];
    snprintf(text, sizeof text, "%llu", (unsigned long long)value);
    report_option(line, flag, text);
}

/* Runs the line, whose result is the folder's file `name`, and adds the part with its command. */
static enum status run_part(struct report *report, struct runner *runner, command_fn *command,
                            struct line *line, const char *name, struct report_part *part,
                            struct reason *reason)
{
    struct run run;
    enum status status = runner_make(runner, command, line, name, &run, part, reason);
    if (status || run.stopped)
        return status;
    part->command = line->text;
    return report_add(report, part, reason);
}

/* --- check, bench, doctor ------------------------------------------------------------------- */

/* Adds the part's own value for an option that the line uses and the user did not set. */
static void own_option(struct line *line, const struct report_options *options, unsigned to,
                       const char *flag, const char *value)
{
    if (!report_passed(options, TO_ALL, flag) && report_line_uses(line, options, to, flag))
        report_option(line, flag, value);
}

static enum status make_check(const struct report_options *options, struct runner *runner,
                              struct report *report, struct reason *reason)
{
    struct report_part part = {.kind = REPORT_CHECK, .name = (char[]){"check"}};
    const unsigned to = TO_CHECK | TO_OTHERS;
    struct line line;
    line_begin(&line, "check");
    for (size_t i = 0; i < options->scene_count; i++)
        line_word(&line, options->scene[i]);
    own_option(&line, options, to, "--layout",
               options->quick ? "f32,rf16,rtrs_rf" : "f32,rf16,rtrs_direct,rtrs_rf");
    if (!options->quick) {
        own_option(&line, options, to, "--tri", "mt,woop");
        own_option(&line, options, to, "--box", "robust,watertight");
    }
    number(&line, "--count", options->count ? options->count : options->quick ? 2000 : 10000);
    number(&line, "--repeat", 1); /* bench measures speed */
    number(&line, "--brute", options->quick ? 1000000 : 10000000);
    report_pass_on(&line, options, to);
    return run_part(report, runner, cmd_check, &line, "check.json", &part, reason);
}

/* Joins all scene names in one string, separated by ';'. */
static char *joined_scenes(const struct report_options *options)
{
    size_t bytes = 1;
    for (size_t i = 0; i < options->scene_count; i++)
        bytes += strlen(options->scene[i]) + 1;
    char *text = alloc_zeroed(bytes, 1);
    for (size_t i = 0; i < options->scene_count && text; i++) {
        strcat(text, i > 0 ? ";" : "");
        strcat(text, options->scene[i]);
    }
    return text;
}

static enum status make_bench(const struct report_options *options, struct runner *runner,
                              const char *benchmark, struct report *report, struct reason *reason)
{
    bool error = strcmp(benchmark, "error") == 0;
    char name[32], file[32];
    snprintf(name, sizeof name, "bench %s", benchmark);
    snprintf(file, sizeof file, "%s.json", benchmark);
    struct report_part part = {.kind = REPORT_BENCH, .name = name};
    struct line line;
    char *scenes = joined_scenes(options);
    if (!scenes)
        return fail(reason, STATUS_MEMORY, "out of memory");
    line_begin(&line, "bench");
    line_word(&line, benchmark);
    report_option(&line, "--scene", scenes);
    free(scenes);
    uint64_t count = options->count ? options->count : options->quick ? 2000 : 5000;
    number(&line, "--count", count);
    number(&line, "--rounds", options->rounds ? options->rounds : options->quick ? 3 : 5);
    report_pass_on(&line, options, (error ? TO_ERROR : TO_LAYOUTS) | TO_OTHERS);
    return run_part(report, runner, cmd_bench, &line, file, &part, reason);
}

static enum status make_machine(const struct report_options *options, struct runner *runner,
                                struct report *report, struct reason *reason)
{
    struct report_part part = {.kind = REPORT_MACHINE, .name = (char[]){"doctor"}};
    struct line line;
    line_begin(&line, "doctor");
    report_pass_on(&line, options, TO_OTHERS);
    return run_part(report, runner, cmd_doctor, &line, "doctor.json", &part, reason);
}

/* --- findings ----------------------------------------------------------------------------- */

/* Reads what the child printed, up to PRINTED_MOST bytes. The caller frees it. */
static enum status printed(const struct runner *runner, char **text, struct reason *reason)
{
    char path[4096];
    runner_path(runner, "out", path, sizeof path);
    *text = alloc_zeroed(1, PRINTED_MOST + 1);
    int file = *text ? file_open_again(AT_FDCWD, path, O_RDONLY) : -1;
    ssize_t got = file >= 0;
    size_t size = 0;
    while (got > 0 && size < PRINTED_MOST) {
        got = read(file, *text + size, PRINTED_MOST - size);
        if (got < 0 && errno == EINTR)
            got = 1;
        else if (got > 0)
            size += (size_t)got;
    }
    enum status status = STATUS_OK;
    if (!*text)
        status = fail(reason, STATUS_MEMORY, "out of memory");
    else if (file < 0 || got < 0)
        status = fail(reason, STATUS_INPUT, "%s: %s", path, strerror(errno));
    if (file >= 0)
        close(file);
    if (size == PRINTED_MOST)
        memcpy(*text + size - 8, "\n(cut)\n", 8);
    return status;
}

/* Looks up a finding in the baseline, as raydiff fuzz does. */
static enum status ask_baseline(const struct report_options *options,
                                const struct findings *findings, const struct findings_entry *entry,
                                struct baseline_answer *answer, struct reason *reason)
{
    struct finding_file file = {0};
    char today[BASELINE_DAY];
    enum status status = STATUS_OK;
    baseline_today(today);
    if (entry->has_first)
        status = findings_get(findings, &entry->signature, "first.trial", &file, reason);
    if (!status)
        baseline_ask(options->baseline, &entry->signature, entry->has_first ? file.versions : "",
                     today, answer);
    finding_file_free(&file);
    return status;
}

/* Draws a finding in a child, as raydiff explain --svg does. *out is NULL if there is nothing to
 * draw: explain says why, and the report has its text. */
static enum status draw_finding(const struct report_options *options, struct runner *runner,
                                const char *path, const char *layout, char **out,
                                struct reason *reason)
{
    char svg[4096];
    struct run run;
    struct line line;
    size_t size;
    *out = NULL;
    line_begin(&line, "explain");
    line_word(&line, path);
    if (layout)
        report_layout(&line, layout);
    report_pass_on(&line, options, TO_OTHERS);
    line_word(&line, "--svg");
    line_file(&line, runner, "finding.svg");
    runner_path(runner, "finding.svg", svg, sizeof svg);
    remove(svg);
    enum status status = runner_run(runner, cmd_explain, &line, &run, reason);
    line_free(&line);
    if (status || run.dead || run.stopped || run.code != EXIT_MISMATCH)
        return status;
    return file_read_most(svg, DRAWING_MOST, out, &size, reason);
}

/* Writes the link to the page of a finding; "" if there is none in that folder. */
static void find_page(const struct report_options *options, const char *name, char *link,
                      size_t link_bytes)
{
    char file[WEB_NAME_MOST], path[4096] = "";
    const char *slash = strrchr(options->out, '/');
    link[0] = '\0';
    if (!options->web)
        return;
    web_name(name, file);
    if (slash && options->web[0] != '/')
        text_append(path, sizeof path, "%.*s/", (int)(slash - options->out), options->out);
    text_append(path, sizeof path, "%s/%s.html", options->web, file);
    if (access(path, R_OK) != 0)
        return;
    for (const char *at = options->web; *at; at++) /* as addresses are written */
        if (strchr(" %#?&\"\\", *at))
            text_append(link, link_bytes, "%%%02X", (unsigned char)*at);
        else
            text_append(link, link_bytes, "%c", *at);
    text_append(link, link_bytes, "/%s.html", file);
}

static enum status make_finding(const struct report_options *options, struct runner *runner,
                                const struct findings *findings, size_t i, struct report *report,
                                struct reason *reason)
{
    const struct findings_entry *entry = findings_entry(findings, i);
    char name[FUZZ_SIGNATURE_MOST], path[4096];
    struct run run;
    struct line line;
    fuzz_signature_print(&entry->signature, name);
    findings_path(findings, &entry->signature,
                  entry->has_smallest ? "smallest.trial" : "first.trial", path, sizeof path);
    struct report_part part = {.kind = REPORT_FINDING, .name = name, .times = entry->count};
    struct baseline_answer answer;
    char page[4096];
    find_page(options, name, page, sizeof page);
    part.page = page;
    enum status status = ask_baseline(options, findings, entry, &answer, reason);
    if (status)
        return status;
    line_begin(&line, "replay");
    line_word(&line, path);
    if (plugin_path(entry->signature.layout))
        report_layout(&line, plugin_path(entry->signature.layout));
    report_pass_on(&line, options, TO_OTHERS);
    char command[LINE_TEXT_BYTES];
    snprintf(command, sizeof command, "%s", line.text); /* copied before --json is added */
    part.command = command;
    status = runner_make(runner, cmd_replay, &line, "finding.json", &run, &part, reason);
    if (status || run.stopped)
        return status;
    status = printed(runner, &part.text, reason);
    if (!status && run.code == EXIT_MISMATCH)
        status = draw_finding(options, runner, path, plugin_path(entry->signature.layout),
                              &part.drawing, reason);
    if (answer.state == BASELINE_KNOWN)
        part.known = answer.text;
    if (status)
        json_decref(part.json);
    else
        status = report_add(report, &part, reason);
    free(part.text);
    free(part.drawing);
    return status;
}

static enum status make_findings(const struct report_options *options, const char *folder,
                                 struct runner *runner, struct report *report,
                                 struct reason *reason)
{
    struct findings *findings;
    report->wanted[REPORT_FINDING] = true;
    enum status status = findings_look(folder, &findings, reason);
    if (status)
        return status;
    size_t count = findings_count(findings);
    size_t shown = count < FINDINGS_SHOWN ? count : FINDINGS_SHOWN;
    report->findings_left_out += count - shown;
    for (size_t i = 0; i < shown && status == STATUS_OK && !runner_signal(); i++)
        status = make_finding(options, runner, findings, i, report, reason);
    findings_close(findings);
    return status;
}

/* --- what is given ------------------------------------------------------------------------ */

static enum status take_file(struct report *report, enum report_kind kind, const char *flag,
                             const char *path, struct reason *reason)
{
    char name[200], command[LINE_TEXT_BYTES];
    struct report_part part = {
        .kind = kind, .state = REPORT_GIVEN, .name = name, .command = command};
    snprintf(name, sizeof name, "%s %s", flag + 2, file_label(path));
    snprintf(command, sizeof command, "# read from");
    command_word(command, sizeof command, path);
    enum status status = report_read(path, kind, &part.json, reason);
    if (status)
        return status;
    part.code = (int)json_integer_value(json_object_get(part.json, "exit"));
    return report_add(report, &part, reason);
}

static enum status take_files(const struct report_options *options, struct report *report,
                              struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < options->check_count && !status; i++)
        status = take_file(report, REPORT_CHECK, "--check", options->check[i], reason);
    for (size_t i = 0; i < options->bench_count && !status; i++)
        status = take_file(report, REPORT_BENCH, "--bench", options->bench[i], reason);
    if (options->doctor && !status)
        status = take_file(report, REPORT_MACHINE, "--doctor", options->doctor, reason);
    for (size_t i = 0; i < options->picture_count && !status; i++) {
        char *equals = strchr(options->picture[i], '='); /* its presence was checked before */
        *equals = '\0';
        status =
            report_add_picture(report, "", options->picture[i], equals + 1, equals + 1, reason);
        *equals = '=';
    }
    return status;
}

/* --- all ---------------------------------------------------------------------------------- */

int report_try_scenes(const struct report_options *options, struct runner *runner,
                      struct reason *reason)
{
    struct run run;
    struct line line;
    line_begin(&line, "scene");
    line_word(&line, "info");
    for (size_t i = 0; i < options->scene_count; i++)
        line_word(&line, options->scene[i]);
    enum status status = runner_run(runner, cmd_scene, &line, &run, reason);
    line_free(&line);
    if (status)
        return exit_of_status(status);
    const char *said = strncmp(run.said, "raydiff scene: ", 15) == 0 ? run.said + 15 : run.said;
    if (run.code)
        (void)fail(reason, STATUS_INPUT, "%.*s", (int)strcspn(said, "\n"), said);
    return run.code;
}

enum status report_make(const struct report_options *options, struct runner *runner,
                        struct report *report, struct reason *reason)
{
    bool scenes = options->scene_count > 0;
    enum status status = take_files(options, report, reason);
    if (!status && scenes && options->wanted[REPORT_CHECK] && !runner_signal())
        status = make_check(options, runner, report, reason);
    if (!status && scenes && options->wanted[REPORT_BENCH] && !runner_signal())
        status = make_bench(options, runner, "error", report, reason);
    if (!status && scenes && options->wanted[REPORT_BENCH] && !runner_signal())
        status = make_bench(options, runner, "layouts", report, reason);
    if (!status && scenes && options->wanted[REPORT_PICTURES] && !runner_signal())
        status = report_make_pictures(options, runner, report, reason);
    for (size_t i = 0; i < options->findings_count && !status && !runner_signal(); i++)
        status = make_findings(options, options->findings[i], runner, report, reason);
    if (!status && !options->doctor && options->wanted[REPORT_MACHINE] && !runner_signal())
        status = make_machine(options, runner, report, reason);
    return status;
}
