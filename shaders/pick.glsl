/* Conditions without branches. The compiler makes branches of && and ?: unless both operands are
 * names, and one driver's compile time and memory grow exponentially with the branches in a
 * loop. */
#ifndef PICK_GLSL
#define PICK_GLSL

bool both(bool a, bool b)
{
    return all(bvec2(a, b));
}

bool both(bool a, bool b, bool c)
{
    return all(bvec3(a, b, c));
}

float pick(bool c, float a, float b)
{
    return c ? a : b;
}

uint pick(bool c, uint a, uint b)
{
    return c ? a : b;
}

vec2 pick(bool c, vec2 a, vec2 b)
{
    return c ? a : b;
}

vec3 pick(bool c, vec3 a, vec3 b)
{
    return c ? a : b;
}

vec4 pick(bool c, vec4 a, vec4 b)
{
    return c ? a : b;
}

#endif
