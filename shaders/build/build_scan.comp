#version 450
#extension GL_GOOGLE_include_directive : require
/* Adds up the counts of the digits. */
#include "build_digit.glsl"
#include "build_sum.glsl"

void main()
{
    sum_counts(DIGITS * job.blocks);
}
