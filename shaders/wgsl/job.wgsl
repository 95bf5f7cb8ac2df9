// Inputs and outputs of every shader here, and the fence. The program puts constants before it: BOX_TEST,
// TRI_TEST, QUERY, STACK (values of ref/abi.h).
//
// WGSL has no `precise`. A compiler may put the operations of an expression into another order, and may fuse them
// (WGSL, "Reassociation and Fusion"); it may also take infinities and NaN as absent ("Finite Math Assumption").
// So no shader here makes an infinity for a ray that is within the contract, and the result of each operation that
// another one uses passes a fence: its bits are changed by an integer operation with a number that is 0, which
// no compiler knows. What is left is the error that WGSL allows a single operation.

struct Job {
    count: u32,
    root: u32,
    refs: u32,      // references that are in range, also the most visits of a ray
    item_count: u32,
    tri_count: u32,
    nothing: u32,   // 0
    unused0: u32,
    unused1: u32,
}

@group(0) @binding(0) var<uniform> job: Job;
@group(0) @binding(1) var<storage, read> given: array<u32>;
@group(0) @binding(2) var<storage, read_write> answer: array<u32>;
@group(0) @binding(3) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(4) var<storage, read> items: array<u32>;
@group(0) @binding(5) var<storage, read> corners: array<f32>;

const NO_PRIM = 0xFFFFFFFFu;
const LEAF = 0x80000000u; // in Node.a of a leaf

const FLAG_DONE = 1u;
const FLAG_EXHAUSTED = 2u;
const FLAG_STACK = 4u;
const FLAG_VISITS = 8u;
const FLAG_LOOP = 16u;

fn keep(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ job.nothing);
}

fn keep3(x: vec3f) -> vec3f {
    return bitcast<vec3f>(bitcast<vec3u>(x) ^ vec3u(job.nothing));
}
