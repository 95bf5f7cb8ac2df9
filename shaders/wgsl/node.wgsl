// What a layout's file decodes a node to.

const ORDER_NEAR = 0u; // the nearer child first
const ORDER_FST = 1u;
const ORDER_SND = 2u;

// Inner: a and b belong to the layout, and a has no LEAF. Leaf: a is LEAF and the number of its items, b their place.
// A leaf without items stands for no node.
struct Node {
    a: u32,
    b: u32,
}

struct Loaded {
    node: Node,
    lo: vec3f,
    hi: vec3f,
}

fn is_leaf(n: Node) -> bool {
    return (n.a & LEAF) != 0u;
}

fn nowhere() -> Node {
    return Node(LEAF, 0u);
}

fn is_nowhere(n: Node) -> bool {
    return n.a == LEAF;
}
