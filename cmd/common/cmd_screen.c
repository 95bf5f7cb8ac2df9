/* The width and the colours of the standard output, and text that fits it. */
#define _DEFAULT_SOURCE
#include "cmd/common/cmd_screen.h"

#include <stdarg.h>
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

static unsigned terminal_width(void)
{
    struct winsize size = {0};
    if (!isatty(STDOUT_FILENO) || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size))
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
    return (struct screen){terminal_width(), options->wide, has_colours(options->color)};
}

void screen_paint(const struct screen *screen, enum paint paint)
{
    static const char *const code[] = {"\033[0m", "\033[1;31m", "\033[32m", "\033[2m"};
    if (screen->colour)
        fputs(code[paint], stdout);
}

/* Prints a paragraph; words are never broken. */
static void print_filled(const char *text, size_t width)
{
    size_t indent = strspn(text, " "), at = indent, next = indent ? indent + 2 : 4;
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
        printf("%.*s", (int)(gap + word), text);
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
        print_filled(text, screen->width);
    }
    va_end(args);
}
