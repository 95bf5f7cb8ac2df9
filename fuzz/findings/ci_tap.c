#include "fuzz/findings/ci.h"

#include <string.h>

void ci_tap_head(FILE *to, size_t cases)
{
    ci_tap_version(to);
    ci_tap_plan(to, cases);
}

void ci_tap_version(FILE *to)
{
    fputs("TAP version 13\n", to);
}

void ci_tap_plan(FILE *to, size_t cases)
{
    fprintf(to, "1..%zu\n", cases);
}

/* A literal block, which YAML and prove read alike: its lines are not empty and begin at one
 * column.
 */
static void put_detail(FILE *to, const char *text)
{
    fputs("  detail: |\n", to);
    while (*text) {
        char line[1024];
        size_t blank = strspn(text, " \t\n"), length = strcspn(text + blank, "\n");
        text += blank;
        snprintf(line, sizeof line, "%.*s", (int)(length < 1000 ? length : 1000), text);
        if (line[0]) {
            fputs("    ", to);
            ci_plain(to, line);
            fputc('\n', to);
        }
        text += length;
    }
}

void ci_tap_case(FILE *to, size_t number, const struct ci_case *one)
{
    bool fails = one->state == CI_FAILED || one->state == CI_KNOWN;
    bool has_why = one->why && one->why[0], has_detail = one->detail && one->detail[0];
    fprintf(to, "%sok %zu - ", fails ? "not " : "", number);
    ci_line(to, one->name);
    if (one->state == CI_KNOWN || one->state == CI_SKIPPED) {
        fputs(one->state == CI_KNOWN ? " # TODO " : " # SKIP ", to);
        ci_line(to, has_why ? one->why : "");
    }
    fputc('\n', to);
    if (one->state != CI_FAILED && !has_detail)
        return;
    fputs("  ---\n", to);
    if (has_why) {
        fputs("  message: ", to);
        ci_quote(to, one->why);
        fputc('\n', to);
    }
    fprintf(to, "  severity: %s\n", one->state == CI_FAILED ? "fail" : "comment");
    if (one->seconds > 0)
        fprintf(to, "  seconds: %.3f\n", one->seconds);
    if (has_detail)
        put_detail(to, one->detail);
    fputs("  ...\n", to);
}
