/* Storage `edges`: ten words per item: vertex 0, vertex 1 - vertex 0, vertex 2 - vertex 0, rounded
 * as in the test by Moeller and Trumbore, and the triangle's number. */
#include "ref/primitives/primitives.h"
#include "ref/store/rows.h"
#include "ref/primitives/test_run.h"
#include "ref/store.h"

#include <string.h>

static uint32_t row_of(float v[3][3])
{
    for (int k = 0; k < 3; k++) {
        v[1][k] = v[1][k] - v[0][k];
        v[2][k] = v[2][k] - v[0][k];
    }
    return 0;
}

static bool test(const struct packed *packed, uint32_t first, uint32_t slot, uint32_t tri_id,
                 const struct tri_ray *ray, struct hit *out)
{
    float v[3][3];
    const uint32_t *row = store_row(packed, first, slot);
    if (!row)
        return false;
    memcpy(v, row, sizeof v);
    return tri_moeller_trumbore_edges(ray, v[0], v[1], v[2],
                                      tri_id == ABI_TRI_MT_RTRS ? TRI_RTRS_EPS : 0.0f, out) &&
           tri_in_range(tri_id, ray, out->t);
}

extern const struct tri_store tri_store_edges;
const struct tri_store tri_store_edges = {
    .name = "edges",
    .summary = "a vertex, two edges and the number of each triangle, for mt and mt_rtrs",
    .id = ABI_STORE_EDGES,
    .tests = 1u << ABI_TRI_MT | 1u << ABI_TRI_MT_RTRS,
    .measure = store_rows_measure,
    .row = row_of,
    .write = store_rows_write,
    .item = store_rows_item,
    .test = test,
};
