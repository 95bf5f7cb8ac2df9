/* Defines the picture of a scene. Two renderers implement it: one in C (scenes/render/render.h),
 * which drives any engine ray by ray, and one in shaders, which an engine may have.
 *
 * Both follow the same paths to the bit if + - * / of floats are IEEE operations. The order of
 * operations is given below; each renderer is written separately. Products before sums as written;
 * no contraction. pow differs between implementations, so it affects only colours, never a path.
 *
 *   dot(a, b) = (ax bx + ay by) + az bz          unit(v) = v / sqrt(dot(v, v)), three divisions;
 * the sqrt is always rounded to nearest            zero vector if the dot is not in (0, inf)
 *
 * Ray of pixel (x, y), y = 0 at the top, c = view.centre:
 *   nx = (x + c) / width - 0.5, ny = ((height - 1 - y) + c) / height - 0.5
 *   org = view.pos, dir = unit((right nx + up ny) + forward)
 *
 * Segment i = 0 .. bounces - 1: the closest hit in [tmin, tmax]; a miss ends the path. a, b, c are
 * the triangle's vertices, na, nb, nc their normals, e1 = b - a, e2 = c - a:
 *   REPAIRED  P = a + (e1 u + e2 v), w = (1 - u) - v, N = unit((na w + nb u) + nc v)
 *             G = the triangle's unit normal, -G if dot(G, dir) > 0; N = G if N is zero;
 *             N = -N if dot(N, G) < 0
 *   RTRS      P = org + dir t, q = P - a, d00 = dot(e1, e1), d01 = dot(e1, e2), d11 = dot(e2, e2),
 *             d20 = dot(q, e1), d21 = dot(q, e2), den = d00 d11 - d01 d01,
 *             v = (d11 d20 - d01 d21) / den, w = (d00 d21 - d01 d20) / den, u = (1 - v) - w,
 *             N = unit((na u + nb v) + nc w)
 *
 * Lights in order, D = S = 0 before: V = pos - P, far2 = dot(V, V), far = sqrt(far2), L = unit(V),
 * nl = dot(N, L), R = N (2 nl) - L, rv = -dot(R, dir)
 *   REPAIRED  traced if L is not zero, nl > 0 and dot(G, L) > 0: any hit from P + G offset along L
 *             in [tmin, far] is a shadow; else D = D + s nl, S = S + s pow(rv, spec) if rv > 0
 *   RTRS      traced if L is not zero: the closest hit from P + N offset (P - N offset if nl < 0)
 *             along L in [tmin, tmax] is a shadow if its t < far; else D = D + s max(nl, 0),
 *             S = S + s pow(rv, spec), with 0 for pow where rv <= 0 (1 if spec is 0 too)
 *
 * Colour, per channel; total = 0 and weight = 1 before segment 0:
 *   REPAIRED  total = total + ((color (ambience + D)) diffuse + S specular) weight
 *   RTRS      c = (color D) diffuse + S specular; total = total + c, from i = 1 on + c reflective
 * Next segment: M = dir - N (2 dot(N, dir)), dir' = unit(M); ends if dir' is zero
 *   REPAIRED  weight = weight reflective; ends unless weight > 0 and dot(dir', G) > 0;
 *             org' = P + G offset
 *   RTRS      org' = P + N offset, P - N offset if dot(dir', N) < 0
 * Pixel: floor(255 min(max(total, 0), 1) + 0.5) per channel, where NaN is 0.
 *
 * RTRS is the published shader: picture plane of 1 x 1 whatever the aspect, corners of pixels, tmin
 * 0.01, tmax 1000, offset 0.001, reflections weighted by the surface hit, ambience ignored
 * (faults F17, F26, F27). Not reproduced: the naive handler's exclusion of the triangle that a
 * shadow ray starts on. */
#ifndef FRAME_H
#define FRAME_H

#include "ref/abi_frame.h"
#include "ref/engine.h"

#define FRAME_SIDE_MOST    16384u /* pixels */
#define FRAME_BOUNCES_MOST 64u
#define FRAME_TILE_MOST    16u /* RTRS's limit: 256 invocations per workgroup */

enum profile {
    PROFILE_REPAIRED = ABI_PROFILE_REPAIRED,
    PROFILE_RTRS = ABI_PROFILE_RTRS,
};

struct look {
    enum profile profile;
    uint32_t bounces;   /* most segments of a path: 0 (black) to FRAME_BOUNCES_MOST */
    float ambience;     /* light from all directions, >= 0 */
    float camera_light; /* strength of a light at the eye; 0: none */
};

/* How an engine with its own renderer divides the work. */
enum frame_plan {
    FRAME_AUTO,  /* steps if a whole path could reach a driver's loop limit, else whole */
    FRAME_WHOLE, /* a path with all its rays is one invocation */
    FRAME_STEPS, /* one ray of each path per invocation and dispatch */
};

/* Everything of a frame but the view. All borrowed; must stay valid until the next prepare or
 * close. */
struct frame_job {
    struct job job; /* job.query is ignored: closest and any are both traced */
    struct look look;
    uint32_t width, height;        /* pixels: 1 to FRAME_SIDE_MOST */
    const struct shade_tri *shade; /* job.scene->tri_count */
    const struct shade_material *material;
    uint32_t material_count;         /* >= 1; shade[i].material is below it */
    const struct shade_light *light; /* strengths > 0; if look.camera_light > 0, light 0 is at
                                        the eye and its pos is not read */
    uint32_t light_count;            /* 0 to ABI_LIGHTS_MOST */
    float tmin, tmax, offset;
    enum frame_plan plan;
    uint32_t tile; /* side of a workgroup in pixels, 1 to FRAME_TILE_MOST; 0: chosen by the
                      engine */
    bool general;  /* use one pipeline for all scenes: counts read at run time, constants at
                      their maximum */
};

/* Position and orientation of the camera: see the ray of a pixel above. */
struct view {
    float pos[3];
    float right[3], up[3], forward[3];
    float centre; /* of a pixel: 0.5, or 0 as published */
};

/* Output of a frame. The arrays are the caller's; row 0 is at the top. */
struct frame {
    uint32_t *pixel; /* width * height, as in struct image: red in bits 0-7 */
    float *color;    /* NULL, or `total` of each pixel, 3 floats */
    float *bound;    /* NULL, or for each pixel how far 255 total of any channel can be from that of
                     another IEEE renderer whose pow is within Vulkan's precision; set by the
                     renderer in C only */
    struct segment *segment; /* NULL, or `bounces` segments per pixel */
};

#endif
