/* Converts cameras to views of a frame, and turns them around their target. */
#ifndef CAMERA_H
#define CAMERA_H

#include "ref/frame.h"

/* The view of a camera for pictures of width x height.
 *   PROFILE_RTRS      forward = unit(at - pos), right = forward x (0, 1, 0) not normalised,
 *                     up = (0, 1, 0) (neither is unit length or orthogonal: F26), centre 0
 *   PROFILE_REPAIRED  an orthonormal basis (up from +y; from +z if it looks straight up or down),
 *                     `right` scaled by width / height: 53.13 degrees from top to bottom;
 *                     centre 0.5
 * Computed in float, with the operations of ref/frame.h. A camera at its target looks along -z. */
struct view camera_view(const struct camera *camera, enum profile profile, uint32_t width,
                        uint32_t height);

/* The camera rotated by `angle` radians around the vertical axis through its target; distance and
 * height do not change. x = at.x + r cos, z = at.z + r sin: angles grow from x to z, as RTRS's left
 * arrow turns. Computed in double from the original camera. */
struct camera camera_orbit(const struct camera *camera, double angle);

#define CAMERA_SHARE 0.8 /* of the picture's width or height that a framed model fills */

/* How a picture frames a scene that has no camera of its own. */
enum framing {
    FRAMING_MODEL,    /* the model fills CAMERA_SHARE of the width or height, whichever binds */
    FRAMING_TURN,     /* it stays within CAMERA_SHARE while the camera orbits */
    FRAMING_OVERVIEW, /* scene_camera's, which benchmarks share */
};

/* The scene's camera; without one it looks along scene_camera's direction, as near as `framing`
 * allows for pictures of width x height. It can be beyond the range of floats. For a single point,
 * or no triangle, it is scene_camera's. */
struct camera camera_of_scene(const struct scene *scene, enum framing framing, enum profile profile,
                              uint32_t width, uint32_t height);

#endif
