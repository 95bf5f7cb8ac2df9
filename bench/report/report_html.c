#include "bench/report/report_html.h"

#include "fuzz/findings/ci.h"

#include <assert.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* True for elements whose children go on separate lines. This keeps the file readable and does not
 * change the page. */
static bool is_block(const char *tag)
{
    static const char *const blocks[] = {"html",  "head",    "body",  "main", "section",
                                         "table", "thead",   "tbody", "tr",   "figure",
                                         "div",   "details", "ul",    "nav",  "header"};
    for (size_t i = 0; i < ARRAY_COUNT(blocks); i++)
        if (strcmp(tag, blocks[i]) == 0)
            return true;
    return false;
}

static void put_tag(struct html *html, const char *tag, va_list attributes)
{
    fprintf(html->out, "<%s", tag);
    const char *name;
    while ((name = va_arg(attributes, const char *)) != NULL) {
        const char *value = va_arg(attributes, const char *);
        if (!value)
            continue;
        fprintf(html->out, " %s=\"", name);
        ci_xml(html->out, value);
        fputc('"', html->out);
    }
}

void html_begin(struct html *html, const char *tag, ...)
{
    assert(html->depth < HTML_DEPTH);
    va_list attributes;
    va_start(attributes, tag);
    put_tag(html, tag, attributes);
    va_end(attributes);
    fputs(is_block(tag) ? ">\n" : ">", html->out);
    html->open[html->depth++] = tag;
}

void html_end(struct html *html, const char *tag)
{
    assert(html->depth > 0 && strcmp(html->open[html->depth - 1], tag) == 0);
    html->depth--;
    fprintf(html->out, "</%s>", tag);
    if (html->depth > 0 && is_block(html->open[html->depth - 1]))
        fputc('\n', html->out);
}

void html_void(struct html *html, const char *tag, ...)
{
    va_list attributes;
    va_start(attributes, tag);
    put_tag(html, tag, attributes);
    va_end(attributes);
    fputs("/>", html->out);
    if (html->depth > 0 && is_block(html->open[html->depth - 1]))
        fputc('\n', html->out);
}

void html_text(struct html *html, const char *text)
{
    ci_xml(html->out, text);
}

static void put_format(struct html *html, const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    char small[256];
    int length = vsnprintf(small, sizeof small, format, args);
    char *large = length >= (int)sizeof small ? malloc((size_t)length + 1) : NULL;
    if (large)
        vsnprintf(large, (size_t)length + 1, format, again);
    va_end(again);
    html_text(html, large ? large : small); /* without memory as much as fits */
    free(large);
}

void html_format(struct html *html, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    put_format(html, format, args);
    va_end(args);
}

void html_element(struct html *html, const char *tag, const char *css, const char *text)
{
    html_begin(html, tag, "class", css, NULL);
    html_text(html, text);
    html_end(html, tag);
}

void html_element_format(struct html *html, const char *tag, const char *css, const char *format,
                         ...)
{
    va_list args;
    html_begin(html, tag, "class", css, NULL);
    va_start(args, format);
    put_format(html, format, args);
    va_end(args);
    html_end(html, tag);
}

void html_table(struct html *html, const char *css, const char *caption)
{
    html_begin(html, "table", "class", css, NULL);
    if (caption)
        html_element(html, "caption", NULL, caption);
    html_begin(html, "thead", NULL);
    html_begin(html, "tr", NULL);
}

void html_heads(struct html *html, const char *heads)
{
    for (const char *at = heads; *at;) {
        bool number = *at == '#';
        at += number;
        size_t length = strcspn(at, ";");
        html_element_format(html, "th", number ? "n" : NULL, "%.*s", (int)length, at);
        at += length + (at[length] == ';');
    }
}

void html_body(struct html *html)
{
    html_end(html, "tr");
    html_end(html, "thead");
    html_begin(html, "tbody", NULL);
}

void html_table_end(struct html *html)
{
    html_end(html, "tbody");
    html_end(html, "table");
}

void html_base64(FILE *out, const void *bytes, size_t size)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char *from = bytes;
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        uint32_t three = (uint32_t)from[i] << 16 | (left > 1 ? (uint32_t)from[i + 1] << 8 : 0) |
                         (left > 2 ? (uint32_t)from[i + 2] : 0);
        fputc(digit[three >> 18], out);
        fputc(digit[three >> 12 & 63], out);
        fputc(left > 1 ? digit[three >> 6 & 63] : '=', out);
        fputc(left > 2 ? digit[three & 63] : '=', out);
    }
}

void html_png(struct html *html, const char *alt, uint32_t width, uint32_t height,
              const void *bytes, size_t size)
{
    fprintf(html->out, "<img width=\"%u\" height=\"%u\" alt=\"", width, height);
    ci_xml(html->out, alt);
    fputs("\" src=\"data:image/png;base64,", html->out);
    html_base64(html->out, bytes, size);
    fputs("\"/>\n", html->out);
}
