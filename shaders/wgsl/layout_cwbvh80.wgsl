// Layout cwbvh80: five quads a node of eight children, see ref/layouts/layout_cwbvh80.c for the words.

const WIDE = 8u;

struct Wide {
    quad: array<vec4u, 5>,
}

fn wide_load(n: Node) -> Wide {
    let at = 5u * n.a;
    return Wide(array<vec4u, 5>(nodes[at], nodes[at + 1u], nodes[at + 2u], nodes[at + 3u], nodes[at + 4u]));
}

fn wide_of(ref_: u32) -> Node {
    return Node(ref_, 0u);
}

// Byte `slot` of eight bytes in two words.
fn byte_of(low: u32, high: u32, slot: u32) -> u32 {
    return (select(high, low, slot < 4u) >> (8u * (slot & 3u))) & 0xFFu;
}

// 2^(exponent - 127); the program stores no exponent of 0 or 255.
fn step_of(exponent: u32) -> f32 {
    return bitcast<f32>((exponent & 0xFFu) << 23u);
}

fn wide_child(w: Wide, slot: u32) -> Loaded {
    let head = w.quad[0];
    let base = w.quad[1];
    let step = vec3f(step_of(head.w), step_of(head.w >> 8u), step_of(head.w >> 16u));
    let origin = bitcast<vec3f>(head.xyz);
    let lo = vec3u(byte_of(w.quad[2].x, w.quad[2].y, slot), byte_of(w.quad[2].z, w.quad[2].w, slot),
                   byte_of(w.quad[3].x, w.quad[3].y, slot));
    let hi = vec3u(byte_of(w.quad[3].z, w.quad[3].w, slot), byte_of(w.quad[4].x, w.quad[4].y, slot),
                   byte_of(w.quad[4].z, w.quad[4].w, slot));
    let kind = byte_of(base.z, base.w, slot);
    let inner = head.w >> 24u;
    let before = countOneBits(inner & ((1u << slot) - 1u));
    var n = Node(LEAF | countOneBits(kind >> 5u), base.y + (kind & 31u));
    if (((inner >> slot) & 1u) != 0u) {
        n = Node(base.x + before, 0u);
    }
    return Loaded(n, keep3(origin + keep3(vec3f(lo) * step)), keep3(origin + keep3(vec3f(hi) * step)));
}
