/* Layouts with 2 slots per node, see grid.glsl. */
#define WIDE 2u
#include "grid.glsl"
