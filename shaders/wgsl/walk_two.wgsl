// One step in a tree of two children a node.

fn step(s: Slab, n: Node, tbest: f32) -> Node {
    let fst = node_fst(n);
    let snd = node_snd(n);
    let last = max(job.refs, 1u) - 1u;
    let child0 = node_load(min(fst, last));
    let child1 = node_load(min(snd, last));
    let met0 = slab_test(s, child0.lo, child0.hi, tbest);
    let met1 = slab_test(s, child1.lo, child1.hi, tbest);
    let hit0 = met0.hit & (fst < job.refs);
    let hit1 = met1.hit & (snd < job.refs);
    if (hit0 & hit1) {
        let second = ORDER == ORDER_SND || (ORDER == ORDER_NEAR && met1.entry < met0.entry);
        if (second) {
            push(child0.node, met0.entry);
            return child1.node;
        }
        push(child1.node, met1.entry);
        return child0.node;
    }
    if (hit0) {
        return child0.node;
    }
    if (hit1) {
        return child1.node;
    }
    return pop(tbest);
}
