/* Layouts of 2 slots a node, see grid.glsl. */
#define WIDE 2u
#include "grid.glsl"
