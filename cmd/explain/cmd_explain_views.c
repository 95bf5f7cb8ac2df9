/* Views of an explained ray as SVG, and as JSON for the script that turns them. */
#include "cmd/explain/cmd_explain_picture.h"

#include "fuzz/findings/ci.h"
#include "ref/files/file.h"

#include <math.h>
#include <stdlib.h>

const char picture_style[] =
    ".other{fill:#b9c2cb;fill-opacity:.25;stroke:#b9c2cb}\n"
    ".expected{fill:#e08a00;fill-opacity:.55;stroke:#e08a00}\n"
    ".answered{fill:#7a4fc0;fill-opacity:.45;stroke:#7a4fc0}\n"
    ".way{fill:#5b6670;fill-opacity:.03;stroke:#5b6670;stroke-opacity:.7}\n"
    ".exact{fill:#16803c;fill-opacity:.1;stroke:#16803c;stroke-width:1.5}\n"
    ".tree{fill:#1f77b4;fill-opacity:.08;stroke:#1f77b4;"
    "stroke-dasharray:5 3}\n"
    ".bytes{fill:#c4262e;fill-opacity:.1;stroke:#c4262e;stroke-width:1.5}\n"
    ".ray{fill:none;stroke:#0b3d91;stroke-width:2.5}.hit{fill:#0b3d91}\n";

/* How far a corner of a cube of half edge 1 lies from its middle: nothing is cut off, however it is
 * turned. */
#define REACH  1.7320508075688772
#define MARGIN 5u /* pixels around the cube, for the width of lines and the point of the hit */

static double along(const double row[3], const double corner[3])
{
    return row[0] * corner[0] + row[1] * corner[1] + row[2] * corner[2];
}

struct ordered {
    const struct shape *shape;
    double depth; /* towards the eye */
};

static int by_depth(const void *a, const void *b)
{
    double d = ((const struct ordered *)a)->depth - ((const struct ordered *)b)->depth;
    return (d > 0) - (d < 0);
}

static void write_shape(FILE *out, const struct picture_view *view, const struct shape *shape,
                        unsigned size)
{
    double scale = (0.5 * size - MARGIN) / REACH, middle = 0.5 * size;
    const char *class = shape_role_name(shape->role);
    if (shape->role == SHAPE_HIT) {
        fprintf(out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"4\"/>\n", class,
                middle + scale * along(view->turn[0], shape->corner[0]),
                middle - scale * along(view->turn[1], shape->corner[0]));
        return;
    }
    fprintf(out, "<poly%s class=\"%s\" points=\"", shape->role == SHAPE_RAY ? "line" : "gon",
            class);
    for (uint32_t i = 0; i < shape->corner_count; i++)
        fprintf(out, "%s%.1f,%.1f", i ? " " : "",
                middle + scale * along(view->turn[0], shape->corner[i]),
                middle - scale * along(view->turn[1], shape->corner[i]));
    fputs("\"/>\n", out);
}

void view_write_svg(FILE *out, const struct picture_view *view, unsigned x, unsigned size)
{
    struct ordered *order = calloc(view->shape_count + 1, sizeof *order);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" x=\"%u\" viewBox=\"0 0 %u %u\" width=\"%u\" "
            "height=\"%u\" role=\"img\">\n<title>%s</title>\n",
            x, size, size, size, size, view->name);
    for (size_t i = 0; i < view->shape_count && order; i++) {
        const struct shape *shape = &view->shape[i];
        double sum = 0;
        for (uint32_t c = 0; c < shape->corner_count; c++)
            sum += along(view->turn[2], shape->corner[c]);
        order[i] = (struct ordered){shape, sum / shape->corner_count};
        if (shape->role >= SHAPE_RAY)
            order[i].depth = 10 + shape->role;
    }
    if (order)
        qsort(order, view->shape_count, sizeof *order, by_depth);
    for (size_t i = 0; i < view->shape_count && order; i++)
        write_shape(out, view, order[i].shape, size);
    fputs("</svg>\n", out);
    free(order);
}

static void write_numbers(FILE *out, const double *number, size_t count)
{
    putc('[', out);
    for (size_t i = 0; i < count; i++)
        fprintf(out, "%s%.5g", i ? "," : "", number[i]);
    putc(']', out);
}

void view_write_json(FILE *out, const struct picture_view *view)
{
    fputs("{\"turn\":[", out);
    for (int i = 0; i < 3; i++) {
        fputs(i ? "," : "", out);
        write_numbers(out, view->turn[i], 3);
    }
    fputs("],\"shapes\":[", out);
    for (size_t i = 0; i < view->shape_count; i++) {
        const struct shape *shape = &view->shape[i];
        fprintf(out, "%s\n{\"role\":\"%s\",\"corners\":[", i ? "," : "",
                shape_role_name(shape->role));
        for (uint32_t c = 0; c < shape->corner_count; c++) {
            fputs(c ? "," : "", out);
            write_numbers(out, shape->corner[c], 3);
        }
        fputs("]}", out);
    }
    fputs("]}", out);
}

bool view_has(const struct picture_view *view, enum shape_role role)
{
    for (size_t i = 0; i < view->shape_count; i++)
        if (view->shape[i].role == role)
            return true;
    return false;
}

/* --- both views in a file -------------------------------------------------------------------- */

#define PIXELS 460u
#define LINE   20u /* of the legend, of two columns */

static void write_legend(FILE *out, const struct picture_view view[2], unsigned rows)
{
    unsigned line = 0;
    for (enum shape_role role = 0; role < SHAPE_ROLES; role++) {
        if (!view_has(&view[0], role) && !view_has(&view[1], role))
            continue;
        unsigned x = 12 + line / rows * PIXELS, y = PIXELS + 34 + line % rows * LINE;
        fprintf(out,
                "<rect class=\"%s\" x=\"%u\" y=\"%u\" width=\"14\" height=\"12\"/>"
                "<text x=\"%u\" y=\"%u\">%s</text>\n",
                shape_role_name(role), x, y, x + 22, y + 11, shape_role_text(role));
        line++;
    }
}

static void write_both(FILE *out, const struct picture_view view[2], const char *cause)
{
    unsigned shown = 0;
    for (enum shape_role role = 0; role < SHAPE_ROLES; role++)
        shown += view_has(&view[0], role) || view_has(&view[1], role);
    unsigned rows = (shown + 1) / 2, height = PIXELS + 44 + rows * LINE;
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"explained\" width=\"%u\" "
            "height=\"%u\" viewBox=\"0 0 %u %u\">\n<title>",
            2 * PIXELS, height, 2 * PIXELS, height);
    ci_xml(out, cause);
    fprintf(
        out,
        "</title>\n<style>%s.explained text{font:14px system-ui,sans-serif;fill:#1c2127}</style>\n"
        "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
        picture_style);
    for (unsigned i = 0; i < 2; i++) {
        view_write_svg(out, &view[i], i * PIXELS, PIXELS);
        fprintf(out, "<text x=\"%u\" y=\"%u\">%s: a cube of %.6g</text>\n", i * PIXELS + 12,
                PIXELS + 14, view[i].name, 2 * view[i].radius);
    }
    write_legend(out, view, rows);
    fputs("</svg>\n", out);
}

enum status picture_write(const char *path, const struct explain_page *page, struct reason *reason)
{
    struct picture_view view[2];
    struct file_out out;
    if (!picture_exists(page))
        return fail(reason, STATUS_INPUT, "%s: there is nothing to draw of this ray", path);
    enum status status = view_make(page, VIEW_NODE, &view[0], reason);
    if (status)
        return status;
    status = view_make(page, VIEW_PLACE, &view[1], reason);
    if (!status)
        status = file_out_open(path, &out, reason);
    if (!status) {
        write_both(out.stream, view, cause_text(page->ray->why.cause));
        status = file_out_commit(&out, reason);
    }
    view_free(&view[0]);
    view_free(&view[1]);
    return status;
}
