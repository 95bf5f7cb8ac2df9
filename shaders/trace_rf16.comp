#version 450
#extension GL_GOOGLE_include_directive : require
#include "layout_rf16.glsl"
#include "trace.glsl"
