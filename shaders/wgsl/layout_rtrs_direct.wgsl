// Layout rtrs_direct: RTRS's node of three quads, see struct node_rtrs_direct of ref/abi.h. An item slot s is triangle
// s - 1 (F2, F3); slot 0 is the null triangle, whose number is out of range here.

const ORDER = ORDER_SND;

fn node_load(ref_: u32) -> Loaded {
    let head = nodes[3u * ref_];
    let lo = bitcast<vec3f>(nodes[3u * ref_ + 1u].xyz);
    let hi = bitcast<vec3f>(nodes[3u * ref_ + 2u].xyz);
    if (head.w > 0u) {
        return Loaded(Node(LEAF | head.w, head.z), lo, hi);
    }
    return Loaded(Node(min(head.x, LEAF - 1u), head.y), lo, hi);
}

fn node_fst(n: Node) -> u32 {
    return n.a;
}

fn node_snd(n: Node) -> u32 {
    return n.b;
}

fn leaf_count(n: Node) -> u32 {
    return n.a & ~LEAF;
}

fn leaf_item(n: Node, slot: u32) -> u32 {
    return n.b + slot - 1u;
}
