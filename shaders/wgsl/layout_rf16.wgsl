// Layout rf16: a quad a record. Inner: the tag has the record of the first child in bits 16-30, that of the second in
// bits 0-15. Leaf: bit 31, and in bits 0-3 the number of items, 16-bit numbers that fill the next record.

const ORDER = ORDER_NEAR;

fn node_load(ref_: u32) -> Loaded {
    let record = nodes[ref_];
    let leaf = (record.w & LEAF) != 0u;
    let n = Node(select(record.w, LEAF | (record.w & 15u), leaf), ref_ + 1u);
    return Loaded(n, half_low(record.xyz), half_high(record.xyz));
}

fn node_fst(n: Node) -> u32 {
    return n.a >> 16u;
}

fn node_snd(n: Node) -> u32 {
    return n.a & 0xFFFFu;
}

fn leaf_count(n: Node) -> u32 {
    return n.a & 15u;
}

fn leaf_item(n: Node, slot: u32) -> u32 {
    let word = nodes[n.b][slot >> 1u];
    return (word >> (16u * (slot & 1u))) & 0xFFFFu;
}
