// A ray against boxes: the formulas of ref/primitives/slab.h.

const PARALLEL = 8.67361737988403547e-19f; // 2^-60
const FAR = 1.0000019073486328125f;        // 1 + 2^-19
const NEAR = 0.999996185302734375f;        // 1 - 2^-18
const BEHIND = 0.0000019073486328125f;     // 2^-19
const RTRS_EPS = 0.000002f;
const RTRS_INF = 274877906944.0f;          // 2^38
const REACH = 8.507059173023461586e37f;    // 2^126

struct Slab {
    o: vec3f,
    d: vec3f,
    inv: vec3f,            // 1 / d, 1 where the ray is parallel
    reach: vec3f,          // a distance whose product with inv is in range
    crosses: vec3<bool>,   // not parallel
    down: vec3<bool>,      // the upper bound is met first
    tmin: f32,
    behind: f32,
}

fn slab_of(o: vec3f, d: vec3f, tmin: f32) -> Slab {
    var s: Slab;
    let size = abs(d);
    var largest = select(0.0f, size.x, size.x > 0.0f);
    largest = select(largest, size.y, size.y > largest);
    largest = select(largest, size.z, size.z > largest);
    let least = keep(PARALLEL * largest);
    s.o = o;
    s.d = d;
    s.crosses = (size > vec3f(0.0f)) & (size >= vec3f(least));
    s.inv = select(vec3f(1.0f), keep3(1.0f / select(vec3f(1.0f), d, s.crosses)), s.crosses);
    s.reach = keep3(select(size, vec3f(1.0f), size > vec3f(1.0f)) * REACH);
    s.down = (d < vec3f(0.0f)) & s.crosses;
    s.tmin = tmin;
    s.behind = 0.0f;
    return s;
}

// Distances of planes in multiples of d. Those of planes that are out of every range are cut to 2^126, so that
// nothing overflows.
fn slab_distance(s: Slab, plane: vec3f) -> vec3f {
    let apart = keep3(plane - s.o);
    let above = select(apart, s.reach, apart > s.reach);
    let within = select(above, -s.reach, above < -s.reach);
    return keep3(within * s.inv);
}

fn slab_main(s: Slab, v: vec3f) -> f32 {
    let size = abs(s.d);
    let first = select(v.x, v.y, size.y > size.x);
    return select(first, v.z, size.z > max(size.x, size.y));
}

// For the watertight test: the scene's extent behind the origin; lo and hi are its box.
fn slab_place(s: ptr<function, Slab>, lo: vec3f, hi: vec3f) {
    let met = select(lo, hi, (*s).down);
    let along = slab_main(*s, slab_distance(*s, met));
    (*s).behind = select(0.0f, keep(-along * BEHIND), along < 0.0f);
}

struct Met {
    hit: bool,
    entry: f32,
}

fn slab_span(s: Slab, a: vec3f, b: vec3f, tbest: f32) -> vec2f {
    let from_each = select(vec3f(s.tmin), a, s.crosses);
    let to_each = select(vec3f(tbest), b, s.crosses);
    var from_t = s.tmin;
    var to_t = tbest;
    from_t = select(from_t, from_each.x, from_each.x > from_t);
    from_t = select(from_t, from_each.y, from_each.y > from_t);
    from_t = select(from_t, from_each.z, from_each.z > from_t);
    to_t = select(to_t, to_each.x, to_each.x < to_t);
    to_t = select(to_t, to_each.y, to_each.y < to_t);
    to_t = select(to_t, to_each.z, to_each.z < to_t);
    return vec2f(from_t, to_t);
}

fn slab_closed(s: Slab, lo: vec3f, hi: vec3f, tbest: f32) -> Met {
    let beside = all(s.crosses | ((lo <= s.o) & (s.o <= hi)));
    let a = slab_distance(s, select(lo, hi, s.down));
    let b = slab_distance(s, select(hi, lo, s.down));
    if (BOX_TEST == BOX_WATERTIGHT) {
        let span = slab_span(s, a, b, tbest);
        let entry = keep(keep(span.x * NEAR) - s.behind);
        return Met(beside & (entry <= span.y), entry);
    }
    let span = slab_span(s, a, keep3(b * FAR), tbest);
    return Met(beside & (span.x <= span.y), span.x);
}

// As published: a component of d that is 0 divides by it, and WGSL does not say what that gives.
fn slab_published(s: Slab, lo: vec3f, hi: vec3f) -> Met {
    let p = keep3(keep3(keep3(lo - RTRS_EPS) - s.o) / s.d);
    let q = keep3(keep3(keep3(hi + RTRS_EPS) - s.o) / s.d);
    let lesser = select(q, p, p < q);
    let greater = select(p, q, p < q);
    var from_t = lesser.x;
    var to_t = greater.x;
    let low = select(vec3f(-RTRS_INF), lesser, lesser < vec3f(-RTRS_INF));
    let high = select(vec3f(RTRS_INF), greater, greater > vec3f(RTRS_INF));
    from_t = max(max(from_t, low.y), low.z);
    to_t = min(min(to_t, high.y), high.z);
    return Met(from_t < to_t, from_t);
}

fn slab_test(s: Slab, lo: vec3f, hi: vec3f, tbest: f32) -> Met {
    if (BOX_TEST == BOX_RTRS) {
        return slab_published(s, lo, hi);
    }
    return slab_closed(s, lo, hi, tbest);
}
