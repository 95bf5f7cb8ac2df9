/* Ray against triangle in the triangle's own coordinates: the operations of
 * ref/primitives/tri_baldwin_webber.h in the same order. For tri.glsl. */
#ifndef TRI_BALDWIN_WEBBER_GLSL
#define TRI_BALDWIN_WEBBER_GLSL

/* The components along a, b and c, where a and b are the two axes after c. */
vec3 tri_turned(vec3 v, uint c)
{
    return pick(c == 0u, v.yzx, pick(c == 1u, v.zxy, v));
}

/* Makes the map's rows u, v and height: coefficients of a and b, and the last column. Returns c. */
uint baldwin_webber_transform(vec3 v0, vec3 v1, vec3 v2, out vec3 u, out vec3 w, out vec3 h)
{
    precise vec3 e1 = v1 - v0;
    precise vec3 e2 = v2 - v0;
    vec3 n = tri_cross(e1, e2);
    precise vec3 minus = -n;
    vec3 size = slab_select(lessThan(n, vec3(0.0)), minus, n);
    uint c = pick(size.y > size.x, 1u, 0u);
    c = pick(size.z > tri_pick(size, c), 2u, c);
    vec3 along = tri_turned(n, c), first = tri_turned(e1, c), second = tri_turned(e2, c);
    vec3 at = tri_turned(v0, c);
    precise vec2 to_u = vec2(second.y, -second.x) / along.z;
    precise vec2 to_w = vec2(-first.y, first.x) / along.z;
    precise vec2 to_h = along.xy / along.z;
    precise float last_u = -(to_u.x * at.x + to_u.y * at.y);
    precise float last_w = -(to_w.x * at.x + to_w.y * at.y);
    precise float last_h = -((at.z + to_h.x * at.x) + to_h.y * at.y);
    bool area = any(bvec2(along.z < 0.0, along.z > 0.0));
    u = pick(area, vec3(to_u, last_u), vec3(0.0, 0.0, -1.0));
    w = pick(area, vec3(to_w, last_w), vec3(0.0));
    h = pick(area, vec3(to_h, last_h), vec3(0.0));
    return pick(area, c, 0u);
}

/* The test with a precomputed transform. */
bool baldwin_webber_hit(tri_ray r, vec3 u, vec3 w, vec3 h, uint c, out vec3 tuv)
{
    vec3 o = tri_turned(r.o, c), d = tri_turned(r.d, c);
    precise float height = ((o.z + h.x * o.x) + h.y * o.y) + h.z;
    precise float climb = (d.z + h.x * d.x) + h.y * d.y;
    precise float t = -height / climb;
    precise vec2 p = o.xy + t * d.xy;
    precise float at_u = (u.x * p.x + u.y * p.y) + u.z;
    precise float at_w = (w.x * p.x + w.y * p.y) + w.z;
    precise float sum = at_u + at_w;
    bool within = sum <= 1.0;
    tuv = vec3(t, at_u, at_w);
    return both(any(bvec2(climb < 0.0, climb > 0.0)), both(at_u >= 0.0, at_w >= 0.0), within);
}

bool tri_baldwin_webber(tri_ray r, vec3 v0, vec3 v1, vec3 v2, out vec3 tuv)
{
    vec3 u, w, h;
    uint c = baldwin_webber_transform(v0, v1, v2, u, w, h);
    return baldwin_webber_hit(r, u, w, h, c, tuv);
}

#endif
