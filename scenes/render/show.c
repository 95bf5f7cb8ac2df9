#include "scenes/render/show.h"

#include "ref/base/double3.h"
#include "scenes/render/shade.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct show shows[] = {
    [SHOW_T] = {"t", "distance of the hit along its ray", "t", SHOW_T, SHOW_FROM_ANSWER, false,
                false, 1},
    [SHOW_PRIM] = {"prim", "which triangle was hit", "triangle", SHOW_PRIM, SHOW_FROM_ANSWER, true,
                   true, 1},
    [SHOW_NORMAL] = {"normal", "the shading normal", "x red, y green, z blue, from -1 to 1",
                     SHOW_NORMAL, SHOW_FROM_ANSWER, false, false, 3},
    [SHOW_BOXES] = {"boxes", "boxes tested", "boxes tested", SHOW_BOXES, SHOW_FROM_WALK, false,
                    true, 1},
    [SHOW_TRIANGLES] = {"triangles", "triangles tested", "triangles tested", SHOW_TRIANGLES,
                        SHOW_FROM_WALK, false, true, 1},
    [SHOW_DEPTH] = {"depth", "most entries on the traversal stack", "stack entries", SHOW_DEPTH,
                    SHOW_FROM_WALK, false, true, 1},
    [SHOW_OVERLAP] = {"overlap", "boxes of leaves that the hit point lies in", "leaf boxes",
                      SHOW_OVERLAP, SHOW_FROM_WALK, false, true, 1},
    [SHOW_OVERLAP_ALL] = {"overlap-all", "boxes of leaves and inner nodes that it lies in", "boxes",
                          SHOW_OVERLAP_ALL, SHOW_FROM_WALK, false, true, 1},
    [SHOW_INFLATION] = {"inflation",
                        "surface of the boxes tested over that of their triangles' bounds, mean",
                        "surface over exact", SHOW_INFLATION, SHOW_FROM_WALK, false, false, 1},
    [SHOW_ERROR] = {"error", "error of t in units of its proven bound: above 1 is a bug",
                    "error / bound", SHOW_ERROR, SHOW_FROM_JUDGE, false, false, 1},
    [SHOW_CLASS] = {"class", "verdict of the judge", "verdict", SHOW_CLASS, SHOW_FROM_JUDGE, true,
                    true, 1},
    {0},
};

const struct show *show_find(const char *name)
{
    for (const struct show *show = shows; show->name; show++)
        if (strcmp(show->name, name) == 0)
            return show;
    return NULL;
}

/* A range of pixels being processed. */
struct show_part {
    const struct show_source *source;
    size_t count;
    struct shade_path *path;
    struct ray *ray;
    struct hit *hit;
    struct ray_numbers *numbers;
    struct judgement *judgement;
};

static void part_free(struct show_part *part)
{
    free(part->path);
    free(part->ray);
    free(part->hit);
    free(part->numbers);
    free(part->judgement);
}

static enum status part_make(const struct show_source *source, size_t first, size_t count,
                             struct show_part *part, struct reason *reason)
{
    *part = (struct show_part){.source = source, .count = count};
    part->path = alloc_zeroed(count, sizeof *part->path);
    part->ray = alloc_zeroed(count, sizeof *part->ray);
    part->hit = alloc_zeroed(count, sizeof *part->hit);
    part->numbers = alloc_zeroed(source->numbers ? count : 0, sizeof *part->numbers);
    part->judgement = alloc_zeroed(source->judge ? count : 0, sizeof *part->judgement);
    if (!part->path || !part->ray || !part->hit || !part->numbers || !part->judgement)
        return fail(reason, STATUS_MEMORY, "no memory for %zu pixels", count);
    uint32_t width = source->job->width;
    for (size_t i = 0; i < count; i++) {
        size_t pixel = first + i;
        shade_begin(source->job, source->view, (uint32_t)(pixel % width), (uint32_t)(pixel / width),
                    &part->path[i]);
        part->ray[i] = shade_ray(source->job, &part->path[i]);
    }
    return STATUS_OK;
}

/* Walks every ray in C. Compares hits and total counts with those of the engine. */
static enum status walk(struct show_part *part, const struct trace_report *report,
                        struct reason *reason)
{
    const struct show_source *source = part->source;
    uint64_t boxes = 0, tris = 0;
#pragma omp parallel for schedule(dynamic, 64)
    for (size_t i = 0; i < part->count; i++)
        numbers_of_ray(source->numbers, &part->ray[i], &part->numbers[i]);
    for (size_t i = 0; i < part->count; i++) {
        const struct ray_numbers *one = &part->numbers[i];
        if (!one->finished || memcmp(&one->hit, &part->hit[i], sizeof one->hit) != 0)
            return fail(reason, STATUS_INTERNAL, "the C traversal %s engine %s",
                        one->finished ? "returns another hit than" : "did not finish, unlike",
                        source->engine->name);
        boxes += one->boxes;
        tris += one->tris;
    }
    if (boxes != report->boxes || tris != report->tris)
        return fail(reason, STATUS_INTERNAL,
                    "pixels add up to %llu boxes and %llu triangles, engine %s counted %llu and "
                    "%llu",
                    (unsigned long long)boxes, (unsigned long long)tris, source->engine->name,
                    (unsigned long long)report->boxes, (unsigned long long)report->tris);
    return STATUS_OK;
}

static double hit_or_none(const struct hit *hit, double value)
{
    return hit->prim == ABI_NO_PRIM ? (double)NAN : value;
}

/* The value of a pixel with one plane. */
static double value_of(const struct show_part *part, size_t i)
{
    const struct hit *hit = &part->hit[i];
    const struct ray_numbers *numbers = &part->numbers[i];
    switch (part->source->show->id) {
    case SHOW_T:
        return hit_or_none(hit, (double)hit->t);
    case SHOW_PRIM:
        return hit_or_none(hit, (double)hit->prim);
    case SHOW_BOXES:
        return (double)numbers->boxes;
    case SHOW_TRIANGLES:
        return (double)numbers->tris;
    case SHOW_DEPTH:
        return (double)numbers->depth;
    case SHOW_OVERLAP:
        return hit_or_none(hit, (double)numbers->around_leaves);
    case SHOW_OVERLAP_ALL:
        return hit_or_none(hit, (double)numbers->around);
    case SHOW_INFLATION:
        return numbers->inflation;
    case SHOW_ERROR:
        return verdict_error(&part->judgement[i], hit, part->source->unknown);
    case SHOW_CLASS:
        return (double)part->judgement[i].verdict;
    case SHOW_NORMAL:
        break;
    }
    return (double)NAN;
}

static void normal_of(struct show_part *part, size_t i, double value[3])
{
    struct shade_path *path = &part->path[i];
    bool hit =
        part->hit[i].prim != ABI_NO_PRIM && shade_hit(part->source->job, &part->hit[i], path);
    value[0] = hit ? (double)path->n.x : (double)NAN;
    value[1] = hit ? (double)path->n.y : (double)NAN;
    value[2] = hit ? (double)path->n.z : (double)NAN;
}

enum status show_values(const struct show_source *source, size_t first, size_t count, double *value,
                        struct trace_counts *counts, struct reason *reason)
{
    struct show_part part;
    struct trace_report report = {0};
    enum status status = part_make(source, first, count, &part, reason);
    if (!status)
        status = source->engine->trace(source->self, part.ray, count, part.hit, &report, reason);
    if (!status && source->numbers)
        status = walk(&part, &report, reason);
    if (!status && source->judge)
        status = verdicts_make(source->oracle, source->judge, part.ray, part.hit, count,
                               part.judgement, reason);
    for (size_t i = 0; i < count && !status; i++) {
        if (source->show->id == SHOW_NORMAL)
            normal_of(&part, i, value + 3 * i);
        else
            value[i] = value_of(&part, i);
    }
    if (!status && counts) {
        counts->boxes += report.boxes;
        counts->tris += report.tris;
    }
    part_free(&part);
    return status;
}

void show_text(const struct show *show, double value, char *text, size_t text_bytes)
{
    if (isnan(value))
        snprintf(text, text_bytes, "-");
    else if (show->id == SHOW_CLASS)
        snprintf(text, text_bytes, "%s", verdict_name((enum verdict)value));
    else
        snprintf(text, text_bytes, show->whole ? "%.0f" : "%.9g", value);
}

static double degrees_between(const double a[3], const double b[3])
{
    double cross[3];
    double3_cross(a, b, cross);
    return atan2(sqrt(double3_dot(cross, cross)), double3_dot(a, b)) *
           (180.0 / 3.14159265358979323846);
}

void show_difference(const struct show *show, const double *first, const double *second,
                     size_t pixels, double *out, size_t *alone)
{
    uint32_t planes = show->planes;
    size_t count = 0;
    for (size_t i = 0; i < pixels; i++) {
        const double *a = first + planes * i, *b = second + planes * i;
        bool none_a = isnan(*a), none_b = isnan(*b);
        count += none_a != none_b;
        if (show->names)
            out[i] = none_a && none_b ? (double)NAN : *a == *b ? 0.0 : 1.0;
        else if (none_a || none_b)
            out[i] = (double)NAN;
        else if (planes == 3)
            out[i] = degrees_between(a, b);
        else
            out[i] = *b - *a;
    }
    if (alone)
        *alone = count;
}

struct show_sum show_sum_of(const double *value, size_t pixels)
{
    struct show_sum out = {0};
    for (size_t i = 0; i < pixels; i++) {
        if (isnan(value[i]))
            continue;
        out.least = out.pixels == 0 || value[i] < out.least ? value[i] : out.least;
        if (out.pixels == 0 || value[i] > out.most) {
            out.most = value[i];
            out.most_at = i;
        }
        out.sum += value[i];
        out.pixels++;
    }
    out.mean = out.pixels > 0 ? out.sum / (double)out.pixels : 0.0;
    return out;
}
