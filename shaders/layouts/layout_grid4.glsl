/* Layouts with 4 slots per node, see grid.glsl. */
#define WIDE 4u
#include "grid.glsl"
