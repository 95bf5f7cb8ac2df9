// Traces a ray for each invocation. An answer is five words: t, u, v, the triangle, and FLAG_*.

struct Best {
    tuv: vec3f,
    prim: u32,
    t: f32,
}

// Tests the items of a leaf in turn. Returns true if the ray is answered.
fn visit_leaf(beam: Beam, n: Node, best: ptr<function, Best>) -> bool {
    let count = leaf_count(n);
    for (var slot = 0u; slot < count; slot++) {
        let prim = leaf_item(n, slot);
        if (prim >= job.tri_count) {
            continue;
        }
        let found = tri_test(beam, prim);
        if (found.hit && ((*best).prim == NO_PRIM || found.tuv.x < (*best).t)) {
            *best = Best(found.tuv, prim, found.tuv.x);
            if (QUERY == QUERY_ANY) {
                return true;
            }
        }
    }
    return false;
}

fn walk(s: Slab, beam: Beam, root: Node, best: ptr<function, Best>) {
    var n = root;
    var visits = 0u;
    while (!is_nowhere(n) && trouble == 0u) {
        if (visits >= job.refs) {
            trouble |= FLAG_VISITS;
            return;
        }
        visits++;
        if (!is_leaf(n)) {
            n = step(s, n, (*best).t);
        } else if (visit_leaf(beam, n, best)) {
            return;
        } else {
            n = pop((*best).t);
        }
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= job.count) {
        return;
    }
    let at = 8u * id.x;
    let o = bitcast<vec3f>(vec3u(given[at], given[at + 1u], given[at + 2u]));
    let d = bitcast<vec3f>(vec3u(given[at + 4u], given[at + 5u], given[at + 6u]));
    let tmin = bitcast<f32>(given[at + 3u]);
    let tmax = bitcast<f32>(given[at + 7u]);
    var best = Best(vec3f(0.0f), NO_PRIM, tmax);
    if (job.refs > 0u) {
        var s = slab_of(o, d, tmin);
        let root = node_load(job.root);
        slab_place(&s, root.lo, root.hi);
        if (slab_test(s, root.lo, root.hi, tmax).hit) {
            walk(s, beam_of(o, d, tmin, tmax), root.node, &best);
        }
    }
    let to = 5u * id.x;
    answer[to] = bitcast<u32>(best.tuv.x);
    answer[to + 1u] = bitcast<u32>(best.tuv.y);
    answer[to + 2u] = bitcast<u32>(best.tuv.z);
    answer[to + 3u] = best.prim;
    answer[to + 4u] = FLAG_DONE | trouble | select(0u, FLAG_EXHAUSTED, trouble != 0u);
}
