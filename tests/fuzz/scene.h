/* People, and how cameras and detectors see them, drawn from bytes: usual ones, and all that is hard.  In double
 * precision; native.h converts them to an arithmetic.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FUZZ_SCENE_H
#define EDML_FUZZ_SCENE_H

#include "edmlift.h"
#include "fuzz.h"

typedef struct {
    double x, y, z;
} place3;

typedef struct {
    double x, y, c;
} sighting;

typedef struct {
    double fx, fy, cx, cy;
} pinhole;

/* Points in metres about mid-hip: people, flat and thin ones, points that coincide, at the ends of the range of
 * poses (4 m), or anywhere.  Half of them are people. */
void draw_points(place3 x[EDML_JOINTS], choices *from);

/* The same, within 4 m but for one in 64. */
void draw_pose(place3 x[EDML_JOINTS], choices *from);

/* A camera, usual but for its extremes; `far` is somewhere before it, 0.2 to 150 m away. */
void draw_camera(pinhole *by, place3 *far, choices *from);

/* What a detector sees of points: with noise, missing and doubtful joints, joints that coincide, swapped sides,
 * and coordinates that are no numbers or at the ends of their range.
 *   by  a camera that has them at `far`, or NULL: from far away, 200 pixels a metre */
void draw_sightings(sighting in[EDML_JOINTS], const place3 x[EDML_JOINTS], const pinhole *by, place3 far,
                    choices *from);

/* A frame's keypoints, for a lift. */
void draw_frame(sighting in[EDML_JOINTS], choices *from);

/* Coordinates to a 16th of a pixel within 2048: shifts and powers of two lose nothing. */
void round_sightings(sighting in[EDML_JOINTS]);

/* A number that is hard to compute with: no number, at an end of a range, or beside one. */
double draw_extreme(choices *from);

/* An upward direction of any length, and now and then of none; 0: it is not known. */
int draw_up(place3 *up, choices *from);

#endif
