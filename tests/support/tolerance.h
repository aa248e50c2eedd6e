/* How near is near enough, and why.  Metres unless said otherwise; float32 has 24 bits, 6e-8.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TEST_TOLERANCE_H
#define EDML_TEST_TOLERANCE_H

/* Any short sum of float32 numbers of about 1, or of Q24 ones: a few dozen units in the last place
 * at most. */
#define ROUNDING 5e-6F

/* ---- The body's frame, in half extents; and EDM ---- */
#define EDM_TOLERANCE 1e-6F /* values to 11; a sum of squares and a root */
#define FRAME_TOLERANCE 2e-6F
#define FRAME_GUESSED_TOLERANCE 5e-6F
#define FRAME_ROLLED_TOLERANCE 2e-5F /* pixels rounded anew, and short axes; measured 8e-6 */
#define FRAME_SCALED_TOLERANCE 4e-6F /* coordinates rounded anew: 1000 half-ulps over 165 pixels */
#ifndef EDML_TEST_Q24
#define FRAME_LEAST_SCALE 0.01F
#define FRAME_LARGEST_SCALE 100.0F
#define FRAME_FLOAT_MEMBERS 3
#else /* pixels rounded to 2^-16; every confidence is finite */
#define FRAME_LEAST_SCALE 0.5F
#define FRAME_LARGEST_SCALE 8.0F
#define FRAME_FLOAT_MEMBERS 2
#endif

/* ---- Jacobi; relative to the Frobenius norm of the matrix ---- */
#ifndef EDML_TEST_Q24
#define ORTHONORMAL_TOLERANCE 4e-6F /* up to 500 rotations, each with rounding of 1e-7, at random */
#define EIGENPAIR_TOLERANCE 4e-6F   /* the same, and 91 entries of 6e-8 left off the diagonal */
#define TRACE_TOLERANCE 4e-6F
#else /* roots are rounded down: not at random; 91 entries of 5e-7, of matrices of norm 1 and more */
#define ORTHONORMAL_TOLERANCE 2e-5F
#define EIGENPAIR_TOLERANCE 2e-5F
#define TRACE_TOLERANCE 1e-5F
#endif

/* ---- What networks read and give ---- */
#ifndef EDML_TEST_Q24
#define INPUT_TOLERANCE 5e-6F /* values to 8 */
#define MIRRORED_METRES 0.0F
#define MIRRORED_SHARE 0.0F
#define MIRRORED_POINTS 1e-6F /* of the mean, whose sum has another order */
#define TURNED_METRES 1e-5F
#else /* softened distances to 2^-12 each; inputs to 2^-12, halves up, on either side of zero */
#define INPUT_TOLERANCE 1.5e-3F
#define MIRRORED_METRES 3e-3F
#define MIRRORED_SHARE 0.03F
#define MIRRORED_POINTS 3e-3F
#define TURNED_METRES 3e-3F
#endif

/* ---- Quantised networks, RMS against the float one, on people of helpers.c ---- */
#define NET_F32_TOLERANCE 2e-5F /* against double, of outputs of about 1 */
#define NET_W16_TOLERANCE 4e-4F /* activations of 14 bits; measured 0.22 mm */
#define NET_W8_TOLERANCE 8e-3F  /* measured 4.1 mm */

/* ---- FConv, the small one of fconv_tiny.h ---- */
#define FCONV_TOLERANCE 2e-6F    /* measured 2.4e-7; a few hundred sums of values to 8 */
#define FCONV_W8_TOLERANCE 1e-4F /* activations rounded to 1/8192; measured 2.4e-5 */
#define FCONV_LIFT_TOLERANCE 1e-4F

/* ---- MDS ---- */
#define MDS_TOLERANCE 5e-5F      /* 0.05 mm: the header's promise */
#define MDS_FLAT_TOLERANCE 2e-3F /* root of a rounding error: sqrt(4e-6 m^2) */
#define MDS_CLOSE_TOLERANCE 2e-4F /* 1e-7 of rounded distances, over a gap of 9e-4, of 0.08 m */
#define MDS_NEAR_TOLERANCE 7.5e-5F /* some 4e-7 m^2 of rounding, over a gap of 3e-3 m^2, of 0.57 m */
#define MDS_EQUAL_TOLERANCE 1e-3F /* m^2: eigenvalues within 2^-14 of a norm of 4 are not told apart */
#define MDS_CENTROID_TOLERANCE 1e-5F
#define MDS_AXES_TOLERANCE 1e-4F /* m^2; SPLIT is 2^-20 of some m^2, and the rotations' rounding */

/* ---- Refinement ---- */
#ifndef EDML_TEST_Q24
#define STRESS_TOLERANCE(expected) (1e-5F * (expected)) /* differences of squares cancel */
#define REFINE_FARTHEST 4.0F                            /* distances, metres */
#define REFINE_BAD_START 4.0F
#define REFINE_REACH HUGE_VALF
#define REFINE_REFLECTED_TOLERANCE 0.0F
#else
#define STRESS_TOLERANCE(expected) (1e-6F + 0 * (expected)) /* distances rounded to 6e-8 */
#define REFINE_FARTHEST 3.0F                                /* the range, stages.h */
#define REFINE_BAD_START 2.3F
#define REFINE_REACH 8.0F
#define REFINE_REFLECTED_TOLERANCE 1e-5F /* measured 2.9e-6 */
#endif
#define REFINE_STAY_TOLERANCE 1e-5F
#define REFINE_SQUARE_TOLERANCE 5e-5F
#define REFINE_RAW_TOLERANCE 5e-5F
#define REFINE_EQ2_TOLERANCE 3e-3F
#define REFINE_ROTATED_TOLERANCE 1e-4F
/* In Q24, against float32. */
#define STRESS_Q24_TOLERANCE 1e-6F /* absolute, of values to 0.1; distances rounded to 6e-8 */
#define REFINE_Q24_TOLERANCE 1e-4F /* five steps; measured 2.7e-5, 3e-5 and 5e-6 */
#define REFINE_Q24_RISE 1e-3F      /* relative, of the objective; measured 3e-5 */

/* ---- Mirror, log-odds ---- */
#ifndef EDML_TEST_Q24
#define MARGIN_TOLERANCE 2e-5F
#else /* cosines to 2^-24 / (a bone of 0.1 m times a normal of 0.01 m^2), weights up to 6 */
#define MARGIN_TOLERANCE 5e-4F
#endif

/* ---- Orientation ---- */
/* Exact points and an exact image still leave a tilt: the ridges of orient.h turn a thin body too
 * little, the thinner the more.  Worst joint of people with 1, 2, 4 and 8 % of their spread (or up
 * to twice that) along their thinnest axis; measured 0.021, 0.0024, 0.0013 and under 0.001. */
#define ORIENT_PERSON_TOLERANCES {0.03F, 0.004F, 0.002F, 0.001F}
#define ORIENT_UNSEEN_TOLERANCE 0.012F /* 4 %, two joints not seen; measured 0.0078 */
#define ORIENT_CLOUD_TOLERANCE 0.0005F /* 16 %; measured 0.0003 */
#define ORIENT_EVEN_TOLERANCE 5e-6F    /* the same spread on all axes: no bias is left */
#define ORIENT_FRAME_TOLERANCE 5e-5F   /* rounding, enlarged by the division by a thin spread */

/* ---- Alignment, metres ---- */
#define ALIGN_TOLERANCE 2e-5F /* rounding of ten squarings of a 4x4 matrix */

/* ---- Fusion, metres ---- */
#define FUSE_TOLERANCE 4e-6F
/* The root of a difference of sums: where the two agree, of rounding alone. */
#ifndef EDML_TEST_Q24
#define FUSE_KEPT 0.0F
#define FUSE_MISFIT_TOLERANCE 1e-3F
#else /* points are rounded to 2^-24 on their way in */
#define FUSE_KEPT 1e-7F
#define FUSE_MISFIT_TOLERANCE 2e-3F
#endif

/* ---- Camera ---- */
#ifndef EDML_TEST_Q24
#define LIFT_OFF_AXIS_TOLERANCE 1e-4F
#else /* keypoints, up and joints rounded to 2^-16 */
#define LIFT_OFF_AXIS_TOLERANCE 2e-3F
#endif
/* Exact points of people 2 to 12 m away: degrees, relative to the distance, pixels; and of 1.6 to 60 m. */
#ifndef EDML_TEST_Q24 /* keypoints rounded to 3e-5 pixels; measured 0.0002, 3e-6 and 0.0001 */
#define PLACE_DEGREES 0.002F
#define PLACE_RELATIVE 1e-5F
#define PLACE_PIXELS 0.001F
#define PLACE_NOISY_PIXELS 0.002F
#define PLACE_ROTATION 1e-5F /* products of its rows */
#define PLACE_AXES 0.002F /* metres, with noise of 5 pixels: the steps end a little apart */
#else /* points, rotation and pixels rounded to 2^-16; measured 0.0045, 3e-5 and 0.0043 */
#define PLACE_DEGREES 0.01F
#define PLACE_RELATIVE 1e-4F
#define PLACE_PIXELS 0.01F
#define PLACE_NOISY_PIXELS 0.005F
#define PLACE_ROTATION 3e-5F /* half a unit in the last place of each component: 2.6e-5 */
#define PLACE_AXES 0.005F /* measured 0.0038 */
#endif
#define PATH_TOLERANCE 2e-3F      /* metres: places rounded to 2^-16 m, over steps of 16 ms */
#define PATH_RATE_TOLERANCE 0.02F /* m/s */
#define PLACE_FAR_DEGREES 0.05F
#define PLACE_FAR_RELATIVE 1e-3F
#define PLACE_JOINT 1e-3F /* metres */
#define PLACE_FLAT_PIXELS 0.1F
#define PLACE_FLAT_RELATIVE 0.01F
#define PLACE_FLAT_LOST 2 /* of 20,000; measured 1 in float, 2 in fixed point */
#define PLACE_SWEEP_RELATIVE 0.01F

#define STEP_ROTATION 1e-5F /* radians; where the best is twice as good as the next, or more */
#define STEP_TRACE 2e-3F    /* of entries to 3: where two are nearly as good, either may be found */
#define STEP_ERROR 1e-4F    /* relative: rounding at the minimum */

/* ---- Body, quality, standing ---- */
#ifndef EDML_TEST_Q24
#define BODY_TOLERANCE ROUNDING
#define BODY_COSINE 0.999999    /* a bone of 0.1 m, and two joints to 1e-7 */
#define QUALITY_TOLERANCE 1e-4F /* a misfit of 1e-4 m by rounding, times 24 a metre */
#define SCORE_TOLERANCE 1e-3F   /* log-odds */
#define STAND_TOLERANCE 1e-5F
#else /* joints, lengths and upwards rounded to 2^-16, in and out */
#define BODY_TOLERANCE 1e-4F
#define BODY_COSINE 0.999
#define QUALITY_TOLERANCE 1e-3F
#define SCORE_TOLERANCE 5e-3F /* of a quality of 0.98, rounded to 2^-16 */
#define STAND_TOLERANCE 1e-4F
#endif

/* ---- Angles, degrees ---- */
#ifndef EDML_TEST_Q24
#define ARCTANGENT_TOLERANCE 2e-5 /* the last place of 180 is 1.5e-5; measured 1.2e-5 */
#define ANGLE_TOLERANCE 1e-4F
#define ANYONE_S_ANGLE_TOLERANCE 1e-3F
#else
#define ARCTANGENT_TOLERANCE 1e-5     /* rounded to 2^-16: 7.6e-6; measured 9.5e-6 */
#define ANGLE_TOLERANCE 0.02F         /* joints rounded to 2^-16, of bones of 0.2 m and more */
#define ANYONE_S_ANGLE_TOLERANCE 0.1F /* axes and angles from a quarter of a bone each: 16 times as much */
#endif
#define ANGLES_LOST 5              /* of 10000: those with just a quarter of a bone in their plane */
#define FIXED_ANGLE_TOLERANCE 0.1F /* beside float, of people: as above; measured 0.037 */
#define FIXED_ANGLES_LOST 20       /* of 80000 */

/* ---- Joint limits: poses that are counted otherwise, as a bone is at the border of a cell ---- */
#ifndef EDML_TEST_Q24
#define LIMITS_ROTATED 1 /* of 500; measured 0 */
#define LIMITS_SWAPPED 0 /* signs alone */
#else
#define LIMITS_ROTATED 5 /* joints rounded to 2^-16 */
#define LIMITS_SWAPPED 1 /* products are rounded upwards */
#endif
#define LIMITS_FIXED 4 /* of 4000 */

/* ---- Lift ---- */
#define LIFT_TOLERANCE 0.003F /* the tilt above: the person of helpers.c has 2 % in depth */
#define LIFT_SHAPE_TOLERANCE MDS_TOLERANCE
#define LIFT_SCALED_TOLERANCE 1e-3F /* input rounded anew: a smooth network makes little of it */
#ifndef EDML_TEST_Q24
#define LIFT_ROUNDING ROUNDING
#define LIFT_STAGES_TOLERANCE 0.0F
#define LIFT_REFLECTED_TOLERANCE 0.0F
#define LIFT_MIRRORED_TOLERANCE 3e-5F /* rounding through the network; measured 1.4e-5 */
#define LIFT_ROLLED_TOLERANCE 5e-5F
#define LIFT_POINTS_TOLERANCE 1e-5F
#define LIFT_POWERS_BEYOND 2
#define LIFT_UP_POWERS {-100, -20, -1, 1, 12, 100}
#define LIFT_BAD_UP {NAN, INFINITY, -INFINITY}
#else /* joints and misfit are rounded to 2^-16 */
#define LIFT_ROUNDING 5e-5F
#define LIFT_STAGES_TOLERANCE 2e-5F
#define LIFT_REFLECTED_TOLERANCE 1e-4F
#define LIFT_MIRRORED_TOLERANCE 1e-3F /* the network's input is rounded to 2^-12 */
#define LIFT_ROLLED_TOLERANCE 2e-3F   /* measured 1.04 mm */
#define LIFT_POINTS_TOLERANCE 1e-4F
#define LIFT_POWERS_BEYOND 0
#define LIFT_UP_POWERS {-6, -1, 1, 12}
#define LIFT_BAD_UP {8192, -8192, INFINITY, -INFINITY}
#endif
#define LIFT_MISFIT_TOLERANCE 2e-3F /* a root of rounding */

/* ---- Fixed point beside float, the same network ---- */
/* The network's input is rounded to 2^-12, now and then to the other side: a few 2^-12 at its
 * output. */
#define FIXED_LIFT_TOLERANCE 0.003F /* of hard people; measured 1.2 mm */

/* ---- Against NumPy in double, printed with seven digits ---- */
#define VECTOR_FRAME_TOLERANCE 5e-6F /* keypoints to 2^-16 at worst */
#ifndef EDML_TEST_Q24
#define VECTOR_NET_TOLERANCE 1e-5F   /* sums of up to 176 terms of about 1; measured 1e-6 */
#define VECTOR_SHARE_TOLERANCE 2e-5F /* steep in the gate: by up to 4; measured 1.3e-6 */
#else
#define VECTOR_NET_TOLERANCE 3e-3F   /* 16-bit network on hard input; measured 1.1 mm */
#define VECTOR_SHARE_TOLERANCE 0.03F /* measured 0.014 */
#endif
#define VECTOR_EIGEN_TOLERANCE 2e-6F /* relative to the largest; measured 4e-7 */
#define VECTOR_MDS_TOLERANCE MDS_TOLERANCE
/* Ten steps downhill enlarge rounding, the more the less smooth the objective; measured 5e-6, 1e-6
 * and 3e-5. */
#ifndef EDML_TEST_Q24
#define VECTOR_SQUARE_TOLERANCE 5e-5F
#define VECTOR_RAW_TOLERANCE 2e-5F
#else /* starts from the points of another MDS, 3e-6 away; measured 5.2e-5, 1.9e-5 and 1e-4 */
#define VECTOR_SQUARE_TOLERANCE 1e-4F
#define VECTOR_RAW_TOLERANCE 5e-5F
#endif
#define VECTOR_EQ2_TOLERANCE 1e-3F
#ifndef EDML_TEST_Q24
#define VECTOR_POSE_TOLERANCE 1e-4F /* all of the above, and the division by a thin spread */
#else
#define VECTOR_POSE_TOLERANCE 3e-3F /* measured 1.4 mm */
#endif

#endif
