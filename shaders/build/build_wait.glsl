/* The way up from the leaves of a tree: the invocation that is second at a node goes on. The buffer
 * of the links is declared before this file is included. */
#ifndef BUILD_WAIT_GLSL
#define BUILD_WAIT_GLSL

shared uint group_on;

/* Returns whether any invocation of the workgroup is still on its way. All of them call it and
 * is_second equally often: Mesa's lavapipe 22.3 runs a memory barrier as a barrier of execution, so
 * one in a loop that some have left would lose the others. */
bool any_on(bool on)
{
    barrier();
    if (gl_LocalInvocationID.x == 0u)
        group_on = 0u;
    barrier();
    if (on)
        atomicOr(group_on, 1u);
    barrier();
    return group_on != 0u;
}

/* Returns true if the other child of a node, whose visits are counted in that word of the links,
 * was done before, so that this invocation does the node. What each wrote before is then visible to
 * the second. */
bool is_second(bool on, uint visits)
{
    uint before = 0u;
    memoryBarrierBuffer();
    if (on)
        before = atomicAdd(links[visits], 1u);
    memoryBarrierBuffer();
    return on && before == 1u;
}

#endif
