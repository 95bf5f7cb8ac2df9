#version 450
#extension GL_GOOGLE_include_directive : require
#include "layout_rtrs_direct.glsl"
#include "trace.glsl"
