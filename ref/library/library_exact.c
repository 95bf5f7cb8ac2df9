/* The public library: exact answers. */
#include "ref/library/library.h"

#include <math.h>
#include <stdlib.h>

/* Answers of the oracle that are held at a time. */
#define CHUNK 16384u

const char *raydiff_class_name(uint32_t number)
{
    return number <= RAYDIFF_CLASS_IN_PLANE ? oracle_class_name((enum oracle_class)number) : NULL;
}

static struct raydiff_nearest exact_of(const struct oracle_answer *answer)
{
    const bool hit = answer->prim != ABI_NO_PRIM;
    return (struct raydiff_nearest){.triangle = answer->prim,
                                    .ties = answer->tie_count,
                                    .kind = answer->class,
                                    .refused = (answer->flags & ORACLE_REFUSED) != 0,
                                    .t_lo = hit ? answer->t_lo : 0.0,
                                    .t_hi = hit ? answer->t_hi : 0.0,
                                    .t_next = answer->t_next};
}

/* The arguments of nearly all functions on rays. */
static enum status check(const struct raydiff_oracle *oracle, const void *ray, const void *out,
                         size_t count, struct reason *reason)
{
    enum status status = library_given(oracle, "oracle", reason);
    if (!status && count)
        status = library_given(ray, "rays", reason);
    if (!status && count)
        status = library_given(out, "out", reason);
    return status;
}

/* Exact answers to a part of the rays; `mode` has room for them if there are masks. */
static enum status decide(const struct raydiff_oracle *oracle, const struct ray *ray,
                          const uint32_t *mask, struct ray_mode *mode, size_t count,
                          unsigned threads, struct oracle_answer *out, struct reason *reason)
{
    if (!oracle->is_world)
        return oracle_closest(oracle->oracle, ORACLE_TREE, ORACLE_CLOSED, ray, count, threads, out,
                              NULL, reason);
    for (size_t i = 0; i < count && mask; i++)
        mode[i] = library_mode(mask, i);
    return oracle_closest_world(oracle->oracle, ORACLE_TREE, ORACLE_CLOSED, ray, mask ? mode : NULL,
                                count, threads, out, NULL, reason);
}

enum raydiff_error raydiff_exact(const struct raydiff_oracle *oracle, const float *ray,
                                 const uint32_t *mask, size_t count, uint32_t threads,
                                 struct raydiff_nearest *out, struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    struct reason reason = {""};
    enum status status = check(oracle, ray, out, count, &reason);
    if (!status)
        status = library_masks(oracle, mask, count, &reason);
    const size_t room = status ? 0 : count < CHUNK ? count : CHUNK;
    struct oracle_answer *answer = alloc_zeroed(room, sizeof *answer);
    struct ray_mode *mode = alloc_zeroed(mask ? room : 0, sizeof *mode);
    if (!status && (!answer || !mode))
        status = fail(&reason, STATUS_MEMORY, "no memory for %zu rays", room);
    for (size_t first = 0; first < count && !status; first += CHUNK) {
        const size_t part = count - first < CHUNK ? count - first : CHUNK;
        status = decide(oracle, library_rays(ray) + first, mask ? mask + first : NULL, mode, part,
                        threads, answer, &reason);
        for (size_t i = 0; i < part && !status; i++)
            out[first + i] = exact_of(&answer[i]);
    }
    for (size_t i = 0; status && out && i < count; i++)
        out[i] = (struct raydiff_nearest){0};
    free(answer);
    free(mode);
    return library_end(modes, status, &reason, why);
}

/* As oracle_closest takes rays. */
static enum status check_ray(const struct ray *ray, struct reason *reason)
{
    bool finite = float_is_finite(ray->tmin) && ray->tmin <= ray->tmax;
    for (int k = 0; k < 3; k++)
        finite = finite && float_is_finite(ray->org[k]) && float_is_finite(ray->dir[k]);
    return finite ? STATUS_OK
                  : fail(reason, STATUS_INPUT,
                         "ray: a number is NaN or infinite, or tmin is over tmax");
}

enum raydiff_error raydiff_exact_all(const struct raydiff_oracle *oracle, const float *ray,
                                     size_t capacity, struct raydiff_crossing *out, size_t *found,
                                     struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    struct reason reason = {""};
    struct oracle_crossing *list = NULL;
    size_t room = 0, count = 0;
    enum status status = library_given(found, "found", &reason);
    if (!status)
        *found = 0;
    if (!status)
        status = library_given(ray, "ray", &reason);
    if (!status)
        status = check(oracle, ray, out, capacity, &reason);
    if (!status)
        status = check_ray(library_rays(ray), &reason);
    if (!status && oracle->is_world)
        status = oracle_crossings_world(oracle->oracle, library_rays(ray), ray_mode_all(),
                                        (double)INFINITY, &list, &room, &count, &reason);
    else if (!status)
        status = oracle_crossings(oracle->oracle, library_rays(ray), (double)INFINITY, &list, &room,
                                  &count, &reason);
    for (size_t i = 0; i < capacity && out; i++)
        out[i] = status || i >= count
                     ? (struct raydiff_crossing){0}
                     : (struct raydiff_crossing){list[i].prim, list[i].pair.class,
                                                 list[i].pair.t_lo, list[i].pair.t_hi};
    if (!status)
        *found = count;
    free(list);
    return library_end(modes, status, &reason, why);
}

enum raydiff_error raydiff_exact_text(const struct raydiff_oracle *oracle, const float *ray,
                                      uint32_t triangle, char *text, size_t bytes,
                                      struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    struct reason reason = {""};
    struct oracle_pair pair;
    enum status status = library_given(oracle, "oracle", &reason);
    if (!status)
        status = library_given(ray, "ray", &reason);
    if (!status)
        status = library_given(bytes ? text : NULL, "text", &reason);
    if (!status)
        text[0] = '\0';
    if (!status)
        status = check_ray(library_rays(ray), &reason);
    if (!status && triangle >= library_triangles(oracle))
        status = fail(&reason, STATUS_INPUT, "triangle %u: there are %u", triangle,
                      library_triangles(oracle));
    if (!status) {
        oracle_pair(oracle->oracle, library_rays(ray), triangle, &pair);
        if (!oracle_is_hit(&pair))
            status = fail(&reason, STATUS_INPUT, "triangle %u: the ray does not hit it", triangle);
    }
    if (!status && !oracle_rational(oracle->oracle, library_rays(ray), triangle, text, bytes)) {
        text[0] = '\0';
        status = fail(&reason, STATUS_LIMIT, "%zu bytes are too few for this fraction", bytes);
    }
    return library_end(modes, status, &reason, why);
}
