#version 450
#extension GL_GOOGLE_include_directive : require
#include "layout_grid2.glsl"
#include "trace.glsl"
