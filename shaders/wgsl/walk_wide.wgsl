// One step in a tree of WIDE children a node, whose leaves have no records.

// The root, and the box of its children.
fn node_load(ref_: u32) -> Loaded {
    let root = wide_of(ref_);
    let w = wide_load(root);
    var lo = vec3f(REACH);
    var hi = vec3f(-REACH);
    for (var slot = 0u; slot < WIDE; slot++) {
        let child = wide_child(w, slot);
        let there = vec3<bool>(!is_nowhere(child.node));
        lo = select(lo, child.lo, there & (child.lo < lo));
        hi = select(hi, child.hi, there & (child.hi > hi));
    }
    return Loaded(root, lo, hi);
}

// Puts a child among those of its node, which begin at `base`: the nearest on top, of equal ones the first.
fn insert(base: u32, n: Node, entry: f32) {
    var at = waits;
    push(n, entry);
    if (trouble != 0u) {
        return;
    }
    while (at > base && waiting[at - 1u].entry <= entry) {
        waiting[at] = waiting[at - 1u];
        at--;
    }
    waiting[at] = Waiting(n, entry);
}

fn step(s: Slab, n: Node, tbest: f32) -> Node {
    let w = wide_load(n);
    let base = waits;
    for (var slot = 0u; slot < WIDE; slot++) {
        let child = wide_child(w, slot);
        let met = slab_test(s, child.lo, child.hi, tbest);
        if (met.hit && !is_nowhere(child.node)) {
            insert(base, child.node, met.entry);
        }
    }
    return pop(tbest);
}
