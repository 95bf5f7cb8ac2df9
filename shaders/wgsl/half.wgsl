// Half floats by integers alone: a driver may flush subnormals that it unpacks.

// The number of a code. Infinities stand as 2^100, which no bound and no range reaches: WGSL may take infinities as
// absent.
fn half_of(code: u32) -> f32 {
    let magnitude = code & 0x7FFFu;
    let sign = (code & 0x8000u) << 16u;
    var bits = (magnitude << 13u) + 0x38000000u;
    if (magnitude < 0x400u) {
        bits = bitcast<u32>(keep(f32(magnitude) * 5.9604644775390625e-8f)); // times 2^-24: exact
    }
    bits = select(bits, 0x71800000u, magnitude >= 0x7C00u);
    return bitcast<f32>(bits | sign);
}

// The lower bounds stand in the low halves, the upper ones in the high halves.
fn half_low(word: vec3u) -> vec3f {
    return vec3f(half_of(word.x & 0xFFFFu), half_of(word.y & 0xFFFFu), half_of(word.z & 0xFFFFu));
}

fn half_high(word: vec3u) -> vec3f {
    return vec3f(half_of(word.x >> 16u), half_of(word.y >> 16u), half_of(word.z >> 16u));
}
