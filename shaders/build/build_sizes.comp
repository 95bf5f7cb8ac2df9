#version 450
#extension GL_GOOGLE_include_directive : require
/* How many triangles each subtree has, from the leaves up. */
#include "build_wide.glsl"
#include "build_wait.glsl"

void main()
{
    uint place = gl_GlobalInvocationID.x, node = ABI_LINK_NONE;
    if (place < job.count && job.count > 1u)
        node = links[ABI_BUILD_LINK_WORDS * (job.count - 1u) + place];
    while (any_on(node != ABI_LINK_NONE)) {
        uint word = ABI_BUILD_LINK_WORDS * node;
        if (is_second(node != ABI_LINK_NONE, word + ABI_LINK_VISITS)) {
            links[word + ABI_LINK_FIRST] =
                size_of(links[word + ABI_LINK_CHILD]) + size_of(links[word + ABI_LINK_CHILD + 1u]);
            node = links[word + ABI_LINK_PARENT];
        } else {
            node = ABI_LINK_NONE;
        }
    }
}
