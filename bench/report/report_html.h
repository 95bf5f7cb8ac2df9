/* A small HTML writer whose output is also well-formed XML: every element is closed, every
 * attribute is quoted, all text is escaped. Independent of reports. */
#ifndef REPORT_HTML_H
#define REPORT_HTML_H

#include "ref/base/base.h"

#include <stdio.h>

#define HTML_DEPTH 32

/* A page being written. Write errors stay in the stream for its owner. */
struct html {
    FILE *out;
    const char *open[HTML_DEPTH]; /* open elements */
    size_t depth;
};

/* Opens an element. Attributes follow as pairs of name and value, ended by NULL; a NULL value omits
 * its attribute. Values are escaped; tag and names must be trusted. */
void html_begin(struct html *html, const char *tag, ...) __attribute__((sentinel));

/* Closes the innermost element, which must be `tag`. */
void html_end(struct html *html, const char *tag);

/* Writes an element without content, with arguments as for html_begin. */
void html_void(struct html *html, const char *tag, ...) __attribute__((sentinel));

/* Writes text. Characters with a meaning in HTML are escaped; anything but printable UTF-8 becomes
 * '?'. */
void html_text(struct html *html, const char *text);
void html_format(struct html *html, const char *format, ...) PRINTF_LIKE(2, 3);

/* Writes a whole element with text; `css` is its class, or NULL. */
void html_element(struct html *html, const char *tag, const char *css, const char *text);
void html_element_format(struct html *html, const char *tag, const char *css, const char *format,
                         ...) PRINTF_LIKE(4, 5);

/* Write a table. html_table opens it with its class and caption (NULL: none) and starts the line of
 * heads; html_heads adds heads to that line; html_body ends it; rows follow until html_table_end.
 * Heads are names separated by ';', with '#' before the name of a numeric column: "part;state;#exit
 * code". */
void html_table(struct html *html, const char *css, const char *caption);
void html_heads(struct html *html, const char *heads);
void html_body(struct html *html);
void html_table_end(struct html *html);

/* Embeds a picture in the page as a data: URI. */
void html_png(struct html *html, const char *alt, uint32_t width, uint32_t height,
              const void *bytes, size_t size);

/* Writes bytes as base64 (RFC 4648, with padding). */
void html_base64(FILE *out, const void *bytes, size_t size);

#endif
