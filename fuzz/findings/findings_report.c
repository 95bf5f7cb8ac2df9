#include "fuzz/findings/findings_report.h"

#include "fuzz/findings/ci.h"

#include <stdio.h>
#include <string.h>

const char *report_state_name(enum findings_report_state state)
{
    static const char *const name[] = {"new", "known", "expired", "flaky"};
    return name[state];
}

bool report_counts(const struct report_finding *finding)
{
    return finding->state == REPORT_NEW || finding->state == REPORT_EXPIRED;
}

/* A test case and the text that it points into. */
struct written {
    struct ci_case one;
    char name[320], why[2048], detail[4096];
};

/* Called for each test case in order. */
typedef void case_fn(void *user, const struct ci_case *one);

static void case_of_campaign(const struct findings_report *report, struct written *out)
{
    char run[60] = ",";
    out->one =
        (struct ci_case){.group = "raydiff.fuzz",
                         .name = "trials",
                         .state = report->trials ? CI_PASSED : CI_FAILED,
                         .type = "vacuous",
                         .why = report->trials ? "" : "no trial was played: nothing is tested",
                         .detail = out->detail,
                         .seconds = report->seconds};
    if (report->before > 0)
        snprintf(run, sizeof run,
                 "; %llu of this run:", (unsigned long long)(report->trials - report->before));
    int used = snprintf(out->detail, sizeof out->detail,
                        "%llu trials of seed %llu%s %llu rays judged, %.1f s",
                        (unsigned long long)report->trials, (unsigned long long)report->seed, run,
                        (unsigned long long)report->judged, report->seconds);
    for (size_t i = 0; i < report->notes && used > 0 && (size_t)used < sizeof out->detail; i++)
        used += snprintf(out->detail + used, sizeof out->detail - (size_t)used, "\n%s",
                         report->note[i]);
}

/* "refused 3; its layout refused 4 of this run" */
static const char *refused_text(const struct report_contestant *who, char text[100])
{
    int used = snprintf(text, 100, "refused %llu", (unsigned long long)who->declined);
    if (who->refused > 0)
        snprintf(text + used, 100 - (size_t)used, "; its layout refused %llu of this run",
                 (unsigned long long)who->refused);
    return text;
}

static void case_of_contestant(const struct report_contestant *who, struct written *out)
{
    bool played = who->played > 0;
    char refused[100];
    snprintf(out->name, sizeof out->name, "%s.played", who->name);
    out->one = (struct ci_case){.group = "raydiff.fuzz",
                                .name = out->name,
                                .state = who->vacuous ? CI_FAILED
                                         : played     ? CI_PASSED
                                                      : CI_SKIPPED,
                                .type = "vacuous",
                                .why = out->why,
                                .detail = out->detail,
                                .seconds = who->seconds};
    out->why[0] = out->detail[0] = '\0';
    if (who->vacuous)
        snprintf(out->why, sizeof out->why, "%s: %llu played, %s", who->vacuous,
                 (unsigned long long)who->played, refused_text(who, refused));
    else if (who->played > 0)
        snprintf(out->detail, sizeof out->detail, "%llu trials played, %s",
                 (unsigned long long)who->played, refused_text(who, refused));
    else if (who->why && who->why[0])
        snprintf(out->why, sizeof out->why, "%s", who->why);
    else
        snprintf(out->why, sizeof out->why, "played no trial, %s", refused_text(who, refused));
}

/* Appends "LABEL: TEXT" if there is a text. */
static void add_line(struct written *out, const char *label, const char *text)
{
    size_t used = strlen(out->detail);
    if (text && text[0])
        snprintf(out->detail + used, sizeof out->detail - used, "%s%s: %s", used ? "\n" : "", label,
                 text);
}

static void case_of_finding(const struct report_finding *finding, struct written *out)
{
    static const enum ci_state state[] = {CI_FAILED, CI_KNOWN, CI_FAILED, CI_KNOWN};
    char size[200];
    const char *reason = finding->reason ? finding->reason : "";
    out->one = (struct ci_case){.group = "raydiff.fuzz",
                                .name = finding->signature,
                                .state = state[finding->state],
                                .type = report_state_name(finding->state),
                                .why = out->why,
                                .detail = out->detail};
    snprintf(out->why, sizeof out->why, "%s, found %llu time%s%s%s",
             report_state_name(finding->state), (unsigned long long)finding->count,
             finding->count == 1 ? "" : "s", reason[0] ? ": " : "", reason);
    snprintf(size, sizeof size, "%u triangle%s, %u vertices, %u ray%s", finding->triangles,
             finding->triangles == 1 ? "" : "s", finding->vertices, finding->rays,
             finding->rays == 1 ? "" : "s");
    out->detail[0] = '\0';
    add_line(out, "cause", finding->cause);
    add_line(out, "seen", finding->opinion);
    add_line(out, "replay", finding->replay);
    add_line(out, "smallest", finding->smallest);
    add_line(out, "size", finding->smallest && finding->smallest[0] ? size : "");
    add_line(out, "first", finding->first);
}

static size_t case_count(const struct findings_report *report)
{
    return 1 + report->contestants + report->findings;
}

static void each_case(const struct findings_report *report, case_fn *fn, void *user)
{
    struct written written;
    case_of_campaign(report, &written);
    fn(user, &written.one);
    for (size_t i = 0; i < report->contestants; i++) {
        case_of_contestant(&report->contestant[i], &written);
        fn(user, &written.one);
    }
    for (size_t i = 0; i < report->findings; i++) {
        case_of_finding(&report->finding[i], &written);
        fn(user, &written.one);
    }
}

static void count_failure(void *user, const struct ci_case *one)
{
    size_t *failures = user;
    *failures += one->state == CI_FAILED;
}

size_t report_failures(const struct findings_report *report)
{
    size_t failures = 0;
    each_case(report, count_failure, &failures);
    return failures;
}

static void add_junit(void *user, const struct ci_case *one)
{
    ci_junit_add(user, one);
}

enum status report_junit(const struct findings_report *report, const char *path,
                         struct reason *reason)
{
    struct ci_junit junit;
    enum status status = ci_junit_open(path, &junit, reason);
    if (status)
        return status;
    each_case(report, add_junit, &junit);
    return ci_junit_close(&junit, "raydiff fuzz", report->seconds, reason);
}

struct tap {
    FILE *to;
    size_t number;
};

static void add_tap(void *user, const struct ci_case *one)
{
    struct tap *tap = user;
    ci_tap_case(tap->to, ++tap->number, one);
}

enum status report_tap(const struct findings_report *report, const char *path,
                       struct reason *reason)
{
    struct file_out out;
    enum status status = file_out_open(path, &out, reason);
    if (status)
        return status;
    struct tap tap = {.to = out.stream};
    ci_tap_head(out.stream, case_count(report));
    each_case(report, add_tap, &tap);
    return file_out_commit(&out, reason);
}
