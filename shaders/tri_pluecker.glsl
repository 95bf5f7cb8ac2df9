/* Ray against triangle by Pluecker coordinates: the operations of ref/primitives/tri_pluecker.h in
 * the same order. For tri.glsl. */
#ifndef TRI_PLUECKER_GLSL
#define TRI_PLUECKER_GLSL

/* The side on which the ray passes the edge from p to q; a and b are p and q relative to its
 * origin. */
float tri_side(vec3 d, vec3 a, vec3 b, vec3 edge)
{
    precise vec3 sum = a + b;
    return tri_sum(d, tri_cross(sum, edge));
}

bool tri_pluecker(tri_ray r, vec3 v0, vec3 v1, vec3 v2, out vec3 tuv)
{
    precise vec3 a = v0 - r.o;
    precise vec3 b = v1 - r.o;
    precise vec3 c = v2 - r.o;
    precise vec3 bc = v2 - v1;
    precise vec3 ca = v0 - v2;
    precise vec3 ab = v1 - v0;
    vec3 w = vec3(tri_side(r.d, b, c, bc), tri_side(r.d, c, a, ca), tri_side(r.d, a, b, ab));
    vec3 n = tri_cross(ca, ab);
    float det = tri_sum(r.d, n);
    precise float all_sides = (w.x + w.y) + w.z;
    bool back = both(det < 0.0, all(lessThanEqual(w, vec3(0.0))), all_sides < 0.0);
    bool front = both(det > 0.0, all(greaterThanEqual(w, vec3(0.0))), all_sides > 0.0);
    float height = tri_sum(a, n);
    precise vec3 quotient = vec3(height, w.y, w.z) / vec3(det, all_sides, all_sides);
    tuv = quotient;
    return any(bvec2(front, back));
}

#endif
