/* edmlift: 14 detected 2D joints in, a 3D pose in metres out.
 *
 * F. Moreno-Noguer, "3D Human Pose Estimation from a Single Image via Distance Matrix Regression",
 * CVPR 2017, as a library for microcontrollers: no heap, no globals, no dependency but sqrtf(), memcpy()
 * and memset().  C99, C++11.  "Section" and "eq." in these headers refer to that paper.
 *
 * This header is all that most programs need.  edmlift/fixed.h is the same in integers, for cores without
 * an FPU; camera.h, video.h and body.h are optional parts; stages.h has the stages of the lift.
 *
 * Conventions.  Outputs come first, work memory last.  Input and output may not overlap.  Calls are
 * re-entrant.  Images: square pixels, x right, y down.  Poses: metres, the camera's axes (x right, y down,
 * z away from the camera), origin midway between the hips.  Left and right are the subject's.
 *
 * Errors.  A function that can fail returns a status; any status but EDML_OK leaves its outputs untouched.
 * It answers a null pointer with EDML_ERR_ARGUMENT.  No other function may be given one.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDMLIFT_H
#define EDMLIFT_H

#ifdef __AVR__
#error "edmlift needs a 32-bit board, such as Uno R4, Nano 33 BLE, ESP32, Pico or Teensy: on an AVR its weights, 44 KB at least, would lie in RAM, and int has 16 bits"
#endif

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define EDML_VERSION 0x010000 /* major << 16 | minor << 8 | patch */
#define EDML_VERSION_STRING "1.0.0"

/* ---- Joints ------------------------------------------------------------------------------------- */

/* The order of CPM and of OpenPose's MPI model.  Head and neck base are where CMU's skeletons have them,
 * and no detector does: the head is the end of the head bone, about as high as the ears; the neck base is
 * the end of the thorax, 12 % of the way from mid-shoulder to mid-hip.  edml_adapt() puts them there.
 * docs/detectors.md has a picture. */
enum edml_joint {
    EDML_HEAD,
    EDML_NECK_BASE,
    EDML_R_SHOULDER,
    EDML_R_ELBOW,
    EDML_R_WRIST,
    EDML_L_SHOULDER,
    EDML_L_ELBOW,
    EDML_L_WRIST,
    EDML_R_HIP,
    EDML_R_KNEE,
    EDML_R_ANKLE,
    EDML_L_HIP,
    EDML_L_KNEE,
    EDML_L_ANKLE,
    EDML_JOINTS
};
enum { EDML_PAIRS = 91, EDML_BONES = 13 }; /* pairs: above the diagonal of a 14x14 matrix */

typedef struct {
    uint8_t from, to; /* enum edml_joint; `from` is nearer to the neck base */
} edml_bone;

extern const edml_bone edml_bones[EDML_BONES]; /* in the order of the joints that they lead to */
extern const uint8_t edml_mirror_joint[EDML_JOINTS]; /* left for right and right for left */
const char *edml_joint_name(int joint); /* "right_shoulder"; "?" when out of range */

/* ---- Keypoints and poses ------------------------------------------------------------------------ */

typedef struct {
    float x, y; /* pixels, y down; any scale and offset, while the person spans at least 4096 ulp of the
                   largest coordinate */
    float c;    /* confidence; c <= 0: the joint was not seen, and x and y are ignored, NaN as well.  A joint
                   counts as seen however small c is, and 0, 0 is a place like any other.  So set c to 0 below
                   the detector's threshold, where x or y is NaN, outside the image, and at exactly 0, 0 or
                   -1, -1, by which detectors mark what they did not find */
} edml_keypoint;

typedef struct {
    float x, y, z;
} edml_point;

typedef struct {
    edml_point joint[EDML_JOINTS]; /* metres; all 14, also those that were not seen */
    float misfit;  /* metres: RMS difference between the image and the network's points, before edml_fuse() */
    uint16_t seen; /* bit j: joint j was seen */
} edml_pose;

#define EDML_STATUSES(X)                                                                                \
    X(EDML_OK, 0, "ok")                                                                                 \
    X(EDML_ERR_ARGUMENT, -1, "argument")     /* a null or misaligned pointer, or a bad setting */       \
    X(EDML_ERR_NOT_FINITE, -2, "not_finite") /* NaN, infinity, or a number out of range */              \
    X(EDML_ERR_TOO_FEW_JOINTS, -3, "too_few_joints") /* fewer seen than the model was trained for */    \
    X(EDML_ERR_DEGENERATE, -4, "degenerate") /* on a point or a line, of no height, or no pose fits */  \
    X(EDML_ERR_WORK_TOO_SMALL, -5, "work_too_small") /* fewer bytes than edml_model_work_bytes() */     \
    X(EDML_ERR_MODEL, -6, "model")           /* checksum mismatch, or this lift cannot run it */        \
    X(EDML_ERR_CAMERA, -7, "camera")         /* not a camera, or it cannot have seen this */            \
    X(EDML_ERR_TIME, -8, "time")             /* not later than the last frame, or by over 24 days */    \
    X(EDML_ERR_BODY, -9, "body")             /* impossible, or contradictory, body measurements */

#define EDML_STATUS_ENUM(name, value, text) name = (value),
typedef enum { EDML_STATUSES(EDML_STATUS_ENUM) } edml_status;
#undef EDML_STATUS_ENUM

const char *edml_status_name(edml_status status); /* "too_few_joints"; "?" when unknown */

/* ---- Models ------------------------------------------------------------------------------------- */

/* A trained network and its measured settings, constant in flash.  A program links the models it names. */
typedef struct edml_model edml_model;

/* From the joints' coordinates to points, in float32 and with weights of 16 and of 8 bits.  With 16 bits a
 * lift is as fast as with float where there is an FPU, in half the flash, and much faster where there is none;
 * 8 bits halve the flash again. */
extern const edml_model edml_direct_f32, edml_direct_w16, edml_direct_w8;

/* The paper's way beside it: distances are read and given as well, and scaled to points. */
extern const edml_model edml_distances_f32, edml_distances_w16, edml_distances_w8;

/* The paper's networks (section 3.2), better trained: FConn, fully connected, and FConv, convolutional, with
 * 15 times the weights.  They read and give distances, and nothing else.  docs/accuracy.md compares. */
extern const edml_model edml_fconn_f32, edml_fconn_w16, edml_fconn_w8;
extern const edml_model edml_fconv_f32, edml_fconv_w8;

const char *edml_model_name(const edml_model *model);  /* "direct_w16" */
edml_status edml_model_check(const edml_model *model); /* EDML_ERR_MODEL: checksum mismatch */
size_t edml_model_work_bytes(const edml_model *model); /* for edml_lift(); 0: not for that lift */

/* ---- Lift --------------------------------------------------------------------------------------- */

#include "edmlift/work.h" /* edml_work, 1.9 KB; edml_fconv_work, for FConv, 19 KB */

/* Lifts one person.
 *   in          14 keypoints
 *   up          the upward direction in the camera's axes, of any length, as an accelerometer shows it; NULL
 *               if it is not known.  fconn and fconv make no use of it
 *   work        aligned to 4 bytes: an edml_work or larger
 *   work_bytes  sizeof it
 * Besides EDML_ERR_ARGUMENT:
 *   EDML_ERR_NOT_FINITE      NaN or infinity in the x or y of a seen joint, in any c, or in up
 *   EDML_ERR_TOO_FEW_JOINTS  fewer than 10 seen, with the models above
 *   EDML_ERR_DEGENERATE      points equal, on a line, or so unlike a person that no rotation fits; up is zero
 *   EDML_ERR_MODEL, EDML_ERR_WORK_TOO_SMALL
 * Run time varies with the missing joints, the non-zero activations and the Jacobi rotations; all three are
 * bounded.  At most 0.6 KB of stack: docs/stack.md. */
edml_status edml_lift(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_point *up,
                      const edml_model *model, void *work, size_t work_bytes);

/* ---- Detectors' keypoints ----------------------------------------------------------------------- */

/* What x and y are as the detector gives them, and how they become the pixels that edml_adapt() takes. */
enum {
    EDML_NOT_NORMALISED, /* pixels */
    EDML_BY_IMAGE,       /* x over the image's width, y over its height: multiply each by its own */
    EDML_BY_SQUARE       /* y comes before x, both over the longer side S of the image, which was padded to a
                            square about its middle: x S - (S - width) / 2, y S - (S - height) / 2 */
};

/* Which of a detector's keypoints are the joints above, by index; EDML_NO_KEYPOINT: none of them. */
typedef struct {
    const char *name;              /* "coco17" */
    uint8_t keypoints;             /* how many there are */
    uint8_t normalised;            /* EDML_NOT_NORMALISED, EDML_BY_IMAGE or EDML_BY_SQUARE */
    uint8_t limb[EDML_JOINTS - 2]; /* the joints from EDML_R_SHOULDER on */
    uint8_t ears[2];               /* left, right */
    uint8_t face[3];               /* left eye, right eye, nose */
    uint8_t crown, centre;         /* top of the skull; middle of the head */
} edml_format;

enum { EDML_NO_KEYPOINT = 255 };

extern const edml_format edml_coco17, edml_movenet17; /* YOLO-pose, PoseNet, ViTPose, RTMPose body; MoveNet */
extern const edml_format edml_body25, edml_body25b, edml_coco18, edml_mpi15; /* OpenPose */
extern const edml_format edml_halpe26, edml_blazepose33;                     /* RTMPose body26; MediaPipe */
extern const edml_format edml_cpm14, edml_mpii16, edml_lsp14, edml_crowdpose14, edml_aic14;
extern const edml_format edml_h36m17_right_first, edml_h36m17_left_first; /* Human3.6M: which leg first */
extern const edml_format *const edml_formats[]; /* all of these, then NULL */
const edml_format *edml_format_find(const char *name); /* NULL: unknown */

/* Converts keypoints to joints.  Limbs are copied.  Head and neck base are computed from the shoulders, the
 * hips and what is seen of the head.  Their confidence is half the lowest of their inputs; it is 0 if a
 * shoulder is missing, and for the head also if the whole head is.  NaN passes through, so that edml_lift()
 * refuses it.
 *   in  [format->keypoints] */
void edml_adapt(edml_keypoint out[EDML_JOINTS], const edml_keypoint in[], const edml_format *format);

#ifdef __cplusplus
}
#endif

#endif
