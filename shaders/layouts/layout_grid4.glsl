/* Layouts of 4 slots a node, see grid.glsl. */
#define WIDE 4u
#include "grid.glsl"
