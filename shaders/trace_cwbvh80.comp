#version 450
#extension GL_GOOGLE_include_directive : require
#include "layout_cwbvh80.glsl"
#include "trace.glsl"
