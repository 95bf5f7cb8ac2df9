// Layout f32: two quads a node, see struct node_f32 of ref/abi.h.

const ORDER = ORDER_NEAR;

fn node_load(ref_: u32) -> Loaded {
    let low = nodes[2u * ref_];
    let high = nodes[2u * ref_ + 1u];
    let n = Node(select(high.w | LEAF, ref_, high.w == 0u), low.w);
    return Loaded(n, bitcast<vec3f>(low.xyz), bitcast<vec3f>(high.xyz));
}

fn node_fst(n: Node) -> u32 {
    return n.a + 1u;
}

fn node_snd(n: Node) -> u32 {
    return n.b;
}
