// Layout rtrs_rf_paper: the record as the paper's Listing 6 reads it. Bit 31 of the tag is set in a leaf; else bits
// 0-14 are the first child, bits 16-30 the second. The next record has eight items: two of 15 bits in its tag, then
// six of 16 bits; 0 is empty.

const ORDER = ORDER_SND;

fn node_load(ref_: u32) -> Loaded {
    let record = nodes[ref_];
    let leaf = (record.w & LEAF) != 0u;
    return Loaded(Node(select(record.w, LEAF | 8u, leaf), ref_ + 1u), half_low(record.xyz),
                  half_high(record.xyz));
}

fn node_fst(n: Node) -> u32 {
    return n.a & 0x7FFFu;
}

fn node_snd(n: Node) -> u32 {
    return (n.a >> 16u) & 0x7FFFu;
}

// In a tree cut to 15 bits the record of the items may not exist.
fn leaf_count(n: Node) -> u32 {
    return select(0u, n.a & ~LEAF, n.b < job.refs);
}

fn leaf_item(n: Node, slot: u32) -> u32 {
    let record = nodes[n.b];
    let pair = slot >> 1u;
    let word = select(record[(pair + 3u) & 3u], record.w & 0x7FFF7FFFu, pair == 0u);
    let stored = (word >> (16u * (slot & 1u))) & 0xFFFFu;
    return select(stored, NO_PRIM, stored == 0u);
}
