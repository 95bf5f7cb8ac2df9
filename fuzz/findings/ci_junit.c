#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "fuzz/findings/ci.h"

#include <stdlib.h>

enum status ci_junit_open(const char *path, struct ci_junit *out, struct reason *reason)
{
    *out = (struct ci_junit){.cases = 0};
    enum status status = file_out_open(path, &out->out, reason);
    if (status)
        return status;
    out->body = open_memstream(&out->text, &out->bytes);
    if (out->body)
        return STATUS_OK;
    ci_junit_discard(out);
    return fail(reason, STATUS_MEMORY, "no memory for the results");
}

static void put_attribute(FILE *to, const char *name, const char *text)
{
    fprintf(to, " %s=\"", name);
    ci_xml(to, text);
    fputc('"', to);
}

void ci_junit_add(struct ci_junit *junit, const struct ci_case *one)
{
    FILE *to = junit->body;
    const char *detail = one->detail ? one->detail : "";
    bool failed = one->state == CI_FAILED, passed = one->state == CI_PASSED;
    junit->cases++;
    junit->failures += failed;
    junit->skipped += !failed && !passed;
    fputs("<testcase", to);
    put_attribute(to, "classname", one->group);
    put_attribute(to, "name", one->name);
    fprintf(to, " time=\"%.3f\">", one->seconds);
    if (!passed) {
        fputs(failed ? "<failure" : "<skipped", to);
        put_attribute(to, "message", one->why ? one->why : "");
        if (failed)
            put_attribute(to, "type", one->type ? one->type : "failure");
        fputc('>', to);
        if (failed)
            ci_xml(to, detail);
        fputs(failed ? "</failure>" : "</skipped>", to);
    }
    if (!failed && detail[0]) { /* only a failure has a text of its own everywhere */
        fputs("<system-out>", to);
        ci_xml(to, detail);
        fputs("</system-out>", to);
    }
    fputs("</testcase>\n", to);
}

static void put_numbers(FILE *to, const struct ci_junit *junit, const char *name, double seconds)
{
    put_attribute(to, "name", name);
    fprintf(to, " tests=\"%zu\" failures=\"%zu\" errors=\"0\" skipped=\"%zu\" time=\"%.3f\">\n",
            junit->cases, junit->failures, junit->skipped, seconds);
}

enum status ci_junit_close(struct ci_junit *junit, const char *suite, double seconds,
                           struct reason *reason)
{
    FILE *to = junit->out.stream;
    bool good = !ferror(junit->body);
    good = fclose(junit->body) == 0 && good;
    junit->body = NULL;
    enum status status = STATUS_OK;
    if (good) {
        fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites", to);
        put_numbers(to, junit, suite, seconds);
        fputs("<testsuite", to);
        put_numbers(to, junit, suite, seconds);
        fwrite(junit->text, 1, junit->bytes, to);
        fputs("</testsuite>\n</testsuites>\n", to);
        status = file_out_commit(&junit->out, reason);
    } else {
        status =
            fail(reason, STATUS_MEMORY, "no memory for the results of %zu cases", junit->cases);
    }
    ci_junit_discard(junit);
    return status;
}

void ci_junit_discard(struct ci_junit *junit)
{
    if (junit->body)
        fclose(junit->body);
    free(junit->text);
    file_out_discard(&junit->out);
    *junit = (struct ci_junit){.cases = 0};
}
