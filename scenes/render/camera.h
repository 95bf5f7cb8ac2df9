/* Cameras: from a scene's camera to the view of a frame, and around its target. */
#ifndef CAMERA_H
#define CAMERA_H

#include "ref/frame.h"

/* The view of a camera for pictures of that size.
 *   PROFILE_RTRS      forward = unit(at - pos), right = forward x (0, 1, 0) as it comes, up = (0,
 * 1, 0) (both neither unit nor orthogonal: F26), centre 0 PROFILE_REPAIRED  an orthonormal basis
 * (up from +y; from +z where it looks straight up or down), `right` scaled by width / height: 53.13
 * degrees from top to bottom; centre 0.5 Computed in float, as ref/frame.h writes operations. A
 * camera at its target looks along -z. */
struct view camera_view(const struct camera *camera, enum profile profile, uint32_t width,
                        uint32_t height);

/* The camera after turning by `angle` radians around the vertical axis through its target, the
 * distance kept: x = at.x + r cos, z = at.z + r sin, angles growing from x to z as RTRS's left
 * arrow turns. The height stays. Computed from the original each time, in double. */
struct camera camera_orbit(const struct camera *camera, double angle);

#endif
