/* Section 7: the commands that make every part again. */
#include "bench/report/report_inner.h"

#include <string.h>

void report_commands(struct html *html, const struct report *report)
{
    section_begin(html, "commands", "7 Commands");
    html_element(
        html, "p", NULL,
        "Each part again, with its results in files; and this page from them. What runs on "
        "other machines may differ in speed, and where a driver's arithmetic does.");
    for (size_t i = 0; i < report->part_count; i++) {
        const struct report_part *part = &report->part[i];
        if (part->kind != REPORT_FINDING) /* the findings section shows its own */
            html_element(html, "pre", "line", part->command);
    }
    html_element(html, "p", NULL, "The whole:");
    html_element(html, "pre", "line", report->command);
    section_end(html);
}
