#include "fuzz/findings/ci.h"
#include "fuzz/findings/findings_report.h"

#include <stdio.h>

/* The members of an object, one after another. */
static void put_name(FILE *to, const char *name)
{
    fprintf(to, ", \"%s\": ", name);
}

static void put_text(FILE *to, const char *name, const char *text)
{
    put_name(to, name);
    if (text && text[0])
        ci_quote(to, text);
    else
        fputs("null", to);
}

static void put_whole(FILE *to, const char *name, uint64_t number)
{
    put_name(to, name);
    fprintf(to, "%llu", (unsigned long long)number);
}

static void put_real(FILE *to, const char *name, double number)
{
    put_name(to, name);
    fprintf(to, "%.9g", number);
}

static void put_campaign(FILE *to, const struct findings_report *report)
{
    double seconds = report->seconds > 0 ? report->seconds : 1e-9;
    char seed[32]; /* as text: readers of JSON have no numbers of 64 bits */
    snprintf(seed, sizeof seed, "%llu", (unsigned long long)report->seed);
    fputs("{\"type\": \"campaign\", \"version\": 1", to);
    put_text(to, "seed", seed);
    put_whole(to, "trials", report->trials);
    put_whole(to, "trials_before", report->before);
    put_whole(to, "judged_rays", report->judged);
    put_real(to, "seconds", report->seconds);
    put_real(to, "trials_per_s", (double)(report->trials - report->before) / seconds);
    put_real(to, "judged_rays_per_s", (double)report->judged / seconds);
    put_real(to, "harness_share", report->harness_share);
    put_whole(to, "failures", report_failures(report));
    fputs("}\n", to);
}

static void put_finding(FILE *to, const struct report_finding *finding)
{
    fputs("{\"type\": \"finding\"", to);
    put_text(to, "signature", finding->signature);
    put_text(to, "state", report_state_name(finding->state));
    put_name(to, "counts");
    fputs(report_counts(finding) ? "true" : "false", to);
    put_whole(to, "count", finding->count);
    put_text(to, "reason", finding->reason);
    put_text(to, "cause", finding->cause);
    put_text(to, "seen", finding->opinion);
    put_whole(to, "triangles", finding->triangles);
    put_whole(to, "rays", finding->rays);
    put_whole(to, "vertices", finding->vertices);
    put_text(to, "first", finding->first);
    put_text(to, "smallest", finding->smallest);
    put_text(to, "replay", finding->replay);
    fputs("}\n", to);
}

enum status report_jsonl(const struct findings_report *report, const char *path,
                         struct reason *reason)
{
    struct file_out out;
    enum status status = file_out_open(path, &out, reason);
    if (status)
        return status;
    put_campaign(out.stream, report);
    for (size_t i = 0; i < report->contestants; i++) {
        const struct report_contestant *who = &report->contestant[i];
        fputs("{\"type\": \"contestant\"", out.stream);
        put_text(out.stream, "name", who->name);
        put_whole(out.stream, "played", who->played);
        put_whole(out.stream, "refused", who->declined);
        put_whole(out.stream, "refused_in_this_run", who->refused);
        put_real(out.stream, "seconds", who->seconds);
        put_text(out.stream, "why", who->vacuous ? who->vacuous : who->played ? "" : who->why);
        fputs("}\n", out.stream);
    }
    for (size_t i = 0; i < report->findings; i++)
        put_finding(out.stream, &report->finding[i]);
    for (size_t i = 0; i < report->notes; i++) {
        fputs("{\"type\": \"note\"", out.stream);
        put_text(out.stream, "text", report->note[i]);
        fputs("}\n", out.stream);
    }
    return file_out_commit(&out, reason);
}
