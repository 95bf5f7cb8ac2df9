/* raydiff report: one HTML file of what check, bench, replay and doctor say. */
#define _POSIX_C_SOURCE 200809L /* gmtime_r */
#include "cmd/report/cmd_report_parts.h"

#include "fuzz/findings/baseline.h"
#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_options.h"
#include "ref/base/command.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

static const char help[] =
    "usage: raydiff report [SCENE...] --out FILE.html [OPTIONS]\n"
    "Writes one HTML file that needs nothing else: who agrees, speed against error and size,\n"
    "pictures, findings explained, the machine, and the commands that make each part again.\n"
    "Plays SCENEs (default: " REPORT_DEFAULT_SCENES_TEXT "), or puts together what is there:\n"
    "with results given and no SCENE nothing is played but findings.\n\n"
    "  --out FILE        the report\n"
    "  --title TEXT      its heading                              [raydiff: SCENE, ...]\n"
    "  --parts P,...     of check, bench, pictures, machine       [all]\n"
    "  --quick           fewer members, rays and rounds\n"
    "  --count N         rays of check and of each benchmark      [10000 and 5000; quick 2000]\n"
    "  --rounds N        of the benchmarks                        [5; quick 3]\n"
    "  --time S          seconds that a part may take             [600]\n"
    "results that are there, each as often as you like:\n"
    "  --check FILE      what raydiff check --json wrote\n"
    "  --bench FILE      what raydiff bench --json wrote, of any benchmark\n"
    "  --benchmark FILE  what raydiff render --benchmark wrote as JSON\n"
    "  --picture T=FILE  a PNG file with its title\n"
    "  --doctor FILE     what raydiff doctor --json wrote, once\n"
    "  --findings DIR    a folder of raydiff fuzz; each finding is played again and explained\n"
    "  --baseline FILE   known findings, besides those that are part of raydiff\n"
    "and handed on to the commands that take it:\n"
    "  --layout L,..  --engine E,..  --tri T,..  --box B,..  --query Q,..  --rays SET  --seed "
    "S\n" ENGINE_OPTIONS_HELP "  --json FILE       its parts and sums, for machines\n\n"
    "exit codes: the worst of its parts, which stand in it with their reasons: 0 all agree, 1 a\n"
    "mismatch, or a finding that is still there and not in the baseline, 2 bad input, 3 an engine "
    "or a part crashed, hung\n"
    "or took too long, 4 internal error, 77 a part cannot run here, 128 + the signal that ended "
    "it\n"
    "(then nothing is written)\n"
    "example: raydiff report scenes/fetched/bunny.obj --findings findings --out report.html\n";

enum {
    OPT_OUT = 256,
    OPT_TITLE,
    OPT_PARTS,
    OPT_QUICK,
    OPT_COUNT,
    OPT_ROUNDS,
    OPT_TIME,
    OPT_CHECK,
    OPT_BENCH,
    OPT_PICTURE,
    OPT_DOCTOR,
    OPT_FINDINGS,
    OPT_BASELINE,
    OPT_JSON,
    OPT_LAYOUT,
    OPT_ENGINE,
    OPT_TRI,
    OPT_BOX,
    OPT_QUERY,
    OPT_RAYS,
    OPT_SEED
};

static const struct option long_options[] = {{"out", 1, NULL, OPT_OUT},
                                             {"title", 1, NULL, OPT_TITLE},
                                             {"parts", 1, NULL, OPT_PARTS},
                                             {"quick", 0, NULL, OPT_QUICK},
                                             {"count", 1, NULL, OPT_COUNT},
                                             {"rounds", 1, NULL, OPT_ROUNDS},
                                             {"time", 1, NULL, OPT_TIME},
                                             {"check", 1, NULL, OPT_CHECK},
                                             {"bench", 1, NULL, OPT_BENCH},
                                             {"benchmark", 1, NULL, OPT_BENCH},
                                             {"picture", 1, NULL, OPT_PICTURE},
                                             {"doctor", 1, NULL, OPT_DOCTOR},
                                             {"findings", 1, NULL, OPT_FINDINGS},
                                             {"baseline", 1, NULL, OPT_BASELINE},
                                             {"json", 1, NULL, OPT_JSON},
                                             {"layout", 1, NULL, OPT_LAYOUT},
                                             {"engine", 1, NULL, OPT_ENGINE},
                                             {"tri", 1, NULL, OPT_TRI},
                                             {"box", 1, NULL, OPT_BOX},
                                             {"query", 1, NULL, OPT_QUERY},
                                             {"rays", 1, NULL, OPT_RAYS},
                                             {"seed", 1, NULL, OPT_SEED},
                                             ENGINE_OPTIONS};

static void print_help(void)
{
    fputs(help, stdout);
}

/* --- options ------------------------------------------------------------------------------ */

static enum status pass(struct report_options *o, unsigned to, const char *flag, const char *value,
                        struct reason *reason)
{
    if (o->passed_count == REPORT_PASSED)
        return fail(reason, STATUS_INPUT, "%s: too many options", flag);
    o->passed[o->passed_count++] = (struct passed){to, flag, value};
    return STATUS_OK;
}

/* An option that other commands read, tried here first. */
static enum status take_passed(struct report_options *o, int option, const char *text,
                               struct reason *reason)
{
    static const struct {
        int option;
        enum table table;
        const char *flag;
        unsigned to;
    } lists[] = {{OPT_LAYOUT, TABLE_LAYOUTS, "--layout", TO_CHECK | TO_ERROR},
                 {OPT_ENGINE, TABLE_ENGINES, "--engine", TO_CHECK | TO_ERROR},
                 {OPT_TRI, TABLE_TRI_TESTS, "--tri", TO_CHECK | TO_ERROR},
                 {OPT_BOX, TABLE_BOX_TESTS, "--box", TO_CHECK | TO_ERROR},
                 {OPT_QUERY, TABLE_QUERIES, "--query", TO_CHECK},
                 {OPT_RAYS, TABLE_RAY_SETS, "--rays", TO_CHECK | TO_ERROR}};
    struct engine_options tried;
    struct list list;
    uint64_t value;
    enum status status;
    for (size_t i = 0; i < ARRAY_COUNT(lists); i++) {
        if (lists[i].option != option)
            continue;
        status = option == OPT_RAYS
                     ? table_parse_one(lists[i].table, lists[i].flag, text, &list.count, reason)
                     : table_parse(lists[i].table, lists[i].flag, text, &list, reason);
        return status ? status : pass(o, lists[i].to, lists[i].flag, text, reason);
    }
    if (option == OPT_SEED) {
        status = parse_count("--seed", text, 0, UINT64_MAX, &value, reason);
        return status ? status : pass(o, TO_CHECK | TO_ERROR | TO_PICTURES, "--seed", text, reason);
    }
    static const struct option known[] = {ENGINE_OPTIONS};
    const unsigned to = option == OPT_SHADER ? TO_CHECK | TO_ERROR : TO_OTHERS;
    status = engine_option_take(option, text, &tried, reason);
    for (size_t i = 0; known[i].name && !status; i++)
        if (known[i].val == option) {
            static char flags[ARRAY_COUNT(known)][24];
            snprintf(flags[i], sizeof flags[i], "--%s", known[i].name);
            return pass(o, to, flags[i], text, reason);
        }
    return status;
}

static enum status take_given(const char **list, size_t *count, const char *flag, const char *path,
                              struct reason *reason)
{
    if (*count == FILES_GIVEN)
        return fail(reason, STATUS_INPUT, "%s: at most %d files", flag, FILES_GIVEN);
    list[(*count)++] = path;
    return STATUS_OK;
}

static enum status take_picture(struct report_options *o, char *text, struct reason *reason)
{
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return fail(reason, STATUS_INPUT, "--picture: '%s' is not TITLE=FILE", text);
    if (o->picture_count == PICTURES_GIVEN)
        return fail(reason, STATUS_INPUT, "--picture: at most %d pictures", PICTURES_GIVEN);
    o->picture[o->picture_count++] = text;
    return STATUS_OK;
}

static enum status take_parts(struct report_options *o, char *text, struct reason *reason)
{
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

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    struct report_options *o = user;
    switch (option) {
    case OPT_OUT:
        o->out = text;
        return STATUS_OK;
    case OPT_TITLE:
        o->title = text;
        return STATUS_OK;
    case OPT_PARTS:
        return take_parts(o, text, reason);
    case OPT_QUICK:
        o->quick = true;
        return STATUS_OK;
    case OPT_COUNT:
        return parse_count("--count", text, 1, 1u << 28, &o->count, reason);
    case OPT_ROUNDS:
        return parse_count("--rounds", text, 1, 99, &o->rounds, reason);
    case OPT_TIME:
        return parse_count("--time", text, 1, 86400, &o->seconds, reason);
    case OPT_CHECK:
        return take_given(o->check, &o->check_count, "--check", text, reason);
    case OPT_BENCH:
        return take_given(o->bench, &o->bench_count, "--bench", text, reason);
    case OPT_PICTURE:
        return take_picture(o, text, reason);
    case OPT_DOCTOR:
        o->doctor = text;
        return STATUS_OK;
    case OPT_FINDINGS:
        o->findings = text;
        return STATUS_OK;
    case OPT_BASELINE:
        return baseline_add_file(o->baseline, text, reason);
    case OPT_JSON:
        o->json = text;
        return STATUS_OK;
    default:
        return take_passed(o, option, text, reason);
    }
}

/* --- the report --------------------------------------------------------------------------- */

static void when_text(char *text, size_t text_bytes)
{
    const char *fixed = getenv("SOURCE_DATE_EPOCH"); /* for reports that are to be the same */
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
            parts, json_pack("{s:s, s:s, s:i, s:s, s:s, s:f, s:s}", "name", part->name, "state",
                             state_name(part->state), "exit", part->code, "command", part->command,
                             "why", part->why, "seconds", part->seconds, "known",
                             report_part_known(part) ? part->known : ""));
    }
    json_t *root = json_pack(
        "{s:s, s:i, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:o}", "raydiff", RAYDIFF_VERSION,
        "exit", report_code(report), "bytes", (json_int_t)bytes, "figures", (json_int_t)sum.figures,
        "answers", (json_int_t)sum.answers, "wrong", (json_int_t)sum.wrong, "bit_differences",
        (json_int_t)sum.bits, "findings", (json_int_t)sum.findings, "failing",
        (json_int_t)sum.failing, "known", (json_int_t)sum.known, "pictures",
        (json_int_t)report->picture_count, "parts", parts);
    return json_write(path, root, 9, reason);
}

static void print_sum(const struct report *report, const char *path, size_t bytes)
{
    struct report_sum sum = report_sum(report);
    printf("%s: %.1f kB, %zu parts, %zu figures\n", path, (double)bytes / 1e3, sum.parts,
           sum.figures);
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

/* Writes the page and what else is asked for. Returns the exit code. */
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

/* The scenes that are played if none is named and nothing is given. */
static char *own_scenes[] = {REPORT_DEFAULT_SCENES};

static int check_options(struct report_options *o)
{
    bool given = o->check_count + o->bench_count + o->picture_count > 0 || o->doctor || o->findings;
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
    struct report_options o = {.seconds = 600, .baseline = &baseline};
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
    int first, code = options_take("report", print_help, long_options, take_option, &o, argc, argv,
                                   &first);
    if (code < 0) {
        o.scene = argv + first;
        o.scene_count = (size_t)(argc - first);
        code = run_report(&o, &runner, command);
    }
    baseline_close(&baseline);
    return code;
}
