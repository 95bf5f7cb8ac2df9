/* Sums over all counts. */
#ifndef BUILD_SUM_GLSL
#define BUILD_SUM_GLSL

shared uint run_sum[ABI_BUILD_GROUP];

/* Each of the first `all` counts becomes the sum of those before it. One workgroup, of which all
 * invocations call it: an invocation adds up a run, the sums of the runs are added up in shared
 * memory. Returns its run, from x to before y. */
uvec2 sum_counts(uint all)
{
    uint mine = gl_LocalInvocationID.x;
    uint run = (all + ABI_BUILD_GROUP - 1u) / ABI_BUILD_GROUP;
    uint first = min(mine * run, all), last = min(first + run, all), sum = 0u;
    for (uint i = first; i < last; i++)
        sum += counts[i];
    run_sum[mine] = sum;
    barrier();
    for (uint step = 1u; step < ABI_BUILD_GROUP; step <<= 1) {
        uint before = mine >= step ? run_sum[mine - step] : 0u;
        barrier();
        run_sum[mine] += before;
        barrier();
    }
    uint before = run_sum[mine] - sum;
    for (uint i = first; i < last; i++) {
        uint own = counts[i];
        counts[i] = before;
        before += own;
    }
    return uvec2(first, last);
}

#endif
