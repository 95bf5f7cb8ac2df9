/* Inputs and outputs of every rendering shader; see ref/abi_frame.h. Constants describe the scene,
 * so that the pipeline has no unneeded code. */
#ifndef RENDER_JOB_GLSL
#define RENDER_JOB_GLSL

#include "ref/abi_frame.h"

layout(constant_id = ABI_SPEC_PROFILE) const uint PROFILE = ABI_PROFILE_REPAIRED;
layout(constant_id = ABI_SPEC_BOUNCES) const uint BOUNCES = 1u;
layout(constant_id = ABI_SPEC_LIGHTS) const uint LIGHTS = 0u;
layout(constant_id = ABI_SPEC_STEPS) const bool STEPS = false;
layout(constant_id = ABI_SPEC_TILE) const uint TILE = 16u;
layout(constant_id = ABI_SPEC_LOOK) const uint LOOK = 0u;

layout(push_constant) uniform Push { frame_push job; };

layout(std430, set = 0, binding = ABI_BIND_STATE) buffer State { uvec4 state_quad[]; };
layout(std430, set = 0, binding = ABI_BIND_PIXELS) writeonly buffer Pixels { uint pixel_word[]; };
layout(std430, set = 0, binding = ABI_BIND_SEGMENTS) writeonly buffer Segments
{
    uvec4 segment_quad[];
};
layout(std430, set = 0, binding = ABI_BIND_COLORS) writeonly buffer Colors { float color_word[]; };
layout(std430, set = 0, binding = ABI_BIND_SHADE) readonly buffer Shade { vec4 shade_quad[]; };

/* Returns true if the pipeline has code for `what` (ABI_LOOK_*). */
bool has(uint what)
{
    return (LOOK & what) != 0u;
}

bool repaired()
{
    return PROFILE == ABI_PROFILE_REPAIRED;
}

uint bounce_count()
{
    return has(ABI_LOOK_GENERAL) ? job.bounces : BOUNCES;
}

uint light_count()
{
    return has(ABI_LOOK_GENERAL) ? job.lights : LIGHTS;
}

/* Returns true if light 0 moves with the eye. */
bool light_at_eye()
{
    return has(ABI_LOOK_GENERAL) ? (job.look & ABI_LOOK_EYE) != 0u : has(ABI_LOOK_EYE);
}

#endif
