/* What a picture of an explained ray holds. */
#include "cmd/explain/cmd_explain_picture.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *shape_role_name(enum shape_role role)
{
    static const char *const names[] = {"other", "expected", "answered", "way", "exact",
                                        "tree",  "bytes",    "ray",      "hit"};
    return names[role];
}

const char *shape_role_text(enum shape_role role)
{
    static const char *const texts[] = {
        "other triangles",
        "the triangle to be hit",
        "the triangle that was answered",
        "boxes on the way, in the bytes",
        "the box of the node's triangles",
        "the box of the tree",
        "the box in the bytes",
        "the ray",
        "the exact hit",
    };
    return texts[role];
}

/* The node where the path ended, or NULL. */
static const struct explain_step *node_of(const struct explain_page *page)
{
    const struct explanation *why = &page->ray->why;
    return why->step_count > 0 && why->last < why->step_count ? &why->step[why->last] : NULL;
}

static uint32_t expected_of(const struct explain_page *page)
{
    return page->ray->why.prim != ABI_NO_PRIM ? page->ray->why.prim : page->ray->truth.prim;
}

static uint32_t answered_of(const struct explain_page *page)
{
    const struct explain_answer *answer = &page->ray->answer;
    uint32_t prim = answer->finished ? answer->hit.prim : ABI_NO_PRIM;
    return prim < page->scene->tri_count && prim != expected_of(page) ? prim : ABI_NO_PRIM;
}

bool picture_exists(const struct explain_page *page)
{
    const struct ray *ray = &page->ray->ray;
    for (int k = 0; k < 3; k++)
        if (!isfinite(ray->org[k]) || !isfinite(ray->dir[k]))
            return false;
    return node_of(page) || expected_of(page) != ABI_NO_PRIM || answered_of(page) != ABI_NO_PRIM;
}

bool picture_has_way(const struct explain_page *page)
{
    return node_of(page) && page->ray->why.last > 0;
}

/* --- clipping --------------------------------------------------------------------------------- */

/* Cuts off what lies beyond side * 1 on an axis. */
static void cut(struct shape *shape, int axis, double side)
{
    struct shape from = *shape;
    shape->corner_count = 0;
    for (uint32_t i = 0; i < from.corner_count; i++) {
        const double *a = from.corner[i], *b = from.corner[(i + 1) % from.corner_count];
        double da = 1 - side * a[axis], db = 1 - side * b[axis];
        if (da >= 0 && shape->corner_count < SHAPE_CORNERS)
            memcpy(shape->corner[shape->corner_count++], a, sizeof from.corner[i]);
        if ((da < 0) == (db < 0) || shape->corner_count == SHAPE_CORNERS ||
            (from.corner_count == 2 && i == 1))
            continue;
        for (int k = 0; k < 3; k++)
            shape->corner[shape->corner_count][k] = a[k] + (b[k] - a[k]) * (da / (da - db));
        shape->corner_count++;
    }
}

/* Moves a shape of the scene into the cube and adds what of it lies in there. */
static enum status add(struct picture_view *view, struct shape shape)
{
    for (uint32_t i = 0; i < shape.corner_count; i++)
        for (int k = 0; k < 3; k++)
            shape.corner[i][k] = (shape.corner[i][k] - view->focus[k]) / view->radius;
    for (int axis = 0; axis < 3; axis++) {
        cut(&shape, axis, 1);
        cut(&shape, axis, -1);
    }
    if (shape.corner_count == 0 || (shape.role < SHAPE_RAY && shape.corner_count < 3))
        return STATUS_OK;
    void *shapes = view->shape;
    enum status status =
        array_reserve(&shapes, &view->shape_capacity, view->shape_count + 1, sizeof shape);
    if (status)
        return status;
    view->shape = shapes;
    view->shape[view->shape_count++] = shape;
    return STATUS_OK;
}

/* --- parts ------------------------------------------------------------------------------------ */

static enum status add_box(struct picture_view *view, enum shape_role role, const double lo[3],
                           const double hi[3])
{
    enum status status = STATUS_OK;
    for (int side = 0; side < 6 && !status; side++) {
        struct shape shape = {.role = role, .corner_count = 4};
        int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int i = 0; i < 4; i++) {
            shape.corner[i][axis] = side % 2 ? hi[axis] : lo[axis];
            shape.corner[i][u] = i == 1 || i == 2 ? hi[u] : lo[u];
            shape.corner[i][v] = i >= 2 ? hi[v] : lo[v];
        }
        status = add(view, shape);
    }
    return status;
}

enum box_form { BOX_EXACT, BOX_TREE, BOX_BYTES };

/* A bound; one that is not finite lies far outside. */
static double bound_of(const struct explain_bound *bound, enum box_form form)
{
    float value = form == BOX_EXACT  ? bound->exact
                  : form == BOX_TREE ? bound->canonical
                                     : bound->decoded;
    if (isnan(value))
        return 0;
    return isinf(value) ? copysign(4.0 * (double)FLT_MAX, (double)value) : (double)value;
}

static void box_of(const struct explain_step *step, enum box_form form, double box[2][3])
{
    for (int k = 0; k < 3; k++) {
        box[0][k] = bound_of(&step->lo[k], form);
        box[1][k] = bound_of(&step->hi[k], form);
    }
}

static enum status add_node(struct picture_view *view, const struct explain_step *step)
{
    static const enum shape_role roles[] = {SHAPE_EXACT, SHAPE_TREE, SHAPE_BYTES};
    double box[3][2][3];
    for (int form = 0; form < 3; form++)
        box_of(step, (enum box_form)form, box[form]);
    enum status status = STATUS_OK;
    for (int form = 0; form < 3 && !status; form++)
        if (form != BOX_TREE || memcmp(box[BOX_TREE], box[BOX_EXACT], sizeof box[0]) != 0)
            status = add_box(view, roles[form], box[form][0], box[form][1]);
    return status;
}

static enum status add_way(struct picture_view *view, const struct explanation *why)
{
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < why->last && !status; i++) {
        double box[2][3];
        box_of(&why->step[i], BOX_BYTES, box);
        status = add_box(view, SHAPE_WAY, box[0], box[1]);
    }
    return status;
}

static void point_at(const struct ray *ray, double t, double point[3])
{
    for (int k = 0; k < 3; k++)
        point[k] = (double)ray->org[k] + t * (double)ray->dir[k];
}

/* The exact hit, or that of the answer; false: neither. */
static bool hit_of(const struct explain_page *page, double *t)
{
    const struct judged_ray *ray = page->ray;
    if (ray->truth.prim != ABI_NO_PRIM && !(ray->truth.flags & ORACLE_REFUSED)) {
        *t = 0.5 * (ray->truth.t_lo + ray->truth.t_hi);
        return true;
    }
    *t = (double)ray->answer.hit.t;
    return ray->answer.finished && ray->answer.hit.prim != ABI_NO_PRIM && isfinite(*t);
}

static enum status add_ray(struct picture_view *view, const struct explain_page *page)
{
    const struct ray *ray = &page->ray->ray;
    struct shape line = {.role = SHAPE_RAY, .corner_count = 2};
    struct shape point = {.role = SHAPE_HIT, .corner_count = 1};
    double length = 0, t = 0, far = 0;
    for (int k = 0; k < 3; k++) {
        length += (double)ray->dir[k] * (double)ray->dir[k];
        far += fabs((double)ray->org[k] - view->focus[k]);
    }
    length = sqrt(length);
    bool hits = hit_of(page, &t);
    point_at(ray, (double)ray->tmin, line.corner[0]);
    point_at(ray, fmin((double)ray->tmax, (far + 8 * view->radius) / (length > 0 ? length : 1)),
             line.corner[1]);
    enum status status = add(view, line);
    if (status || !hits || page->ray->truth.prim == ABI_NO_PRIM)
        return status;
    point_at(ray, t, point.corner[0]);
    return add(view, point);
}

static enum status add_triangle(struct picture_view *view, const struct scene *scene, uint32_t prim,
                                enum shape_role role)
{
    struct shape shape = {.role = role, .corner_count = 3};
    float v[3][3];
    scene_tri(scene, prim, v);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            shape.corner[i][k] = (double)v[i][k];
    return add(view, shape);
}

static enum status add_triangles(struct picture_view *view, const struct explain_page *page)
{
    uint32_t expected = expected_of(page), answered = answered_of(page);
    enum status status = STATUS_OK;
    size_t drawn = 0;
    for (uint32_t prim = 0; prim < page->scene->tri_count && !status; prim++) {
        if (prim == expected || prim == answered)
            continue;
        size_t before = view->shape_count;
        status = add_triangle(view, page->scene, prim, SHAPE_TRIANGLE);
        if (view->shape_count > before && ++drawn > PICTURE_TRIANGLES) {
            view->shape_count--;
            view->left_out++;
        }
    }
    if (!status && answered != ABI_NO_PRIM)
        status = add_triangle(view, page->scene, answered, SHAPE_ANSWERED);
    if (!status && expected != ABI_NO_PRIM)
        status = add_triangle(view, page->scene, expected, SHAPE_EXPECTED);
    return status;
}

/* --- where to look --------------------------------------------------------------------------- */

struct extent {
    double lo[3], hi[3];
};

static void include(struct extent *extent, const double point[3])
{
    for (int k = 0; k < 3; k++) {
        extent->lo[k] = fmin(extent->lo[k], point[k]);
        extent->hi[k] = fmax(extent->hi[k], point[k]);
    }
}

static void include_triangle(struct extent *extent, const struct scene *scene, uint32_t prim)
{
    float v[3][3];
    if (prim == ABI_NO_PRIM)
        return;
    scene_tri(scene, prim, v);
    for (int i = 0; i < 3; i++)
        include(extent, (double[3]){(double)v[i][0], (double)v[i][1], (double)v[i][2]});
}

static void include_step(struct extent *extent, const struct explain_step *step)
{
    for (int k = 0; k < 3; k++) {
        extent->lo[k] = fmin(extent->lo[k], (double)step->lo[k].exact);
        extent->hi[k] = fmax(extent->hi[k], (double)step->hi[k].exact);
    }
}

/* Frames the node, and with `way` the nodes above it. */
static void look_at_all(const struct explain_page *page, bool way, struct picture_view *view)
{
    struct extent all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    const struct explain_step *step = node_of(page);
    double t, point[3];
    include_triangle(&all, page->scene, expected_of(page));
    include_triangle(&all, page->scene, answered_of(page));
    if (step)
        include_step(&all, step);
    for (uint32_t i = 0; way && i < page->ray->why.last; i++)
        include_step(&all, &page->ray->why.step[i]);
    if (hit_of(page, &t)) {
        point_at(&page->ray->ray, t, point);
        include(&all, point);
    }
    double most = 0;
    for (int k = 0; k < 3; k++) {
        view->focus[k] = 0.5 * all.lo[k] + 0.5 * all.hi[k];
        most = fmax(most, 0.5 * all.hi[k] - 0.5 * all.lo[k]);
    }
    view->radius = most > 0 ? 1.25 * most : 1;
}

/* How far a box's bounds lie from where they should. */
static double gap_of(const struct explain_step *step)
{
    double gap = 0;
    for (int k = 0; k < 3 && step; k++)
        for (int side = 0; side < 2; side++) {
            const struct explain_bound *bound = side ? &step->hi[k] : &step->lo[k];
            double off = fabs((double)bound->decoded - (double)bound->exact);
            if (bound->fault != BOUND_OK && isfinite(off))
                gap = fmax(gap, off);
        }
    return gap;
}

static void look_closely(const struct explain_page *page, struct picture_view *view)
{
    double t, gap = gap_of(node_of(page));
    if (!hit_of(page, &t))
        return;
    point_at(&page->ray->ray, t, view->focus);
    view->radius = gap > 0 ? fmin(view->radius, 2.5 * gap) : view->radius / 50;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static void normalise(double v[3])
{
    double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    for (int k = 0; k < 3 && most > 0; k++)
        v[k] /= most;
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3 && length > 0; k++)
        v[k] /= length;
}

/* Looks at the ray from its side and a little from behind and above. */
static void turn(const struct ray *ray, double rows[3][3])
{
    double along[3] = {(double)ray->dir[0], (double)ray->dir[1], (double)ray->dir[2]};
    double up[3] = {0, 0, 0}, side[3];
    normalise(along);
    int least = fabs(along[1]) < 0.9 ? 1 : 2;
    up[least] = 1;
    cross(along, up, side);
    normalise(side);
    for (int k = 0; k < 3; k++)
        rows[2][k] = 0.85 * side[k] - 0.4 * along[k] + 0.35 * up[k];
    normalise(rows[2]);
    cross(up, rows[2], rows[0]);
    normalise(rows[0]);
    cross(rows[2], rows[0], rows[1]);
}

enum status view_make(const struct explain_page *page, enum view_kind kind,
                      struct picture_view *out, struct reason *reason)
{
    static const char *const names[] = {"the way", "the node", "the place"};
    *out = (struct picture_view){.name = names[kind]};
    const struct explain_step *step = node_of(page);
    look_at_all(page, kind == VIEW_WAY, out);
    if (kind == VIEW_PLACE)
        look_closely(page, out);
    turn(&page->ray->ray, out->turn);
    enum status status = add_triangles(out, page);
    if (!status && kind == VIEW_WAY)
        status = add_way(out, &page->ray->why);
    if (!status && step)
        status = add_node(out, step);
    if (!status)
        status = add_ray(out, page);
    if (status) {
        view_free(out);
        return fail(reason, status, "no memory for a picture");
    }
    return STATUS_OK;
}

void view_free(struct picture_view *view)
{
    free(view->shape);
    *view = (struct picture_view){.name = ""};
}
