#version 450
#extension GL_GOOGLE_include_directive : require
#include "layout_half4.glsl"
#include "trace.glsl"
