/* Tests the two children of an inner node of a binary layout. */
#ifndef WALK_TWO_GLSL
#define WALK_TWO_GLSL

struct two {
    uint ref0, ref1;
    node child0, child1;
    bool hit0, hit1;
    float entry0, entry1;
    bool second; /* if either is hit: the second is visited first */
};

two two_test(slab_ray slab, node n, float tbest)
{
    two t;
    vec3 near0, far0, near1, far1;
    t.ref0 = node_fst(n);
    t.ref1 = node_snd(n);
    t.child0 = node_load(slab, t.ref0, near0, far0);
    t.child1 = node_load(slab, t.ref1, near1, far1);
    t.hit0 = both(slab_test(slab, near0, far0, tbest, t.entry0), t.ref0 < job.node_count);
    t.hit1 = both(slab_test(slab, near1, far1, tbest, t.entry1), t.ref1 < job.node_count);
#if defined(ORDER_NEAR)
    t.second = both(t.hit1, any(bvec2(!t.hit0, t.entry1 < t.entry0)));
#elif defined(ORDER_SND)
    t.second = t.hit1;
#else
    t.second = !t.hit0;
#endif
    return t;
}

#endif
