/* The picture of an explained ray: triangles, the ray, the boxes on its way, and those of the node
 * where it ended, in a cube that is turned. Commands only. */
#ifndef CMD_EXPLAIN_PICTURE_H
#define CMD_EXPLAIN_PICTURE_H

#include "cmd/explain/cmd_explain.h"

#include <stdio.h>

#define PICTURE_TRIANGLES 1000u /* so many at most of those in the cube are drawn */
#define SHAPE_CORNERS     12u   /* of a triangle or a side that the cube cuts */

enum shape_role {
    SHAPE_TRIANGLE, /* any triangle */
    SHAPE_EXPECTED, /* the one that is to be hit */
    SHAPE_ANSWERED, /* the one that was answered, another one */
    SHAPE_WAY,      /* sides of the boxes in the bytes of the nodes above that node */
    SHAPE_EXACT,    /* of the box of the node's triangles */
    SHAPE_TREE,     /* of the box of the tree, if it is another one */
    SHAPE_BYTES,    /* of the box in the bytes */
    SHAPE_RAY,      /* a line */
    SHAPE_HIT,      /* a point: the exact hit */
    SHAPE_ROLES
};

/* A polygon, a line of two corners, or a point, in units of the cube from -1 to 1. */
struct shape {
    enum shape_role role;
    uint32_t corner_count;
    double corner[SHAPE_CORNERS][3];
};

/* What a view frames: all boxes from the root to the node, the node, or the place where the ray
 * passes, as large as the fault of the box. */
enum view_kind { VIEW_WAY, VIEW_NODE, VIEW_PLACE, VIEW_KINDS };

/* What is seen from one place. Owns `shape`. */
struct picture_view {
    const char *name;
    double focus[3], radius; /* the cube in the scene */
    double turn[3][3];       /* rows: to the right, up, towards the eye */
    struct shape *shape;
    size_t shape_count, shape_capacity;
    size_t left_out; /* triangles */
};

/* Whether the page has a place to draw: a node's box, a triangle to be hit, or an answer. */
bool picture_exists(const struct explain_page *page);

/* Whether there is a node above the one where the path ended: VIEW_WAY has boxes to show. */
bool picture_has_way(const struct explain_page *page);

/* Makes a view; the boxes on the way are in VIEW_WAY alone. Errors: STATUS_MEMORY. */
enum status view_make(const struct explain_page *page, enum view_kind kind,
                      struct picture_view *out, struct reason *reason) MUST_USE;

void view_free(struct picture_view *view);

/* Whether any shape has the role. */
bool view_has(const struct picture_view *view, enum shape_role role);

/* Colours of the shapes' classes, as CSS. */
extern const char picture_style[];

/* Writes the view as an <svg> element of that many pixels, farthest shapes first; `x` is where it
 * lies in one around it. */
void view_write_svg(FILE *out, const struct picture_view *view, unsigned x, unsigned size);

/* Writes VIEW_NODE, VIEW_PLACE and a legend as one SVG file. Errors: STATUS_INPUT nothing to draw,
 * cannot write; STATUS_MEMORY. */
enum status picture_write(const char *path, const struct explain_page *page,
                          struct reason *reason) MUST_USE;

/* Writes the view as JSON for the script of the page. */
void view_write_json(FILE *out, const struct picture_view *view);

/* The class of its shapes, and what a legend has of it. */
const char *shape_role_name(enum shape_role role);
const char *shape_role_text(enum shape_role role);

#endif
