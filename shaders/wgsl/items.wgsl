// Items of leaves outside their nodes: numbers of triangles, one a word. Node.b of a leaf is the first one, Node.a
// has their number.

fn leaf_count(n: Node) -> u32 {
    return n.a & ~LEAF;
}

fn leaf_item(n: Node, slot: u32) -> u32 {
    let at = n.b + slot;
    return select(NO_PRIM, items[min(at, max(job.item_count, 1u) - 1u)], at < job.item_count);
}
