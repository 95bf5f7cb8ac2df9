/* A ray. t counts in multiples of dir, which need not have length 1. */
struct ray {
    float org[3], tmin, dir[3], tmax;
};

/* An answer: triangle prim at distance t; u weighs its second vertex, v its third. A miss is
 * 0, 0, 0, MISS. */
struct hit {
    float t, u, v;
    uint32_t prim;
};
#define MISS 0xFFFFFFFFu

/* A right answer to a ray: triangle prim, or MISS, with t, u and v in these intervals. */
struct right {
    uint32_t ray, prim;
    float t[2], u[2], v[2];
};
