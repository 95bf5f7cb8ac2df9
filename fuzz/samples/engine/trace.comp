// A tracer as one compute shader: every triangle, by the test of Moeller and Trumbore.
//   raydiff check sphere --engine shader:trace.comp
#version 450
layout(local_size_x_id = 0) in; // 64, or --workgroup

struct Hit {
    float t, u, v;
    uint triangle;
};
layout(std430, binding = 0) readonly buffer Rays { vec4 ray[]; }; // origin, tmin; direction, tmax
layout(std430, binding = 1) writeonly buffer Hits { Hit hit[]; };
layout(std430, binding = 2) readonly buffer Vertices { float vertex[]; };
layout(std430, binding = 3) readonly buffer Triangles { uint corner[]; };
layout(push_constant) uniform Push { uint rays, vertices, triangles, query; };

vec3 at(uint triangle, uint k)
{
    uint i = 3u * corner[3u * triangle + k];
    return vec3(vertex[i], vertex[i + 1u], vertex[i + 2u]);
}

void main()
{
    uint number = gl_GlobalInvocationID.x;
    if (number >= rays)
        return;
    vec4 o = ray[2u * number], d = ray[2u * number + 1u];
    Hit best = Hit(d.w, 0.0, 0.0, 0xFFFFFFFFu);
    for (uint i = 0u; i < triangles; i++) {
        vec3 a = at(i, 0u), e1 = at(i, 1u) - a, e2 = at(i, 2u) - a, s = o.xyz - a;
        vec3 p = cross(d.xyz, e2), q = cross(s, e1);
        float det = dot(e1, p), t = dot(e2, q) / det, u = dot(s, p) / det, v = dot(d.xyz, q) / det;
        if (det != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= o.w && t <= best.t) {
            best = Hit(t, u, v, i);
            if (query == 1u)
                break;
        }
    }
    hit[number] = best;
}
