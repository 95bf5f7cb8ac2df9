#version 450
#extension GL_GOOGLE_include_directive : require
/* The boxes of all nodes, from the leaves up. */
#include "build_climb.glsl"

void main()
{
    uint node = climb_from(gl_GlobalInvocationID.x);
    while (any_on(node != ABI_LINK_NONE)) {
        if (is_second(node != ABI_LINK_NONE, visits_of(node))) {
            uint word = ABI_BUILD_LINK_WORDS * node;
            join_boxes(node, links[word + ABI_LINK_CHILD], links[word + ABI_LINK_CHILD + 1u]);
            node = links[word + ABI_LINK_PARENT];
        } else {
            node = ABI_LINK_NONE;
        }
    }
}
