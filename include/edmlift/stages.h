/* The stages of the lift, in the order of the data (docs/how-it-works.md).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDMLIFT_STAGES_H
#define EDMLIFT_STAGES_H

#include "../edmlift.h"
#include "fixed.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Index into the 91 values of an EDM: row by row above the diagonal, 0 <= i < j < 14. */
#define EDML_PAIR(i, j) ((i) * (2 * EDML_JOINTS - 3 - (i)) / 2 + (j) - 1)

/* The conditional mean of each joint in the image, given all the others: their mean, weighted by the joint's
 * row.  A row adds up to EDML_IMPUTATION_ONE; its absolute values may add up to 3.4 times that.  The weights
 * must come from a covariance, as those of tools/fitting/imputation.py do.  The default is that of the shipped
 * networks' training people. */
enum { EDML_IMPUTATION_ONE = 4096 };
typedef struct {
    int16_t weight[EDML_JOINTS][EDML_JOINTS]; /* a joint's own is 0 */
} edml_imputation;
extern const edml_imputation edml_default_imputation;

/* The joints in the body's frame: the image is turned so that the body's axis, from the middle of head, neck
 * and shoulders to that of the hips, points down, and scaled so that half the extent of the seen joints along
 * it is 1 (section 3.1, which takes the image's vertical).  A person of whom more is seen across the axis than
 * along it is scaled until no seen joint is more than 3.5 from their mean.
 *   image          at: u across, from the mean; v along, from the middle.  Missing joints are imputed
 *                  down: the body's axis in the image, a unit vector
 *   fewest_joints  >= 1, that must be seen; else EDML_ERR_TOO_FEW_JOINTS
 *   imputation     where missing joints are, at most 9.  NULL: they are at 0, and the image is not turned
 * Also returns EDML_ERR_NOT_FINITE and EDML_ERR_DEGENERATE, the latter also for a singular imputation. */
edml_status edml_body_frame(edml_image *image, const edml_keypoint in[EDML_JOINTS], int fewest_joints,
                            const edml_imputation *imputation);

/* Distances between the joints in the body's frame (eq. 1), [91], up to 11.1. */
void edml_edm(float edm[EDML_PAIRS], const edml_image *image);

/* What the model's network says (section 3.2), in the body's frame, metres.
 *   out    distance: >= 0; x: points about their mean; as far as the model gives them
 *          share: how far to believe each joint's image, 0 to 1
 *   up     a unit vector in the camera's axes, or NULL
 *   EDML_ERR_MODEL, EDML_ERR_WORK_TOO_SMALL  as edml_lift() */
edml_status edml_predict(edml_prediction *out, const edml_image *image, const edml_point *up,
                         const edml_model *model, void *work, size_t work_bytes);

typedef struct {
    float at[EDML_JOINTS][EDML_JOINTS];
} edml_matrix;

/* Eigenvalues and eigenvectors of a symmetric matrix. */
typedef struct {
    float value[EDML_JOINTS];               /* descending */
    float vector[EDML_JOINTS][EDML_JOINTS]; /* row k belongs to value[k]: unit length, its largest component
                                               positive */
    edml_matrix diagonal;                   /* work memory */
} edml_eigen;

/* All eigenpairs by cyclic Jacobi, to rounding.  Only the upper triangle of `a` is read.  No |entry| may be above
 * 2^56; below 2^-74 entries beside the diagonal count as zero. */
void edml_jacobi(edml_eigen *eigen, const edml_matrix *a);

/* Classical multidimensional scaling: the points whose Gram matrix is nearest to that of the distances
 * (section 3.3).  It computes the three largest eigenpairs by way of a tridiagonal matrix: of 99.9 % of a
 * network's outputs the points are within 0.01 mm of those of exact eigenpairs; where the third and the fourth
 * eigenvalue nearly coincide, they may be some tenths off (tools/evaluate.py eigenpairs).
 *   x         [14] metres, centroid at the origin, principal axes, either mirror image
 *   distance  [91] metres, at most 4 */
void edml_mds(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS], edml_work *work);

/* What the refinement minimises; d are the points' distances, D the network's. */
typedef enum {
    EDML_STRESS_NONE,   /* nothing: keep classical MDS */
    EDML_STRESS_SQUARE, /* sum (d^2 - D^2)^2, s-stress */
    EDML_STRESS_RAW,    /* sum (d - D)^2 */
    EDML_STRESS_EQ2     /* sum |d^2 - D^2|, eq. 2, by reweighting */
} edml_objective;

/* Moves the points downhill, at most `steps` steps of conjugate gradient.  The objective never rises.
 * Returns the number of steps taken. */
int edml_refine(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS], edml_objective objective,
                int steps, edml_work *work);

/* The objective as a mean over the 91 pairs, m^4, m^2 or m^2; 0 for EDML_STRESS_NONE. */
float edml_stress(const edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS],
                  edml_objective objective);

/* Rotates the points to the axes of the body's frame: the rotation whose scaled-orthographic image fits the
 * seen joints best.  Their mean becomes the origin.
 *   EDML_ERR_DEGENERATE  no rotation is better than others: points or image are on a line, or do not
 *                        correlate */
edml_status edml_orient(edml_point x[EDML_JOINTS], const edml_image *image);

/* Reflects the points of edml_orient() in depth if their mirror image is more human (section 3.3): a linear
 * score of how far limbs and head point forward of the torso.  Returns the margin. */
float edml_mirror(edml_point x[EDML_JOINTS], const edml_model *model);

/* Rotates the points of the MDS onto those that the network gives as well, reflects them if that brings them
 * nearer, and takes the model's weighted mean of the two. */
void edml_align(edml_point x[EDML_JOINTS], const edml_point onto[EDML_JOINTS], const edml_model *model);

/* Moves the seen joints toward where the image has them, each by its share, and less if points and image
 * disagree more.  Returns by how much they do: the RMS difference, metres. */
float edml_fuse(edml_point x[EDML_JOINTS], const edml_image *image, const float share[EDML_JOINTS],
                const edml_model *model);

/* ---- In fixed point: Q24 ------------------------------------------------------------------------ */

/* Ranges are narrower, and not checked: distances 0 to 3 m; matrices of a Frobenius norm up to 90, whose
 * eigenpairs are accurate to about 2^-20, absolutely; points of edml_mds_q().
 * edml_refine_q() takes any points within 63 m on each axis, but leaves them alone where two are 8 m or more
 * apart, or the squares of all distances between them add up to 448 m^2 or more.  A stress above 64, or of such
 * points, is returned as 64.  So what it moves is no wider, about its mean, than edml_orient_q() can take. */
typedef struct {
    int32_t at[EDML_JOINTS][EDML_JOINTS];
} edml_matrix_q;

typedef struct {
    int32_t value[EDML_JOINTS], vector[EDML_JOINTS][EDML_JOINTS];
    edml_matrix_q diagonal;
} edml_eigen_q;

edml_status edml_body_frame_q(edml_image_q *image, const edml_keypoint_q in[EDML_JOINTS],
                              int fewest_joints, const edml_imputation *imputation);
void edml_edm_q(int32_t edm[EDML_PAIRS], const edml_image_q *image);
edml_status edml_predict_q(edml_prediction_q *out, const edml_image_q *image, const edml_point_q24 *up,
                           const edml_model *model, void *work, size_t work_bytes);
void edml_jacobi_q(edml_eigen_q *eigen, const edml_matrix_q *a);
void edml_mds_q(edml_point_q24 x[EDML_JOINTS], const int32_t distance[EDML_PAIRS], edml_work_q *work);
int edml_refine_q(edml_point_q24 x[EDML_JOINTS], const int32_t distance[EDML_PAIRS],
                  edml_objective objective, int steps, edml_work_q *work);
int32_t edml_stress_q(const edml_point_q24 x[EDML_JOINTS], const int32_t distance[EDML_PAIRS],
                      edml_objective objective);
edml_status edml_orient_q(edml_point_q24 x[EDML_JOINTS], const edml_image_q *image);
int32_t edml_mirror_q(edml_point_q24 x[EDML_JOINTS], const edml_model *model);
void edml_align_q(edml_point_q24 x[EDML_JOINTS], const edml_point_q24 onto[EDML_JOINTS],
                  const edml_model *model);
int32_t edml_fuse_q(edml_point_q24 x[EDML_JOINTS], const edml_image_q *image,
                    const int32_t share[EDML_JOINTS], const edml_model *model);

#ifdef __cplusplus
}
#endif

#endif
