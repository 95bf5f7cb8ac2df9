/* raydiff report: one HTML file with the results of check, bench, replay and doctor. */
#define _POSIX_C_SOURCE 200809L /* gmtime_r */
#include "cmd/report/cmd_report_parts.h"

#include "fuzz/findings/baseline.h"
#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

/* --- options ------------------------------------------------------------------------------ */

/* Keeps an option to pass to other commands. It was validated here first. */
static enum status take_passed(void *options, const struct option_value *given,
                               struct reason *reason)
{
    static const struct {
        const char *names;
        unsigned to;
    } passed[] = {
        {"layout engine tri box rays shader", TO_CHECK | TO_ERROR},
        {"query", TO_CHECK},
        {"seed", TO_CHECK | TO_ERROR | TO_LAYOUTS | TO_PICTURES},
        {"threads driver device workgroup peer-time peer-memory", TO_OTHERS},
    };
    static char flags[REPORT_PASSED][16];
    struct report_options *o = options;
    for (size_t i = 0; i < ARRAY_COUNT(passed); i++) {
        if (!option_among(passed[i].names, given->row->name))
            continue;
        if (o->passed_count == REPORT_PASSED)
            return fail(reason, STATUS_INPUT, "--%s: too many options", given->row->name);
        char *flag = flags[o->passed_count];
        snprintf(flag, sizeof flags[0], "--%s", given->row->name);
        o->passed[o->passed_count++] = (struct passed){passed[i].to, flag, given->text};
    }
    return STATUS_OK;
}

static enum status take_given(void *options, const struct option_value *given,
                              struct reason *reason)
{
    struct report_options *o = options;
    const bool check = strcmp(given->row->name, "check") == 0;
    size_t *count = check ? &o->check_count : &o->bench_count;
    if (*count == FILES_GIVEN)
        return fail(reason, STATUS_INPUT, "--%s: at most %d files", given->row->name, FILES_GIVEN);
    (check ? o->check : o->bench)[(*count)++] = given->text;
    return STATUS_OK;
}

static enum status take_findings(void *options, const struct option_value *given,
                                 struct reason *reason)
{
    struct report_options *o = options;
    if (o->findings_count == FOLDERS_GIVEN)
        return fail(reason, STATUS_INPUT, "--findings: at most %d folders", FOLDERS_GIVEN);
    o->findings[o->findings_count++] = given->text;
    return STATUS_OK;
}

static enum status take_picture(void *options, const struct option_value *given,
                                struct reason *reason)
{
    struct report_options *o = options;
    char *text = given->text;
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return fail(reason, STATUS_INPUT, "--picture: '%s' is not TITLE=FILE", text);
    if (o->picture_count == PICTURES_GIVEN)
        return fail(reason, STATUS_INPUT, "--picture: at most %d pictures", PICTURES_GIVEN);
    o->picture[o->picture_count++] = text;
    return STATUS_OK;
}

static enum status take_parts(void *options, const struct option_value *given,
                              struct reason *reason)
{
    struct report_options *o = options;
    char *text = given->text;
    static const char *const name[REPORT_KINDS] = {"check", "bench", "pictures", "", "machine"};
    memset(o->wanted, 0, sizeof o->wanted);
    for (char *at = strtok(text, ","); at; at = strtok(NULL, ",")) {
        size_t kind = 0;
        while (kind < REPORT_KINDS && (strcmp(name[kind], at) != 0 || !name[kind][0]))
            kind++;
        if (strcmp(at, "all") == 0)
            for (kind = 0; kind < REPORT_KINDS; kind++)
                o->wanted[kind] = true;
        else if (kind == REPORT_KINDS)
            return fail(reason, STATUS_INPUT,
                        "--parts: unknown '%s'; known: check, bench, pictures, machine, all", at);
        else
            o->wanted[kind] = true;
    }
    return STATUS_OK;
}

static enum status take_baseline(void *options, const struct option_value *given,
                                 struct reason *reason)
{
    return baseline_add_file(((struct report_options *)options)->baseline, given->text, reason);
}

#define ROWS_OF struct report_options

static const struct option_row rows[] = {
    {"out", "FILE", "the report", OF_OUTPUT(out)},
    {"title", "TEXT", "its heading", OF_TEXT(title), .shown = "raydiff: SCENE, ..."},
    {"parts", "P,..", "of check, bench, pictures, machine", OF_OWN(take_parts), .shown = "all"},
    {"quick", NULL, "fewer members, rays and rounds", OF_FLAG(quick)},
    {"count", "N", "rays of check and of each benchmark", OF_COUNT(count, 1, 1u << 28),
     .shown = "10000 and 5000; quick 2000"},
    {"rounds", "N", "of the benchmarks", OF_COUNT(rounds, 1, 99), .shown = "5; quick 3"},
    {"time", "S", "seconds that a part may take", OF_COUNT(seconds, 1, 86400), .value = "600"},
    {"json", "FILE", "its parts and sums, for machines", OF_DATA(json)},
    {0},
};

static const struct option_row given_rows[] = {
    {"check", "FILE", "what raydiff check --json wrote", OF_OWN(take_given), .file = true,
     .repeats = true},
    {"bench", "FILE", "what raydiff bench --json wrote, of any benchmark", OF_OWN(take_given),
     .file = true, .repeats = true},
    {"benchmark", "FILE", "what raydiff render --benchmark wrote as JSON", OF_OWN(take_given),
     .file = true, .repeats = true},
    {"picture", "T=FILE", "a PNG file with its title", OF_OWN(take_picture), .file = true,
     .repeats = true},
    {"doctor", "FILE", "what raydiff doctor --json wrote, once", OF_FILE(doctor)},
    {"findings", "DIR", "a folder of raydiff fuzz; each finding is played again and explained",
     OF_OWN(take_findings), .file = true, .repeats = true},
    {"web", "DIR",
     "a folder of raydiff web as it is reached from the report; findings link to their pages in it",
     OF_TEXT(web), .file = true},
    {"baseline", "FILE", "known findings, besides those that are part of raydiff",
     OF_OWN(take_baseline), .file = true, .repeats = true},
    {0},
};

static const struct option_row passed_rows[] = {
    {"layout", "L,..", "node layouts", OF_LIST(tried, TABLE_LAYOUTS)},
    {"engine", "E,..", "engines", OF_LIST(tried, TABLE_ENGINES)},
    {"tri", "T,..", "triangle tests", OF_LIST(tried, TABLE_TRI_TESTS)},
    {"box", "B,..", "box tests", OF_LIST(tried, TABLE_BOX_TESTS)},
    {"query", "Q,..", "queries", OF_LIST(tried, TABLE_QUERIES)},
    {"rays", "SET", "ray set", OF_ONE(tried.count, TABLE_RAY_SETS)},
    {"seed", "S", "of rays and generators", OF_COUNT(tried.count, 0, UINT64_MAX)},
    {0},
};

static const struct option_set set = {
    .command = "report",
    .usage = "report [SCENE...] --out FILE.html [OPTIONS]",
    .about =
        "Writes one HTML file that needs nothing else: agreement, speed against error and size, "
        "pictures, findings explained, the machine, and the commands that make each part again. "
        "Plays SCENEs (default: " REPORT_DEFAULT_SCENES_TEXT "), or puts results together: with "
        "results given and no SCENE only findings are played.",
    .group = {GROUP(rows),
              {.row = given_rows,
               .title = "results that exist, each as often as you like but --doctor:"},
              {.row = passed_rows,
               .title = "and handed on to the commands that take it, but --layout and --engine\n"
                        "to bench layouts, which compares its own choice of them:"},
              GROUP_AT(engine_rows, engines),
              GROUP_AT(outside_rows, engines)},
    .codes = "the worst of its parts, which stand in it with their reasons: 0 all agree, 1 a "
             "mismatch, or a finding that is still there and not in the baseline, 2 bad input, 3 "
             "an engine or a part crashed, hung or took too long, 4 internal error, 77 a part "
             "cannot run here, 128 + the signal that ended it (then nothing is written)",
    .example = "report sphere:n=8 --out report.html",
    .taken = take_passed,
};

/* --- the report --------------------------------------------------------------------------- */

static void when_text(char *text, size_t text_bytes)
{
    const char *fixed = getenv("SOURCE_DATE_EPOCH"); /* for reproducible reports */
    time_t now = fixed ? (time_t)strtoll(fixed, NULL, 10) : time(NULL);
    struct tm utc;
    if (!gmtime_r(&now, &utc) || strftime(text, text_bytes, "%Y-%m-%d %H:%M UTC", &utc) == 0)
        snprintf(text, text_bytes, "at an unknown time");
}

static void title_text(const struct report_options *o, char *text, size_t text_bytes)
{
    if (o->title) {
        snprintf(text, text_bytes, "%s", o->title);
        return;
    }
    snprintf(text, text_bytes, "raydiff");
    for (size_t i = 0; i < o->scene_count; i++) {
        size_t used = strlen(text);
        snprintf(text + used, text_bytes - used, "%s%s", i ? ", " : ": ", o->scene[i]);
    }
}

static const char *state_name(enum report_state state)
{
    static const char *const name[] = {"ran", "given", "skipped", "failed"};
    return name[state];
}

static enum status write_json(const char *path, const struct report *report, size_t bytes,
                              struct reason *reason)
{
    struct report_sum sum = report_sum(report);
    json_t *parts = json_array();
    for (size_t i = 0; i < report->part_count; i++) {
        const struct report_part *part = &report->part[i];
        (void)json_array_append_new(
            parts,
            json_record("name=%s state=%s exit=%d command=%s why=%s seconds=%g known=%s",
                        part->name, state_name(part->state), part->code, part->command, part->why,
                        part->seconds, report_part_known(part) ? part->known : ""));
    }
    json_t *root = json_record(
        "raydiff=%s exit=%d bytes=%zu figures=%zu answers=%zu wrong=%zu bit_differences=%zu "
        "findings=%zu failing=%zu known=%zu pictures=%zu parts=%p",
        RAYDIFF_VERSION, report_code(report), bytes, sum.figures, sum.answers, sum.wrong, sum.bits,
        sum.findings, sum.failing, sum.known, report->picture_count, parts);
    return json_write(path, root, 9, reason);
}

static void print_sum(const struct report *report, const char *path, size_t bytes)
{
    struct report_sum sum = report_sum(report);
    printf("%s: %.1f kB, %zu part%s, %zu figure%s\n", path, (double)bytes / 1e3, sum.parts,
           plural(sum.parts), sum.figures, plural(sum.figures));
    for (size_t i = 0; i < report->part_count; i++) {
        const struct report_part *part = &report->part[i];
        int code = report_part_code(part);
        if (code == EXIT_AGREE)
            continue;
        printf("  %s: exit code %d%s%.*s\n", part->name, code, part->why[0] ? ": " : "",
               (int)strcspn(part->why, "\n"), part->why);
    }
    if (sum.rows > 0)
        printf("  %zu of %zu answers WRONG, %zu with other bits than cpu's\n", sum.wrong,
               sum.answers, sum.bits);
    if (bytes > REPORT_BYTES_MOST)
        fprintf(stderr, "raydiff report: %s is larger than %u bytes: show fewer scenes or rows\n",
                path, REPORT_BYTES_MOST);
}

/* Writes the page and, with --json, its sums. Returns the exit code. */
static int finish(const struct report_options *o, const struct report *report, struct file_out *out,
                  struct reason *reason)
{
    struct stat about = {.st_size = 0};
    enum status status = report_write(report, out->stream, reason);
    if (status == STATUS_OK)
        status = file_out_commit(out, reason);
    if (status == STATUS_OK && stat(o->out, &about) == 0)
        print_sum(report, o->out, (size_t)about.st_size);
    if (status == STATUS_OK && o->json)
        status = write_json(o->json, report, (size_t)about.st_size, reason);
    if (status == STATUS_OK)
        return report_code(report);
    fprintf(stderr, "raydiff report: %s\n", reason->text);
    return exit_worse(report_code(report), exit_of_status(status));
}

static int make_and_write(const struct report_options *o, struct runner *runner,
                          const char *command)
{
    char title[1024], when[64];
    struct report report = {.title = title, .command = command, .when = when};
    struct file_out out = {.stream = NULL};
    struct reason reason = {""};
    title_text(o, title, sizeof title);
    when_text(when, sizeof when);
    int code = EXIT_AGREE;
    enum status status = file_out_open(o->out, &out, &reason);
    if (status == STATUS_OK && o->scene_count > 0)
        code = report_try_scenes(o, runner, &reason);
    if (status == STATUS_OK && code == EXIT_AGREE)
        status = report_make(o, runner, &report, &reason);
    progress_end(&runner->progress);
    if (runner_signal()) {
        code = 128 + runner_signal();
    } else if (status || code) {
        fprintf(stderr, "raydiff report: %s\n", reason.text);
        code = status ? exit_of_status(status) : code;
    } else {
        code = finish(o, &report, &out, &reason);
    }
    file_out_discard(&out);
    report_free(&report);
    return code;
}

/* The scenes used if none is named and no results are given. */
static char *own_scenes[] = {REPORT_DEFAULT_SCENES};

static int check_options(struct report_options *o)
{
    bool given =
        o->check_count + o->bench_count + o->picture_count > 0 || o->doctor || o->findings_count;
    if (!o->out)
        return usage_error("report", "--out FILE.html is needed");
    if (o->scene_count == 0 && !given) {
        o->scene = own_scenes;
        o->scene_count = ARRAY_COUNT(own_scenes);
    }
    if (o->scene_count > REPORT_SCENES)
        return usage_error("report", "at most %d scenes", REPORT_SCENES);
    for (size_t i = 0; i < o->scene_count; i++)
        if (strchr(o->scene[i], ';'))
            return usage_error("report", "'%s': a scene's name may not hold ';'", o->scene[i]);
    int code = report_check_use(o);
    return code < 0 ? EXIT_AGREE : code;
}

static int run_report(struct report_options *o, struct runner *runner, const char *command)
{
    struct reason reason;
    int code = check_options(o);
    if (code)
        return code;
    runner->seconds = (unsigned)o->seconds;
    if (runner_open(runner, &reason))
        return usage_error("report", "%s", reason.text);
    code = make_and_write(o, runner, command);
    runner_close(runner);
    return code;
}

int cmd_report(int argc, char **argv)
{
    struct baseline baseline = {.count = 0};
    struct report_options o = {.baseline = &baseline, .engines = engine_options_default()};
    struct runner runner = {.progress = progress_make("report")};
    struct reason reason;
    char command[LINE_TEXT_BYTES] = "raydiff report";
    for (int i = 1; i < argc; i++)
        command_word(command, sizeof command, argv[i]);
    for (size_t kind = 0; kind < REPORT_KINDS; kind++)
        o.wanted[kind] = true;
    if (baseline_open(&baseline, &reason)) {
        fprintf(stderr, "raydiff report: %s\n", reason.text);
        return EXIT_INTERNAL;
    }
    int first, code = options_read(&set, &o, argc, argv, &first);
    if (code < 0) {
        o.scene = argv + first;
        o.scene_count = (size_t)(argc - first);
        code = run_report(&o, &runner, command);
    }
    baseline_close(&baseline);
    return code;
}
