/* The list of pages, and their names. */
#include "cmd/web/cmd_web.h"

#include "bench/report/report_html.h"
#include "ref/base/text.h"

#include <string.h>

void web_name(const char *text, char name[WEB_NAME_MOST])
{
    size_t used = 0;
    for (; *text && used < WEB_NAME_MOST - 8; text++) {
        const bool plain = (*text >= 'a' && *text <= 'z') || (*text >= 'A' && *text <= 'Z') ||
                           (*text >= '0' && *text <= '9') || strchr("._-", *text);
        name[used] = plain && (used > 0 || *text != '.') ? *text : '-';
        used++;
    }
    name[used] = '\0';
}

void web_index_write(FILE *out, const struct web_entry *entry, size_t count)
{
    struct html html = {.out = out};
    char link[WEB_NAME_MOST + 8];
    web_html_begin(&html, "raydiff web");
    html_element(&html, "h1", NULL, "Pages");
    html_table(&html, NULL, NULL);
    html_heads(&html, "page;of;answer;cause");
    html_body(&html);
    for (size_t i = 0; i < count; i++) {
        html_begin(&html, "tr", NULL, NULL);
        html_begin(&html, "td", NULL, NULL);
        snprintf(link, sizeof link, "%s.html", entry[i].name);
        if (entry[i].why.text[0])
            html_text(&html, entry[i].name);
        else {
            html_begin(&html, "a", "href", link, NULL);
            html_text(&html, entry[i].name);
            html_end(&html, "a");
        }
        html_end(&html, "td");
        html_element(&html, "td", NULL, entry[i].subject);
        if (entry[i].why.text[0]) {
            html_begin(&html, "td", "colspan", "2", NULL);
            html_format(&html, "no page: %s", entry[i].why.text);
            html_end(&html, "td");
        } else {
            html_element(&html, "td", NULL, entry[i].verdict);
            html_element(&html, "td", NULL, entry[i].cause);
        }
        html_end(&html, "tr");
    }
    html_table_end(&html);
    web_html_end(&html);
}
