// The float operations of the shaders here, on numbers of the host. Between fences as in those shaders: the seven of
// gpu/card/probe.h. Then what a compiler is free to do without a fence: a product and a sum, a product of a difference,
// and a sum of three with an order.

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= job.count) {
        return;
    }
    let at = 3u * id.x;
    let a = bitcast<f32>(given[at]);
    let b = bitcast<f32>(given[at + 1u]);
    let c = bitcast<f32>(given[at + 2u]);
    let to = 10u * id.x;
    answer[to] = bitcast<u32>(a + b);
    answer[to + 1u] = bitcast<u32>(a - b);
    answer[to + 2u] = bitcast<u32>(a * b);
    answer[to + 3u] = bitcast<u32>(a / b);
    answer[to + 4u] = bitcast<u32>(1.0f / b);
    answer[to + 5u] = bitcast<u32>(keep(a * b) + c);
    answer[to + 6u] = bitcast<u32>(select(b, a, a < b));
    answer[to + 7u] = bitcast<u32>(a * b + c);
    answer[to + 8u] = bitcast<u32>((a - b) * c);
    answer[to + 9u] = bitcast<u32>((a + b) + c);
}
