// A ray against a triangle: the formulas of ref/primitives/tri.h and its like.

const MT_RTRS_EPS = 1e-7f;

struct Beam {
    o: vec3f,
    d: vec3f,
    tmin: f32,
    tmax: f32,
    axis: vec3u,  // woop: the turned axes
    shear: vec3f, // woop
}

// The answer of a test: t, u, v, and whether it is a hit.
struct Found {
    hit: bool,
    tuv: vec3f,
}

fn largest_axis(v: vec3f) -> u32 {
    let size = abs(v);
    let first = select(0u, 1u, size.y > size.x);
    return select(first, 2u, size.z > size[first]);
}

fn next_axis(k: u32) -> u32 {
    return select(k + 1u, 0u, k == 2u);
}

fn beam_of(o: vec3f, d: vec3f, tmin: f32, tmax: f32) -> Beam {
    let z = largest_axis(d);
    let x = next_axis(z);
    let y = next_axis(x);
    let downward = d[z] < 0.0f;
    let axis = vec3u(select(x, y, downward), select(y, x, downward), z);
    let by = select(d[z], 1.0f, d[z] == 0.0f);
    let shear = keep3(vec3f(d[axis.x], d[axis.y], 1.0f) / by);
    return Beam(o, d, tmin, tmax, axis, shear);
}

fn turned(v: vec3f, axis: vec3u) -> vec3f {
    return vec3f(v[axis.x], v[axis.y], v[axis.z]);
}

fn sum3(v: vec3f) -> f32 {
    return keep(keep(v.x + v.y) + v.z);
}

fn dot3(a: vec3f, b: vec3f) -> f32 {
    return sum3(keep3(a * b));
}

fn cross3(a: vec3f, b: vec3f) -> vec3f {
    return keep3(keep3(a.yzx * b.zxy) - keep3(a.zxy * b.yzx));
}

// Divides where the test has not failed: WGSL does not say what a division by 0 gives.
fn divided(hit: bool, v: vec3f, by: vec3f) -> Found {
    return Found(hit, keep3(v / select(vec3f(1.0f), by, vec3<bool>(hit))));
}

fn moeller_trumbore(r: Beam, v0: vec3f, v1: vec3f, v2: vec3f, eps: f32) -> Found {
    let e1 = keep3(v1 - v0);
    let e2 = keep3(v2 - v0);
    let s = keep3(r.o - v0);
    let p = cross3(r.d, e2);
    let q = cross3(s, e1);
    let det = dot3(e1, p);
    let u = dot3(s, p);
    let w = dot3(r.d, q);
    let t = dot3(e2, q);
    let size = abs(det);
    let down = det < 0.0f;
    let us = select(u, -u, down);
    let ws = select(w, -w, down);
    let hit = (size > eps) & (us >= 0.0f) & (us <= size) & (ws >= 0.0f) & (keep(us + ws) <= size);
    return divided(hit, vec3f(t, u, w), vec3f(det));
}

fn woop(r: Beam, v0: vec3f, v1: vec3f, v2: vec3f) -> Found {
    let a = turned(keep3(v0 - r.o), r.axis);
    let b = turned(keep3(v1 - r.o), r.axis);
    let c = turned(keep3(v2 - r.o), r.axis);
    let depth = vec3f(a.z, b.z, c.z);
    let x = keep3(vec3f(a.x, b.x, c.x) - keep3(r.shear.x * depth));
    let y = keep3(vec3f(a.y, b.y, c.y) - keep3(r.shear.y * depth));
    let z = keep3(r.shear.z * depth);
    let w = keep3(keep3(x.zxy * y.yzx) - keep3(y.zxy * x.yzx));
    let mixed = any(w < vec3f(0.0f)) & any(w > vec3f(0.0f));
    let det = sum3(w);
    return divided(!mixed & (det != 0.0f), vec3f(dot3(w, z), w.y, w.z), vec3f(det));
}

// The side of an edge that a ray along d passes; a and b are its ends seen from the origin.
fn side(d: vec3f, a: vec3f, b: vec3f, edge: vec3f) -> f32 {
    return dot3(d, cross3(keep3(a + b), edge));
}

fn pluecker(r: Beam, v0: vec3f, v1: vec3f, v2: vec3f) -> Found {
    let a = keep3(v0 - r.o);
    let b = keep3(v1 - r.o);
    let c = keep3(v2 - r.o);
    let e1 = keep3(v0 - v2);
    let e2 = keep3(v1 - v0);
    let w = vec3f(side(r.d, b, c, keep3(v2 - v1)), side(r.d, c, a, e1), side(r.d, a, b, e2));
    let n = cross3(e1, e2);
    let det = dot3(r.d, n);
    let total = sum3(w);
    let back = (det < 0.0f) & all(w <= vec3f(0.0f)) & (total < 0.0f);
    let front = (det > 0.0f) & all(w >= vec3f(0.0f)) & (total > 0.0f);
    return divided(front | back, vec3f(dot3(a, n), w.y, w.z), vec3f(det, total, total));
}

// Baldwin and Weber: rows that take the triangle to its own coordinates, then the ray in them.
fn baldwin_webber(r: Beam, v0: vec3f, v1: vec3f, v2: vec3f) -> Found {
    let e1 = keep3(v1 - v0);
    let e2 = keep3(v2 - v0);
    let n = cross3(e1, e2);
    let c = largest_axis(n);
    let axis = vec3u(next_axis(c), next_axis(next_axis(c)), c);
    let along = turned(n, axis);
    let area = along.z != 0.0f;
    let by = select(1.0f, along.z, area);
    let p1 = turned(e1, axis);
    let p2 = turned(e2, axis);
    let at = turned(v0, axis);
    let to_u = keep3(vec3f(p2.y, -p2.x, 0.0f) / by).xy;
    let to_w = keep3(vec3f(-p1.y, p1.x, 0.0f) / by).xy;
    let to_h = keep3(vec3f(along.xy, 0.0f) / by).xy;
    let last_u = -keep(keep(to_u.x * at.x) + keep(to_u.y * at.y));
    let last_w = -keep(keep(to_w.x * at.x) + keep(to_w.y * at.y));
    let last_h = -keep(keep(at.z + keep(to_h.x * at.x)) + keep(to_h.y * at.y));
    let o = turned(r.o, axis);
    let d = turned(r.d, axis);
    let climb = keep(keep(d.z + keep(to_h.x * d.x)) + keep(to_h.y * d.y));
    let height = keep(keep(keep(o.z + keep(to_h.x * o.x)) + keep(to_h.y * o.y)) + last_h);
    let able = area & (climb != 0.0f);
    let t = keep(-height / select(1.0f, climb, able));
    let x = keep(o.x + keep(t * d.x));
    let y = keep(o.y + keep(t * d.y));
    let u = keep(keep(keep(to_u.x * x) + keep(to_u.y * y)) + last_u);
    let w = keep(keep(keep(to_w.x * x) + keep(to_w.y * y)) + last_w);
    return Found(able & (u >= 0.0f) & (w >= 0.0f) & (keep(u + w) <= 1.0f), vec3f(t, u, w));
}

fn tri_of(r: Beam, v0: vec3f, v1: vec3f, v2: vec3f) -> Found {
    if (TRI_TEST == TRI_WOOP) {
        return woop(r, v0, v1, v2);
    }
    if (TRI_TEST == TRI_PLUECKER) {
        return pluecker(r, v0, v1, v2);
    }
    if (TRI_TEST == TRI_BALDWIN_WEBBER) {
        return baldwin_webber(r, v0, v1, v2);
    }
    return moeller_trumbore(r, v0, v1, v2, select(0.0f, MT_RTRS_EPS, TRI_TEST == TRI_MT_RTRS));
}

fn corner(prim: u32, k: u32) -> vec3f {
    let at = 9u * prim + 3u * k;
    return vec3f(corners[at], corners[at + 1u], corners[at + 2u]);
}

// Tests a triangle of the scene, and whether the hit is in the ray's range.
fn tri_test(r: Beam, prim: u32) -> Found {
    let found = tri_of(r, corner(prim, 0u), corner(prim, 1u), corner(prim, 2u));
    let t = found.tuv.x;
    let open = (t > r.tmin) & (t < r.tmax);
    let closed = (t >= r.tmin) & (t <= r.tmax);
    return Found(found.hit & select(closed, open, TRI_TEST == TRI_MT_RTRS), found.tuv);
}
