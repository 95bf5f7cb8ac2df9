/* gkjohnson/three-mesh-bvh!11: a triangle that crosses a plane lies in the leaves of both sides,
 * and is in the list of all hits twice. */
#define SPOIL_LIST list_twice
#include "tests/reported/reported_tracer.h"

/* Does the triangle lie on both sides of the middle of the scene? */
static bool crosses(const struct reported_tree *tree, uint32_t triangle)
{
    const float middle = tree->node[0].lo[0] / 2 + tree->node[0].hi[0] / 2;
    float low = INFINITY, high = -INFINITY;
    for (int corner = 0; corner < 3; corner++) {
        low = fminf(low, vertex_of(tree, triangle, corner)[0]);
        high = fmaxf(high, vertex_of(tree, triangle, corner)[0]);
    }
    return low < middle && middle < high;
}

static int list_twice(void *self, const ray_in *ray, size_t count, uint32_t capacity, hit_out *hit,
                      uint32_t *hit_count, char *reason)
{
    const struct reported_tree *tree = self;
    hit_out *once = malloc(sizeof *once * (tree->triangle_count + 1));
    (void)reason;
    if (!once)
        return RAYDIFF_ENGINE_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const uint32_t found = walk(tree, &ray[i], false, once, true, tree->triangle_count);
        hit_count[i] = 0;
        for (uint32_t k = 0; k < found; k++)
            for (int times = crosses(tree, once[k].triangle) ? 2 : 1; times > 0; times--) {
                if (hit_count[i] < capacity)
                    hit[i * capacity + hit_count[i]] = once[k];
                hit_count[i]++;
            }
    }
    free(once);
    return RAYDIFF_ENGINE_OK;
}
