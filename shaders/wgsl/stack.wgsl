// Nodes that wait, with the distances at which the ray enters them.

struct Waiting {
    node: Node,
    entry: f32,
}

var<private> waiting: array<Waiting, STACK>;
var<private> waits: u32 = 0u;
var<private> trouble: u32 = 0u; // FLAG_*, each of which makes the answer invalid

fn push(n: Node, entry: f32) {
    if (waits >= STACK) {
        trouble |= FLAG_STACK;
        return;
    }
    waiting[waits] = Waiting(n, entry);
    waits++;
}

// The next node that is not beyond the best hit; as published: any.
fn pop(tbest: f32) -> Node {
    while (waits > 0u) {
        waits--;
        let top = waiting[waits];
        if (BOX_TEST == BOX_RTRS || top.entry <= tbest) {
            return top.node;
        }
    }
    return nowhere();
}
