/* Layouts with 8 slots per node, see grid.glsl. */
#define WIDE 8u
#include "grid.glsl"
