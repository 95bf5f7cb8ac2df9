// Layout rtrs_rf: the record as RTRS's shader reads it. Bit 31 of the tag is set in a leaf; else the upper half is
// the first child, the lower half the second. Of a leaf's items, in the next record, slots 0 to 5 are read (F7), and
// item k is triangle k - 1 (F2).

const ORDER = ORDER_FST;

fn node_load(ref_: u32) -> Loaded {
    let record = nodes[ref_];
    let leaf = (record.w & LEAF) != 0u;
    return Loaded(Node(select(record.w, LEAF | 6u, leaf), ref_ + 1u), half_low(record.xyz),
                  half_high(record.xyz));
}

fn node_fst(n: Node) -> u32 {
    return n.a >> 16u;
}

fn node_snd(n: Node) -> u32 {
    return n.a & 0xFFFFu;
}

// In a tree whose references wrapped around the record of the items may not exist (F9).
fn leaf_count(n: Node) -> u32 {
    return select(0u, n.a & ~LEAF, n.b < job.refs);
}

fn leaf_item(n: Node, slot: u32) -> u32 {
    let word = nodes[n.b][slot >> 1u];
    return ((word >> (16u * (slot & 1u))) & 0xFFFFu) - 1u;
}
