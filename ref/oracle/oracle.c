#include "ref/oracle/oracle.h"

#include "ref/oracle/environment.h"
#include "ref/oracle/filter.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/pair.h"

#include <omp.h>
#include <stdlib.h>

const char *oracle_class_name(enum oracle_class class)
{
    static const char *const name[ORACLE_CLASS_COUNT] = {"miss",   "inside",   "edge",
                                                         "vertex", "in_plane", "zero_area"};
    return class < ORACLE_CLASS_COUNT ? name[class] : "unknown";
}

/* The triangles in the order of the tree, a column per coordinate, and the bounds of their runs. */
static enum status gather(struct oracle *oracle)
{
    const struct scene *scene = oracle->scene;
    size_t count = scene->tri_count, column = count + EARLY_PAD;
    oracle->coordinate = alloc_zeroed(9 * column, sizeof *oracle->coordinate);
    oracle->run = alloc_zeroed(count / EARLY_MOST + 1, sizeof *oracle->run);
    oracle->flat = alloc_zeroed(count, 1);
    if (!oracle->coordinate || !oracle->run || !oracle->flat)
        return STATUS_MEMORY;
    for (size_t i = 0; i < count; i++) {
        float v[3][3];
        uint32_t prim = oracle->tree.order[i];
        struct box *run = &oracle->run[i / EARLY_MOST];
        scene_tri(scene, prim, v);
        if (i % EARLY_MOST == 0)
            *run = box_empty();
        for (size_t c = 0; c < 3; c++) {
            box_add_point(run, v[c]);
            for (size_t k = 0; k < 3; k++)
                oracle->coordinate[(3 * c + k) * column + i] = (double)v[c][k];
        }
        oracle->flat[prim] = !filter_has_area(v) && exact_no_area(v);
    }
    for (size_t c = 0; c < 3; c++)
        for (size_t k = 0; k < 3; k++)
            oracle->soup.v[c][k] = oracle->coordinate + (3 * c + k) * column;
    return STATUS_OK;
}

enum status oracle_make(const struct scene *scene, struct oracle **out, struct reason *reason)
{
    *out = NULL;
    enum status status = oracle_environment(reason);
    if (status)
        return status;
    struct oracle *oracle = alloc_zeroed(1, sizeof *oracle);
    if (!oracle)
        return fail(reason, STATUS_MEMORY, "oracle: no memory");
    oracle->scene = scene;
    oracle->kernel = early_best();
    status = tree_make(scene, &oracle->tree, reason);
    if (!status && (status = gather(oracle)))
        fail(reason, status, "oracle: no memory for %u triangles", scene->tri_count);
    if (status) {
        oracle_free(oracle);
        return status;
    }
    *out = oracle;
    return STATUS_OK;
}

void oracle_free(struct oracle *oracle)
{
    if (!oracle)
        return;
    placing_free(oracle->placing);
    tree_free(&oracle->tree);
    free(oracle->coordinate);
    free(oracle->run);
    free(oracle->flat);
    free(oracle);
}

const struct scene *oracle_scene(const struct oracle *oracle)
{
    return oracle->scene;
}

bool oracle_takes(const struct ray *ray)
{
    for (int k = 0; k < 3; k++)
        if (!float_is_finite(ray->org[k]) || !float_is_finite(ray->dir[k]))
            return false;
    return float_is_finite(ray->tmin) && ray->tmin <= ray->tmax; /* false if tmax is NaN */
}

int oracle_team(size_t parts, unsigned threads)
{
    size_t team = threads ? threads : (size_t)omp_get_max_threads();
    size_t most = parts ? parts : 1;
    return (int)(most < team ? most : team);
}

static void decide(const struct oracle *oracle, const struct ray *ray, uint32_t prim,
                   struct decided *out)
{
    struct located at = pair_locate(oracle, prim);
    pair_decide(&at, ray, prim, PAIR_FULL, out, NULL);
}

void oracle_pair(const struct oracle *oracle, const struct ray *ray, uint32_t prim,
                 struct oracle_pair *out)
{
    struct decided pair;
    unsigned long saved = environment_enter();
    decide(oracle, ray, prim, &pair);
    environment_leave(saved);
    *out = pair.pair;
}

int oracle_compare(const struct oracle *oracle, const struct ray *ray, uint32_t a, uint32_t b)
{
    struct decided one, two;
    unsigned long saved = environment_enter();
    decide(oracle, ray, a, &one);
    decide(oracle, ray, b, &two);
    int sign = pair_order(ray, &one, &two);
    environment_leave(saved);
    return sign;
}

bool oracle_rational(const struct oracle *oracle, const struct ray *ray, uint32_t prim, char *text,
                     size_t text_bytes)
{
    struct decided pair;
    unsigned long saved = environment_enter();
    decide(oracle, ray, prim, &pair);
    bool written = oracle_is_hit(&pair.pair) && fraction_text(pair_t(ray, &pair), text, text_bytes);
    environment_leave(saved);
    return written;
}
