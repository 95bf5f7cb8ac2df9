/* Oriented boxes that nodes of a layout store beside boxes, and their test. */
#ifndef OBLIQUE_BOX_H
#define OBLIQUE_BOX_H

/* A ray for layout->misses. What lies `by` beside it counts as met, and so does what is met at a
 * distance of `least` or more, which may be negative. */
struct oblique_ray {
    float org[3], dir[3];
    float by, least;
};

/* The test of an oriented box by layout->misses, step by step. */
struct oblique_box {
    float axis[3][3];         /* of whole numbers */
    float lo[3], hi[3];       /* bounds of the products of points and axes, as stored */
    float step[3];            /* between stored bounds */
    float beside[3];          /* by which the test moves the bounds apart, for this ray */
    float enter[3], leave[3]; /* distances between the bounds; a ray along them: all or none */
    float slack;              /* of distances: their share by which the test lets a ray pass */
};

#endif
