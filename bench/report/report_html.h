/* A small writer of HTML that is well-formed XML, too: every element is closed, every attribute
 * quoted, all text escaped. Knows nothing of reports. */
#ifndef REPORT_HTML_H
#define REPORT_HTML_H

#include "ref/base/base.h"

#include <stdio.h>

#define HTML_DEPTH 32

/* A page being written. Write errors are left in the stream for its owner. */
struct html {
    FILE *out;
    const char *open[HTML_DEPTH]; /* elements that are not closed yet */
    size_t depth;
};

/* Opens an element. Attributes follow as pairs of name and value, ended by NULL; a NULL value
 * leaves its attribute out. Tag and names are our own, values are escaped. */
void html_begin(struct html *html, const char *tag, ...) __attribute__((sentinel));

/* Closes the innermost element, which must be `tag`. */
void html_end(struct html *html, const char *tag);

/* An element without content, as html_begin. */
void html_void(struct html *html, const char *tag, ...) __attribute__((sentinel));

/* Text: what HTML gives a meaning is escaped; what is no printable UTF-8 becomes '?'. */
void html_text(struct html *html, const char *text);
void html_format(struct html *html, const char *format, ...) PRINTF_LIKE(2, 3);

/* A whole element of text; `css` is its class, or NULL. */
void html_element(struct html *html, const char *tag, const char *css, const char *text);
void html_element_format(struct html *html, const char *tag, const char *css, const char *format,
                         ...) PRINTF_LIKE(4, 5);

/* A table: html_table opens it with its class and caption (NULL: none) and a line of heads,
 * html_heads adds heads to that line, html_body ends it, and rows follow until html_table_end.
 * Heads are names with ';' between them; '#' stands before a name whose column is of numbers:
 * "part;state;#exit code". */
void html_table(struct html *html, const char *css, const char *caption);
void html_heads(struct html *html, const char *heads);
void html_body(struct html *html);
void html_table_end(struct html *html);

/* A picture inside the page, as a data: URI. */
void html_png(struct html *html, const char *alt, uint32_t width, uint32_t height,
              const void *bytes, size_t size);

/* Writes bytes as base64 (RFC 4648, with padding). */
void html_base64(FILE *out, const void *bytes, size_t size);

#endif
