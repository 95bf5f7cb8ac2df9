/* The page around the sections. */
#include "bench/report/report_inner.h"

#include <string.h>

void section_begin(struct html *html, const char *id, const char *title)
{
    html_begin(html, "section", "id", id, NULL);
    html_element(html, "h2", NULL, title);
}

void section_end(struct html *html)
{
    html_end(html, "section");
}

bool section_reasons(struct html *html, const struct report *report, enum report_kind kind,
                     const char *how)
{
    bool any = false;
    for (size_t i = 0; i < report->part_count; i++) {
        const struct report_part *part = &report->part[i];
        if (part->kind != kind)
            continue;
        any = any || part->json;
        if (part->state != REPORT_SKIPPED && part->state != REPORT_FAILED)
            continue;
        bool failed = part->state == REPORT_FAILED;
        html_element_format(html, "p", failed ? "note bad" : "note", "%s %s: %s", part->name,
                            failed ? "failed" : "was skipped",
                            part->why[0] ? part->why : "no reason given");
    }
    if (!report->wanted[kind])
        html_element_format(html, "p", "note", "Not part of this report. %s", how);
    return any;
}

static void put_head(struct html *html, const struct report *report)
{
    html_begin(html, "head", NULL);
    html_void(html, "meta", "charset", "utf-8", NULL);
    html_void(html, "meta", "name", "viewport", "content", "width=device-width, initial-scale=1",
              NULL);
    /* The page loads nothing. This policy makes browsers refuse to load anything. */
    html_void(html, "meta", "http-equiv", "Content-Security-Policy", "content",
              "default-src 'none'; style-src 'unsafe-inline'; img-src data:", NULL);
    html_element(html, "title", NULL, report->title);
    fprintf(html->out, "<style>\n%s</style>\n", report_style);
    html_end(html, "head");
}

static const char *const sections[][2] = {
    {"summary", "1 Verdict"},   {"agreement", "2 Agreement"}, {"speed", "3 Speed and size"},
    {"pictures", "4 Pictures"}, {"findings", "5 Findings"},   {"machine", "6 Machine"},
    {"commands", "7 Commands"}};

void report_finding_id(size_t p, char id[REPORT_ID])
{
    snprintf(id, REPORT_ID, "finding-%zu", p + 1);
}

static void put_link(struct html *html, const char *id, const char *text)
{
    char to[REPORT_ID + 1];
    snprintf(to, sizeof to, "#%s", id);
    html_begin(html, "a", "href", to, NULL);
    html_text(html, text);
    html_end(html, "a");
}

static void put_navigation(struct html *html)
{
    html_begin(html, "nav", NULL);
    for (size_t i = 0; i < ARRAY_COUNT(sections); i++)
        put_link(html, sections[i][0], sections[i][1]);
    html_end(html, "nav");
}

static void put_finding_links(struct html *html, const struct report *report)
{
    bool any = false;
    for (size_t p = 0; p < report->part_count; p++) {
        char id[REPORT_ID];
        if (report->part[p].kind != REPORT_FINDING || !report->part[p].name[0])
            continue;
        if (!any)
            html_begin(html, "ul", NULL);
        any = true;
        report_finding_id(p, id);
        html_begin(html, "li", NULL);
        put_link(html, id, report->part[p].name);
        html_end(html, "li");
    }
    if (any)
        html_end(html, "ul");
}

void report_contents(struct html *html, const struct report *report)
{
    html_begin(html, "ul", "class", "contents", NULL);
    for (size_t i = 0; i < ARRAY_COUNT(sections); i++) {
        html_begin(html, "li", NULL);
        put_link(html, sections[i][0], sections[i][1]);
        if (strcmp(sections[i][0], "findings") == 0)
            put_finding_links(html, report);
        html_end(html, "li");
    }
    html_end(html, "ul");
}

enum status report_write(const struct report *report, FILE *out, struct reason *reason)
{
    struct html html = {.out = out};
    fputs("<!DOCTYPE html>\n", out);
    html_begin(&html, "html", "lang", "en", NULL);
    put_head(&html, report);
    html_begin(&html, "body", NULL);
    put_navigation(&html);
    html_begin(&html, "main", NULL);
    report_summary(&html, report);
    report_agreement(&html, report);
    enum status status = report_speed(&html, report, reason);
    report_pictures(&html, report);
    report_findings(&html, report);
    report_machine(&html, report);
    report_commands(&html, report);
    html_end(&html, "main");
    html_end(&html, "body");
    html_end(&html, "html");
    fputc('\n', out);
    return status;
}
