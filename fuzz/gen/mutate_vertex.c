/* Edits of one vertex. */
#include "fuzz/gen/mutate_inner.h"

float *some_vertex(struct rng *rng, struct scene *scene)
{
    if (scene->tri_count == 0)
        return NULL;
    uint32_t corner = rng_below(rng, 3 * scene->tri_count);
    return scene->vertex + 3 * (size_t)scene->index[corner];
}

/* One coordinate by one to four steps of a float. */
enum status edit_next_float(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    float *v = some_vertex(rng, &trial->scene);
    uint32_t k = rng_below(rng, 3);
    int steps = 1 + (int)rng_below(rng, 4);
    if (rng_below(rng, 2))
        steps = -steps;
    if (v)
        put(&v[k], float_step(v[k], steps), changed);
    return STATUS_OK;
}

enum status edit_onto_vertex(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    float *v = some_vertex(rng, &trial->scene);
    const float *onto = some_vertex(rng, &trial->scene);
    for (int k = 0; v && onto && k < 3; k++)
        put(&v[k], onto[k], changed);
    return STATUS_OK;
}

/* Onto a point of an edge of another triangle, in half of the cases its middle: a T-junction. */
enum status edit_onto_edge(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    float *v = some_vertex(rng, &trial->scene), corner[3][3];
    if (!v)
        return STATUS_OK;
    scene_tri(&trial->scene, rng_below(rng, trial->scene.tri_count), corner);
    float s = rng_float(rng);
    if (rng_below(rng, 2))
        s = 0.5f;
    for (int k = 0; k < 3; k++)
        put_finite(&v[k], corner[0][k] + s * (corner[1][k] - corner[0][k]), changed);
    return STATUS_OK;
}

/* One coordinate: 0, -0 or beside it. */
enum status edit_zero(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    static const float near[] = {0.0f, -0.0f, 0x1p-149f, -0x1p-126f, 0x1p-25f, -0x1p-15f};
    float *v = some_vertex(rng, &trial->scene);
    uint32_t k = rng_below(rng, 3), which = rng_below(rng, ARRAY_COUNT(near));
    if (v)
        put(&v[k], near[which], changed);
    return STATUS_OK;
}

/* One coordinate by up to 2^12 times the scene away, at most 2^38. */
enum status edit_far_vertex(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    float *v = some_vertex(rng, &trial->scene);
    uint32_t k = rng_below(rng, 3);
    float far = largest_of(&trial->scene) * power_of_two((int)rng_below(rng, 13));
    if (rng_below(rng, 2))
        far = -far;
    if (v && far < 0x1p38f && far > -0x1p38f)
        put(&v[k], far, changed);
    return STATUS_OK;
}
