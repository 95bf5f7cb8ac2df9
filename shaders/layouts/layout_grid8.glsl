/* Layouts of 8 slots a node, see grid.glsl. */
#define WIDE 8u
#include "grid.glsl"
