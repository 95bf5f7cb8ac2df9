#version 450
#extension GL_GOOGLE_include_directive : require
#include "layout_tiny8.glsl"
#include "trace.glsl"
