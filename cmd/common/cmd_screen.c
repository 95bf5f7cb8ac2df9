/* The width and the colours of the standard output, and text that fits it. */
#define _DEFAULT_SOURCE
#include "cmd/common/cmd_screen.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { COLOR_AUTO, COLOR_ALWAYS, COLOR_NEVER };
static const char *const when[] = {"auto", "always", "never", NULL};

#define ROWS_OF struct screen_options

const struct option_row screen_rows[] = {
    {"wide", NULL, "all columns and all counters, however long the lines", OF_FLAG(wide)},
    {"color", "WHEN", "auto (on a terminal, without NO_COLOR), always or never",
     OF_CHOICE(color, when), .value = "auto"},
    {0},
};

unsigned screen_width(int file)
{
    struct winsize size = {0};
    if (!isatty(file) || ioctl(file, TIOCGWINSZ, &size))
        return SCREEN_WIDTH;
    return size.ws_col > SCREEN_WIDTH ? size.ws_col : SCREEN_WIDTH;
}

static bool has_colours(unsigned color)
{
    const char *none = getenv("NO_COLOR"), *kind = getenv("TERM");
    if (color != COLOR_AUTO)
        return color == COLOR_ALWAYS;
    return isatty(STDOUT_FILENO) && !(none && *none) && kind && strcmp(kind, "dumb") != 0;
}

struct screen screen_make(const struct screen_options *options)
{
    return (struct screen){screen_width(STDOUT_FILENO), options->wide, has_colours(options->color),
                           isatty(STDOUT_FILENO) == 1};
}

void screen_paint(const struct screen *screen, enum paint paint)
{
    static const char *const code[] = {"\033[0m", "\033[1;31m", "\033[32m", "\033[2m"};
    if (screen->colour)
        fputs(code[paint], stdout);
}

/* Where the lines of a paragraph after the first begin. */
static size_t next_of(const char *text)
{
    size_t indent = strspn(text, " ");
    return indent ? indent + 2 : 4;
}

/* The same behind a title: one of nine letters, or one that two blanks end. */
static size_t next_of_titled(const char *text)
{
    size_t indent = strspn(text, " ");
    const char *gap = strstr(text + indent, "  ");
    size_t behind = gap ? (size_t)(gap - text) + strspn(gap, " ") : 0;
    if (behind > 0 && behind <= 12)
        return behind;
    return strcspn(text, " ") == 9 ? 10 : next_of(text);
}

/* Prints a paragraph; words are never broken. The first word has the colour. Lines after the first
 * begin at column `next`. */
static void print_filled(const struct screen *screen, const char *text, size_t width, size_t next,
                         enum paint paint)
{
    size_t indent = strspn(text, " "), at = indent;
    printf("%*s", (int)indent, "");
    text += indent;
    for (bool first = true; *text; first = false) {
        size_t gap = strspn(text, " "), word = strcspn(text + gap, " ");
        if (!first && at + gap + word > width) {
            printf("\n%*s", (int)next, "");
            at = next;
            gap = 0;
            text += strspn(text, " ");
        }
        if (first && paint)
            screen_paint(screen, paint);
        printf("%.*s", (int)(gap + word), text);
        if (first && paint)
            screen_paint(screen, PAINT_PLAIN);
        at += gap + word;
        text += gap + word;
    }
    putchar('\n');
}

void screen_text(const struct screen *screen, const char *format, ...)
{
    char text[2048];
    va_list args;
    va_start(args, format);
    if (screen->wide) {
        vprintf(format, args);
    } else {
        vsnprintf(text, sizeof text, format, args);
        text[strcspn(text, "\n")] = '\0';
        print_filled(screen, text, screen->width, next_of(text), PAINT_PLAIN);
    }
    va_end(args);
}

void screen_record(const struct screen *screen, enum paint paint, const char *format, ...)
{
    char text[2048];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    text[strcspn(text, "\n")] = '\0';
    bool fills = screen->terminal && !screen->wide;
    print_filled(screen, text, fills ? screen->width : SIZE_MAX, next_of(text), paint);
}

void screen_line(size_t next, const char *format, ...)
{
    const struct screen plain = {.colour = false};
    char text[4096];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    text[strcspn(text, "\n")] = '\0';
    const bool fills = isatty(STDOUT_FILENO) == 1;
    print_filled(&plain, text, fills ? screen_width(STDOUT_FILENO) : SIZE_MAX, next, PAINT_PLAIN);
}

void screen_page(const struct screen *screen, const char *text, const char *whole)
{
    char line[2048];
    for (const char *at = text; *at;) {
        size_t length = strcspn(at, "\n");
        if (screen->wide || length >= sizeof line || strncmp(at, whole, strlen(whole)) == 0) {
            printf("%.*s\n", (int)length, at);
        } else {
            snprintf(line, sizeof line, "%.*s", (int)length, at);
            print_filled(screen, line, screen->width, next_of_titled(line), PAINT_PLAIN);
        }
        at += length + (at[length] == '\n');
    }
}
