/* Reads an SVG of bench/chart element by element: each stands on a line of its own. Includes
 * cmocka.h. */
#ifndef SVG_READER_H
#define SVG_READER_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GRID "stroke=\"#dddddd\""
#define NEAR 0.16 /* the SVG has one decimal */

/* A reader that takes one line, which is one element, after the other. */
struct svg_reader {
    char *text, *next;
    double width, height;
};

static struct svg_reader opened(char *text)
{
    struct svg_reader r = {.text = text, .next = text};
    char *box = strstr(text, "viewBox=\"0 0 ");
    assert_non_null(box);
    assert_int_equal(sscanf(box, "viewBox=\"0 0 %lf %lf\"", &r.width, &r.height), 2);
    char *white = strstr(text, "fill=\"#ffffff\"/>\n");
    assert_non_null(white);
    r.next = strchr(white, '\n') + 1;
    return r;
}

/* The next element; NULL behind the last. */
static char *next_line(struct svg_reader *r)
{
    char *line = r->next, *end = strchr(line, '\n');
    assert_non_null(end);
    if (strncmp(line, "</svg>", 6) == 0)
        return NULL;
    *end = '\0';
    r->next = end + 1;
    return line;
}

static void near(double is, double wanted, const char *what)
{
    if (!(fabs(is - wanted) <= NEAR))
        fail_msg("%s: at %g, not at %g", what, is, wanted);
}

static void inside(const struct svg_reader *r, double x, double y, const char *line)
{
    if (!(x >= 0 && x <= r->width && y >= 0 && y <= r->height))
        fail_msg("outside the picture: %s", line);
}

static void read_line(const struct svg_reader *r, const char *line, double at[4])
{
    if (!line || sscanf(line, "<line x1=\"%lf\" y1=\"%lf\" x2=\"%lf\" y2=\"%lf\"", &at[0], &at[1],
                        &at[2], &at[3]) != 4)
        fail_msg("no line: %s", line ? line : "the end");
    inside(r, at[0], at[1], line);
    inside(r, at[2], at[3], line);
}

/* A text and where it stands. */
static char *read_text(const struct svg_reader *r, char *line, double *x, double *y)
{
    if (!line || (sscanf(line, "<text x=\"%lf\" y=\"%lf\"", x, y) != 2 &&
                  sscanf(line, "<text transform=\"translate(%lf,%lf)", x, y) != 2))
        fail_msg("no text: %s", line ? line : "the end");
    inside(r, *x, *y, line);
    char *text = strchr(line, '>') + 1;
    *strstr(text, "</text>") = '\0';
    return text;
}

static void read_marker(const struct svg_reader *r, const char *line, double *x, double *y)
{
    if (!line || (sscanf(line, "<circle cx=\"%lf\" cy=\"%lf\"", x, y) != 2 &&
                  sscanf(line, "<path transform=\"translate(%lf,%lf)", x, y) != 2))
        fail_msg("no marker: %s", line ? line : "the end");
    inside(r, *x, *y, line);
}

#define TICKS_READ 40

/* Ticks along x (0) and y (1): what is printed and where; the frame around. */
struct sheet_panel {
    double value[2][TICKS_READ], at[2][TICKS_READ], span[2][TICKS_READ][2];
    size_t count[2];
    double left, top, right, bottom;
};

/* Reads the grid and returns what follows: each grid line is straight, its number beside it. */
static char *read_grid(struct svg_reader *r, struct sheet_panel *p)
{
    double x, y;
    char *line;
    p->count[0] = p->count[1] = 0;
    while ((line = next_line(r)) && strstr(line, GRID)) {
        double at[4];
        read_line(r, line, at);
        int axis = fabs(at[0] - at[2]) <= 0 ? 0 : 1;
        assert_true(fabs(at[axis] - at[axis + 2]) <= 0);
        size_t i = p->count[axis]++;
        assert_true(i < TICKS_READ);
        p->span[axis][i][0] = fmin(at[1 - axis], at[3 - axis]);
        p->span[axis][i][1] = fmax(at[1 - axis], at[3 - axis]);
        p->at[axis][i] = at[axis];
        p->value[axis][i] = strtod(read_text(r, next_line(r), &x, &y), NULL);
        near(axis == 0 ? x : y - 4, at[axis], "a tick's number");
        assert_true(axis == 0 ? y > p->span[0][i][1] + 8 : x < p->span[1][i][0]);
    }
    assert_non_null(line);
    assert_true(p->count[0] >= 2 && p->count[1] >= 2);
    return line;
}

/* Grid lines reach from side to side of the frame. */
static void check_grid(const struct svg_reader *r, const struct sheet_panel *p)
{
    inside(r, p->left, p->top, "the frame's begin");
    inside(r, p->right, p->bottom, "the frame's end");
    for (int axis = 0; axis < 2; axis++)
        for (size_t i = 0; i < p->count[axis]; i++) {
            near(p->span[axis][i][0], axis ? p->left : p->top, "a grid line's begin");
            near(p->span[axis][i][1], axis ? p->right : p->bottom, "a grid line's end");
        }
}

#endif
