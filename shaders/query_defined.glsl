/* Rays that the specification leaves undefined. */
#ifndef QUERY_DEFINED_GLSL
#define QUERY_DEFINED_GLSL

bool is_finite(vec3 v)
{
    uvec3 exponent = floatBitsToUint(v) & 0x7F800000u;
    return exponent.x != 0x7F800000u && exponent.y != 0x7F800000u && exponent.z != 0x7F800000u;
}

/* False if numbers are not finite, or tmin is below 0 or above tmax. */
bool is_defined(vec4 org, vec4 dir)
{
    return is_finite(org.xyz) && is_finite(dir.xyz) && org.w >= 0.0 && org.w <= dir.w;
}

/* A query of more steps than this hangs. */
#define STEPS_MOST 16777216u

#endif
