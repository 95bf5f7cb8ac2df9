#version 450
/* Measures whether the driver ends loops before their condition does. Each of three invocations
 * runs one kind of loop, and gpu/card/card.c compares the iterations with the number given. `state`
 * prevents a compiler from computing a loop's end. */
layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { uint steps; uint nested; };
layout(std430, set = 0, binding = 0) readonly buffer In { uint seed[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Out { uint result[]; };

uint advance(uint state)
{
    return state * 1664525u + 1013904223u;
}

void main()
{
    uint kind = gl_GlobalInvocationID.x;
    if (kind > 2u)
        return;
    uint state = seed[0], first = 0u, second = 0u;
    if (kind < 2u) { /* one loop, then if kind is 1 another one of the same length */
        while (first < steps && state != 0xFFFFFFFFu) {
            state = advance(state) >> 1;
            first++;
        }
        while (kind == 1u && second < steps && state != 0xFFFFFFFFu) {
            state = advance(state) >> 1;
            second++;
        }
    } else { /* an inner loop of `nested` steps in each step */
        while (first < steps / nested && state != 0xFFFFFFFFu) {
            uint inner = 0u;
            while (inner < nested && state != 0xFFFFFFFFu) {
                state = advance(state) >> 1;
                inner++;
            }
            first++;
            second += inner;
        }
    }
    result[3u * kind] = first;
    result[3u * kind + 1u] = second;
    result[3u * kind + 2u] = state;
}
