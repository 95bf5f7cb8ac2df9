/* Section 1: the report's contents and the verdict. */
#include "bench/report/report_inner.h"

#include "ref/base/command.h"

/* The meaning of a part's exit code. */
static const char *code_text(const struct report_part *part)
{
    switch (part->code) {
    case EXIT_AGREE:
        return part->kind == REPORT_FINDING ? "does not fail any more" : "agrees";
    case EXIT_MISMATCH:
        return report_part_known(part)        ? "still fails, as is known"
               : part->kind == REPORT_FINDING ? "still fails"
                                              : "mismatch, or it proves nothing";
    case EXIT_USAGE:
        return "bad input";
    case EXIT_ENGINE:
        return "an engine crashed, hung or could not finish";
    case EXIT_INTERNAL:
        return "internal error";
    case EXIT_SKIPPED:
        return "something cannot run here";
    default:
        return "ended by a signal";
    }
}

static const char *state_text(enum report_state state)
{
    static const char *const text[] = {"done", "from a file", "skipped", "FAILED"};
    return text[state];
}

static void put_part(struct html *html, const struct report_part *part)
{
    bool bad = part->state == REPORT_FAILED || report_part_code(part) == EXIT_MISMATCH ||
               report_part_code(part) == EXIT_ENGINE || report_part_code(part) == EXIT_INTERNAL;
    html_begin(html, "tr", NULL);
    html_begin(html, "th", "scope", "row", NULL);
    html_text(html, part->name);
    html_end(html, "th");
    html_element(html, "td",
                 bad                             ? "bad"
                 : part->state == REPORT_SKIPPED ? "none"
                                                 : "good",
                 state_text(part->state));
    html_element_format(html, "td", "n", "%d", part->code);
    html_element(html, "td", NULL, code_text(part));
    if (part->seconds > 0.0)
        html_element_format(html, "td", "n", "%.1f", part->seconds);
    else
        html_element(html, "td", "n", "");
    html_element(html, "td", "wrap", part->why);
    html_end(html, "tr");
}

static void put_parts(struct html *html, const struct report *report)
{
    html_table(html, NULL, NULL);
    html_heads(html, "part;state;#exit code;meaning;#s;it said");
    html_body(html);
    for (size_t i = 0; i < report->part_count; i++)
        put_part(html, &report->part[i]);
    html_table_end(html);
}

static void put_sums(struct html *html, const struct report_sum *sum)
{
    html_begin(html, "ul", NULL);
    if (sum->rows > 0) {
        html_element_format(html, "li", NULL,
                            "%zu of %zu judged answers WRONG against the exact truth; %zu differ "
                            "from it in an allowed class",
                            sum->wrong, sum->answers, sum->allowed);
        html_element_format(html, "li", NULL,
                            "%zu answers with other bits than engine cpu's, where the same bits "
                            "are demanded",
                            sum->bits);
    }
    if (sum->published > 0)
        html_element_format(html, "li", NULL,
                            "%zu answers of members as published are wrong: counted, not judged",
                            sum->published);
    if (sum->findings > 0)
        html_element_format(html, "li", NULL,
                            "%zu of %zu findings are still there when played again, %zu more as "
                            "the baseline knows",
                            sum->failing, sum->findings, sum->known);
    if (sum->skipped > 0 || sum->failed > 0)
        html_element_format(html, "li", NULL, "of %zu parts %zu failed and %zu were skipped",
                            sum->parts, sum->failed, sum->skipped);
    html_end(html, "ul");
}

static void put_verdict(struct html *html, const struct report *report,
                        const struct report_sum *sum)
{
    int code = report_code(report);
    const char *look = code == EXIT_AGREE ? "verdict good" : "verdict bad";
    html_begin(html, "p", "class", code == EXIT_SKIPPED || sum->parts == 0 ? "verdict none" : look,
               NULL);
    if (sum->parts == 0)
        html_text(html, "No part was requested");
    else if (code == EXIT_AGREE)
        html_text(html, "Everything agrees");
    else if (code == EXIT_SKIPPED)
        html_text(html, "Everything that ran agrees; some parts could not run");
    else if (sum->wrong + sum->bits > 0)
        html_format(html, "WRONG answers: %zu; with other bits: %zu", sum->wrong, sum->bits);
    else if (sum->failing > 0)
        html_format(html, "%zu finding%s still there", sum->failing,
                    sum->failing == 1 ? " is" : "s are");
    else
        html_text(html, "A part has no good result: see below");
    html_format(html, " (exit code %d)", code);
    html_end(html, "p");
}

void report_summary(struct html *html, const struct report *report)
{
    struct report_sum sum = report_sum(report);
    html_begin(html, "section", "id", "summary", NULL);
    html_element(html, "h1", NULL, report->title);
    html_element_format(html, "p", "dim",
                        "%s, by raydiff %s; %zu figures; this file needs nothing "
                        "but itself",
                        report->when, RAYDIFF_VERSION, sum.figures);
    put_verdict(html, report, &sum);
    put_sums(html, &sum);
    html_element(html, "h2", NULL, "Contents");
    report_contents(html, report);
    put_parts(html, report);
    section_end(html);
}
