/* edmlift: 14 detected 2D joints in, a 3D pose in metres out.
 *
 * F. Moreno-Noguer, "3D Human Pose Estimation from a Single Image via Distance Matrix
 * Regression", CVPR 2017, as a library for microcontrollers: no heap, no globals, no dependency
 * but sqrtf(), memcpy() and memset().  C99, C++11.  "Section" and "eq." below refer to that paper.
 *
 * Conventions.  Outputs come first, work memory last.  Input and output may not overlap.  Calls
 * are re-entrant.  Images: pixels, x right, y down.  Poses: metres, the camera's axes (x right,
 * y down, z away from the camera), origin midway between the hips.  Left and right are the
 * subject's.  A function that can fail returns a status and then leaves its outputs untouched; a
 * null pointer is EDML_ERR_ARGUMENT to it, and not allowed in others.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDMLIFT_H
#define EDMLIFT_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define EDML_VERSION 0x00010000 /* major << 16 | minor */
#define EDML_VERSION_STRING "1.0"

/* ---- Joints ------------------------------------------------------------------------------ */

/* The order of CPM and of OpenPose's MPI model, but not their head and neck: the models have these
 * where CMU's skeletons do.  Head top is the end of the head bone, about as high as the ears; neck
 * the end of the thorax, 12 % of the way from between the shoulders to between the hips.  What a
 * detector reports goes through edml_adapt(), below. */
enum edml_joint {
    EDML_HEAD_TOP,
    EDML_NECK,
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
#define EDML_PAIRS 91 /* pairs of joints: the values above the diagonal of a 14x14 matrix */
#define EDML_BONES 13

typedef struct {
    uint8_t from, to; /* enum edml_joint; `from` is nearer to the neck */
} edml_bone;

/* In the order of the joints that they lead to: neck to head top; to right shoulder, elbow, wrist; to left
 * ones; neck to right hip, knee, ankle; to left ones. */
extern const edml_bone edml_bones[EDML_BONES];
extern const uint8_t edml_mirror_joint[EDML_JOINTS]; /* left for right and right for left */
const char *edml_joint_name(int joint); /* "right_shoulder"; "?" when out of range */

/* ---- Lift -------------------------------------------------------------------------------- */

typedef struct {
    float x, y; /* pixels, y down */
    float c;    /* confidence; a joint with c <= 0 was not seen, its x and y are ignored */
} edml_keypoint;

typedef struct {
    float x, y, z;
} edml_point;

typedef struct {
    edml_point joint[EDML_JOINTS]; /* metres, camera axes, origin at mid-hip; all 14, also those
                                      that were not seen */
    float mirror_margin; /* >= 0: log-odds, as fitted on training views, that this pose and not its
                            mirror image is the right one; a guide, not a calibrated probability */
    float residual;      /* metres: RMS difference between the network's distances and those of its points
                            in space, before the image moves them */
    uint16_t seen;       /* bit j: joint j was seen */
} edml_pose;

/* Status of a lift: what it means is what edml_status_name() says. */
#define EDML_STATUSES(X)                                                                          \
    X(EDML_OK, 0, "ok")                                                                           \
    X(EDML_ERR_ARGUMENT, -1, "argument")             /* a null pointer */                         \
    X(EDML_ERR_NOT_FINITE, -2, "not_finite")         /* NaN or infinity in a joint, or in any c */ \
    X(EDML_ERR_TOO_FEW_JOINTS, -3, "too_few_joints") /* fewer seen than the model was trained for */ \
    X(EDML_ERR_DEGENERATE, -4, "degenerate")         /* on a point or line, of no height, or so unlike \
                                                        a person that no pose looks like it */     \
    X(EDML_ERR_UNUSUAL, -5, "unusual")               /* wider for its height than the model takes */ \
    X(EDML_ERR_MODEL, -6, "model")                   /* the model's data do not match its checksum, or are floats \
                                                        where whole numbers are wanted, or it is another \
                                                        lift's */                             \
    X(EDML_ERR_CAMERA, -7, "camera")                 /* not a camera, or one that cannot have seen that */ \
    X(EDML_ERR_TIME, -8, "time")                     /* a frame that is not later than the last one, or by \
                                                        over 24 days */                            \
    X(EDML_ERR_PERSON, -9, "person")                 /* no one's height and bones, or not one person's */

#define EDML_STATUS_ENUM(name, value, text) name = value,
typedef enum { EDML_STATUSES(EDML_STATUS_ENUM) } edml_status;
#undef EDML_STATUS_ENUM

const char *edml_status_name(edml_status status); /* "too_few_joints"; "?" when unknown */

/* A trained network and the settings that were measured with it; constant data in flash. */
typedef struct edml_model edml_model;

/* FConn, 91-192-192-91 with left and right alike, which takes 36,817 weights: in float32, and quantised,
 * all in whole numbers, with weights of up to 16 and of 8 bits.  That of 16 is as fast as float even where
 * there is an FPU, in half the flash, and much faster without; that of 8 halves the flash again. */
extern const edml_model edml_fconn_f32, edml_fconn_q15, edml_fconn_q7;

const char *edml_model_name(const edml_model *model);
/* Compares the model's data with its checksum: EDML_OK or EDML_ERR_MODEL. */
edml_status edml_model_check(const edml_model *model);

/* Memory of one lift; its contents mean nothing between calls. */
typedef struct edml_work edml_work;

/* Lifts one person.
 *   in     14 keypoints.  Coordinates may be of any size, and of any offset that leaves the person
 *          some thousand steps of float's rounding; only the shape counts.
 *   model  &edml_fconn_f32, or a quantised one
 * Time depends on the input by the numbers of joints that are missing, of inputs of the network's layers
 * that are not zero, and of Jacobi rotations, all of which are bounded. */
edml_status edml_lift(edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                      const edml_model *model, edml_work *work);

/* The paper's other network, convolutional, 605,825 weights: 2.4 MB in float32, 0.6 MB in whole numbers
 * of 8 bits, and some 160 times the instructions.  docs/fconv.md has when it is worth it. */
extern const edml_model edml_fconv_f32, edml_fconv_q7;

typedef struct edml_fconv_work edml_fconv_work; /* 22 KB */

/* edml_lift() with such a model, which edml_lift() refuses, as this does the others: EDML_ERR_MODEL. */
edml_status edml_lift_fconv(edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                            const edml_model *model, edml_fconv_work *work);

/* ---- Other joints -------------------------------------------------------------------------- */

/* What a detector reports: which of its keypoints are the joints above.  A format is constant data;
 * a program links those that it names, and can have its own by filling in this structure. */
typedef struct {
    const char *name;              /* "coco17" */
    uint8_t keypoints;             /* how many there are */
    uint8_t shares;                /* 1: x and y are shares of the image's width and height; multiply
                                      them by those first */
    /* Indices of keypoints; EDML_NO_KEYPOINT where there is none. */
    uint8_t limb[EDML_JOINTS - 2]; /* the joints from EDML_R_SHOULDER on */
    uint8_t ears[2];               /* left, right */
    uint8_t face[3];               /* left eye, right eye, nose */
    uint8_t crown, centre;         /* top of the skull; middle of the head */
} edml_format;

#define EDML_NO_KEYPOINT 255

extern const edml_format edml_coco17; /* YOLO-pose, PoseNet, ViTPose, RTMPose body; MoveNet, whose y comes
                                         before x, in shares of its square input */
extern const edml_format edml_body25, edml_body25b, edml_coco18, edml_mpi15; /* OpenPose */
extern const edml_format edml_cpm14, edml_mpii16, edml_lsp14, edml_crowdpose14, edml_aic14;
extern const edml_format edml_halpe26;     /* RTMPose body26 */
extern const edml_format edml_blazepose33; /* MediaPipe */
/* Human3.6M's order has two forms: right leg first (mmpose, MotionBERT), left leg first (SPIN). */
extern const edml_format edml_h36m17_right_first, edml_h36m17_left_first;

/* All of the above, and the one of a name, or NULL. */
enum { EDML_FORMATS = 14 };
extern const edml_format *const edml_formats[EDML_FORMATS];
const edml_format *edml_format_find(const char *name);

/* Keypoints to joints: limbs are copied; head and neck are put where the models have them, from the
 * shoulders, the hips and what is seen of the head, with half the least confidence of these, or 0
 * where a shoulder or (the head alone) all of the head was not seen.  What is not finite stays so.
 *   in  [format->keypoints] as for edml_lift(); c <= 0 for those that were not seen
 * docs/adapters.md says how well this does. */
void edml_adapt(edml_keypoint out[EDML_JOINTS], const edml_keypoint in[],
                const edml_format *format);

/* ---- The camera's frame ------------------------------------------------------------------- */

/* A pinhole camera, pixels.  A lens with distortion: undistort the keypoints first. */
typedef struct {
    float fx, fy, cx, cy; /* focal lengths, > 0, and principal point */
} edml_camera;

typedef struct {
    edml_point joint[EDML_JOINTS]; /* metres, camera axes, origin at the camera's centre */
    edml_point rotation[3];        /* rows; joint = rotation * pose.joint + translation ... */
    edml_point translation;        /* ... in metres: where the pose's origin, mid-hip, is */
    float reprojection; /* pixels: RMS distance of the seen joints from where they should be seen,
                           weighted by confidence */
    uint16_t steps;     /* of the iterations, at most 53 */
} edml_placement;

/* Places a pose before the camera, so that its joints are seen where they were.  Orthogonal
 * iteration (Lu, Hager, Mjolsness, "Fast and globally convergent pose estimation from video images",
 * 2000) from two starts, sped up by Newton's steps, and a few more on the error in the image.
 *   pose    as from edml_lift(), or any 14 points within 4 m of their origin, however turned
 *   in      the keypoints that it was lifted from; each counts by its confidence, and not at all
 *           below a thousandth of all confidence
 *   work    may be that of the lift
 * What the size of the person is off by, the distance is off by, too: one image shows no more.  Takes
 * up to 1.7 kB of stack.  Of points all in a plane, 1 pose in some 7,000 is turned the wrong one of two ways.
 * Besides EDML_ERR_ARGUMENT and EDML_ERR_NOT_FINITE (also of a joint beyond 4 m):
 *   EDML_ERR_TOO_FEW_JOINTS  fewer than 7 joints seen
 *   EDML_ERR_DEGENERATE      joints or image on a line, or under 1/64 m or 0.11 degrees (RMS)
 *   EDML_ERR_CAMERA          not a camera; a joint seen more than 63 degrees off its axis or 60 off
 *                            the person; a joint behind it, or much nearer than the person; a person
 *                            beyond 100 m; a joint that is off by more than the person's size */
edml_status edml_place(edml_placement *placement, const edml_pose *pose,
                       const edml_keypoint in[EDML_JOINTS], const edml_camera *camera,
                       edml_work *work);

/* The same by a camera of unknown focal length, its principal point in the middle of the image: of
 * 12 from 0.5 to 4 times the image's height, the one of least reprojection error (section 4 of the
 * paper).  People some metres away look nearly the same through all of them: distance and focal
 * length are found together, badly, and only their ratio well.  Calibrate where distance matters.
 *   camera         the one that was chosen
 *   width, height  of the image, pixels, > 0; else EDML_ERR_CAMERA */
edml_status edml_place_sweep(edml_placement *placement, edml_camera *camera, const edml_pose *pose,
                             const edml_keypoint in[EDML_JOINTS], float width, float height,
                             edml_work *work);

/* ---- Video --------------------------------------------------------------------------------- */

/* How the one-euro filter (Casiez, Roussel, Vogel, "1 euro filter", CHI 2012) trades noise for lag:
 * a joint is low-passed at `cutoff` + `slope` * its speed.  HUGE_VALF as cutoff: not at all. */
typedef struct {
    float cutoff; /* Hz, > 0; lower is steadier */
    float slope;  /* Hz per unit of speed, >= 0 and finite; higher lags less in motion */
} edml_smoothing;

typedef struct {
    edml_point at, rate; /* rate: a second */
} edml_moving;

typedef struct {
    edml_moving image, space;
    float off_x, off_y; /* last seen, from where it was expected, in sizes of the body */
    uint16_t age;       /* ms since */
} edml_tracked_joint;

enum { EDML_EXCHANGED_ARMS = 1, EDML_EXCHANGED_LEGS = 2 };

/* One person in a video: the caller's, one for each. */
typedef struct {
    /* Settings; edml_track_start() gives those that were measured, change them after it. */
    edml_smoothing smooth_image; /* of keypoints; unit of speed: the body's size a second, which is the
                                    seen joints' mean |x| + |y| from their middle */
    edml_smoothing smooth_space; /* of poses; m/s */
    float noise; /* of keypoints, in sizes of the body, from which on all of that is wanted; of steadier
                    ones less is.  0: all, always */
    /* Report on the last frame that was lifted. */
    float unsteady;    /* what `noise` is compared with: how much keypoints jump, motion aside, about
                          where the past lets expect them; over the last 0.2 s or so */
    uint32_t elapsed;  /* ms since the one before; 0: there is none, or too long ago */
    uint16_t held;     /* bit j: joint j was not seen, but lately */
    uint8_t exchanged; /* EDML_EXCHANGED_ARMS, _LEGS: right and left were, by the detector */
    uint8_t mirrored;  /* 1: not the mirror image that this frame alone would give */
    /* State. */
    uint8_t started;
    uint32_t time; /* ms */
    float arms, legs, mirror;
    edml_tracked_joint joint[EDML_JOINTS];
} edml_track;

void edml_track_start(edml_track *track);

/* edml_lift() of a frame of a video, made steady by the frames before; none is delayed.
 *   pose     smoothed; `seen` in this frame; `mirror_margin` is that of all frames so far, at most 6
 *   time_ms  of the frame, by any clock of milliseconds; it may run over its end
 * The detector's exchanges of right and left arms (with shoulders) and legs (with hips) are undone;
 * one that lasts for about 0.4 s is believed.  So is a mirror image that persists.  Joints that are
 * missing stay where they were, moved along with the others, for 300 ms.  Frames may be dropped; after
 * a second without one lifted, the next starts anew.  Besides edml_lift()'s:
 *   EDML_ERR_ARGUMENT        also: a track that was not started, or settings out of range
 *   EDML_ERR_TIME            not later than the last frame: one that was overtaken, or a clock that was
 *                            set back, or one that ran for over 24 days since; then edml_track_start()
 *   EDML_ERR_TOO_FEW_JOINTS  also: fewer than 7 seen, however many are held
 * With a status other than EDML_OK the track, too, is untouched.  About 1.2 KB of stack more. */
edml_status edml_track_lift(edml_pose *pose, edml_track *track,
                            const edml_keypoint in[EDML_JOINTS], uint32_t time_ms,
                            const edml_model *model, edml_work *work);

/* Exchanges right and left keypoints, in place, where edml_track_lift() took them for exchanged in the
 * last frame: what edml_place() is to be given with its pose.
 *   in  that frame's */
void edml_track_sort(edml_keypoint in[EDML_JOINTS], const edml_track *track);

/* ---- What is known of the person ----------------------------------------------------------- */

typedef struct {
    float height;           /* metres, standing, barefoot, 0.5 to 2.5; 0: unknown */
    float bone[EDML_BONES]; /* metres, in the order of edml_bones; 0: unknown */
} edml_person;

/* Gives a lifted pose its owner's size, in place.  Known bones get their length and keep their
 * direction.  The others are scaled by one factor, that which gives the way from head top to ankle its
 * share of the height; without a height they keep theirs.  Mid-hip stays the origin; mirror_margin and
 * residual stay those of the lift.  Quality comes before, placement after.  docs/person.md has what it
 * gives.
 *   EDML_ERR_PERSON      measures that no one has, or not one person: negative, NaN, beyond the range,
 *                        or bones that stand for heights that differ by more than a factor of 1.6
 *   EDML_ERR_NOT_FINITE  a joint of the pose is not within 4 m
 *   EDML_ERR_DEGENERATE  the pose would be more than twice as large, or an eighth, or has a bone of no
 *                        length where one is known */
edml_status edml_fit_person(edml_pose *pose, const edml_person *person);

/* The chance, 0 to 1, that a pose has a mean joint error under 100 mm (rigid alignment, no scale), as
 * far as can be told from its mirror margin, its residual, the image of `in` from which it was lifted,
 * its bones and the number of joints seen.  0 of what no lift returns.  Of single lifts: what
 * edml_track_lift() smooths is not in its image any more.  docs/person.md has how true it is. */
float edml_quality(const edml_pose *pose, const edml_keypoint in[EDML_JOINTS]);

/* Mean error in millimetres of each joint after rigid alignment, given which joints were seen: of
 * training people, with a detector's noise.  Learned with the shipped networks; for either pipeline.
 *   seen  as in the pose; fewer than 10 are EDML_ERR_TOO_FEW_JOINTS, as in the lift */
edml_status edml_uncertainty(uint8_t millimetres[EDML_JOINTS], uint16_t seen);

/* How many of the nine bones head, upper arms, forearms, thighs and shins point where no training
 * person's did, seen from the torso or the bone before (the paper's rule of section 3.3, with an own
 * table, 4 KB); 9 where a joint is not within 4 m.  Nearly always 0 of true poses, and 3 or more of their
 * mirror images.  A bone or torso without direction counts.  docs/accuracy.md has what it tells. */
int edml_limits(const edml_pose *pose);

/* Turns a pose, in place, into the one of its two mirror images with fewer such bones; with as many, as
 * it is.  Returns how many fewer the pose now has than its mirror image, whether or not it was turned: 0
 * is no opinion.  A pose that is turned gets a mirror_margin of 0, as
 * the lift's own rule disagrees.  Takes 0.6 KB of stack. */
int edml_mirror_by_limits(edml_pose *pose);

/* Stands a pose on the floor.
 *   out  [14] metres: y upwards from the floor, on which the lower ankle's foot stands; x right and z
 *        towards the camera, along the floor, from mid-hip.  A camera that rolls or pitches turns them
 *        by the smallest rotation
 *   up   where upwards is, in the camera's axes, of any length: an accelerometer at rest, with its axes
 *        turned to the camera's, or {0, -1, 0} if the camera is assumed level
 * EDML_ERR_DEGENERATE of a zero vector, EDML_ERR_NOT_FINITE of one that is not finite and of a joint that
 * is not within 4 m.  Someone who jumps, lies or sits is put on the lower ankle all
 * the same. */
edml_status edml_floor(edml_point out[EDML_JOINTS], const edml_pose *pose, edml_point up);

/* ---- Lift in fixed point ------------------------------------------------------------------ */

/* The same without one float instruction, the same bits on every processor: for cores without an
 * FPU.  A Q16 number is an int32_t with 16 fraction bits, 65536 is 1; a Q24 one has 24. */
typedef struct {
    int32_t x, y; /* pixels, Q16, y down; -2^29 < x, y < 2^29 (8192 pixels) */
    int16_t c;    /* confidence, 32767 is 1; a joint with c <= 0 was not seen */
} edml_keypoint_q16;

typedef struct {
    int32_t x, y, z; /* metres, Q16 */
} edml_point_q16;

typedef struct {
    edml_point_q16 joint[EDML_JOINTS]; /* as in edml_pose */
    int32_t mirror_margin;             /* Q16, log-odds */
    int32_t residual;                  /* Q16, metres */
    uint16_t seen;
} edml_pose_q16;

/* edml_adapt() on whole numbers. */
void edml_adapt_q16(edml_keypoint_q16 out[EDML_JOINTS], const edml_keypoint_q16 in[],
                    const edml_format *format);

typedef struct edml_work_q24 edml_work_q24;

/* edml_lift() on whole numbers.
 *   in     coordinates at or beyond the ends of their range, which saturation makes of infinity,
 *          are EDML_ERR_NOT_FINITE; people under 1/8 pixel tall are EDML_ERR_DEGENERATE
 *   model  &edml_fconn_q15 or &edml_fconn_q7; a float one is EDML_ERR_MODEL */
edml_status edml_lift_q24(edml_pose_q16 *pose, const edml_keypoint_q16 in[EDML_JOINTS],
                          const edml_model *model, edml_work_q24 *work);

typedef struct edml_fconv_work_q24 edml_fconv_work_q24; /* 13.5 KB */

/* edml_lift_fconv() on whole numbers.  model  &edml_fconv_q7 */
edml_status edml_lift_fconv_q24(edml_pose_q16 *pose, const edml_keypoint_q16 in[EDML_JOINTS],
                                const edml_model *model, edml_fconv_work_q24 *work);

typedef struct {
    int32_t fx, fy, cx, cy; /* pixels, Q16, each under 8192 */
} edml_camera_q16;

typedef struct {
    edml_point_q16 joint[EDML_JOINTS], rotation[3], translation; /* as in edml_placement, Q16 */
    int32_t reprojection;                                        /* Q16, pixels */
    uint16_t steps;
} edml_placement_q16;

/* edml_place() and edml_place_sweep() on whole numbers; width and height in Q16. */
edml_status edml_place_q24(edml_placement_q16 *placement, const edml_pose_q16 *pose,
                           const edml_keypoint_q16 in[EDML_JOINTS], const edml_camera_q16 *camera,
                           edml_work_q24 *work);
edml_status edml_place_sweep_q24(edml_placement_q16 *placement, edml_camera_q16 *camera,
                                 const edml_pose_q16 *pose,
                                 const edml_keypoint_q16 in[EDML_JOINTS], int32_t width,
                                 int32_t height, edml_work_q24 *work);

/* The same on whole numbers, quality in Q16.  `up` may be in any unit, each component within 2^29. */
typedef struct {
    int32_t height, bone[EDML_BONES]; /* metres, Q16 */
} edml_person_q16;

edml_status edml_fit_person_q24(edml_pose_q16 *pose, const edml_person_q16 *person);
int32_t edml_quality_q24(const edml_pose_q16 *pose, const edml_keypoint_q16 in[EDML_JOINTS]);
edml_status edml_floor_q24(edml_point_q16 out[EDML_JOINTS], const edml_pose_q16 *pose,
                           edml_point_q16 up);
int edml_limits_q24(const edml_pose_q16 *pose);
int edml_mirror_by_limits_q24(edml_pose_q16 *pose);

/* ---- The stages, in the order in which data flow ------------------------------------------ */

typedef struct {
    float at[EDML_JOINTS][EDML_JOINTS];
} edml_matrix_f32;

/* Index into the 91 values of an EDM: row by row above the diagonal, 0 <= i < j < 14. */
#define EDML_PAIR(i, j) ((i) * (2 * EDML_JOINTS - 3 - (i)) / 2 + (j) - 1)

/* Where a joint is expected in the image, given all the others: at their mean, weighted by its row, in
 * units of 1 / EDML_COMPLETION_ONE, which is what a row adds up to.  The usual one is of the people
 * that the shipped networks were trained on.  Weights must come of a covariance, as those of
 * tools/fit_completion.py do; the absolute values in a row may add up to 3.4. */
#define EDML_COMPLETION_ONE 4096
typedef struct {
    int16_t weight[EDML_JOINTS][EDML_JOINTS]; /* a joint's own is 0 */
} edml_completion;
extern const edml_completion edml_usual_completion;

/* 2D distances between the joints, normalised: one factor for x and y, half the vertical extent
 * of the seen joints is 1 (section 3.1).
 *   edm         [91] up to about 2 * widest, more where joints are guessed far outside
 *   fewest      joints that must be seen, else EDML_ERR_TOO_FEW_JOINTS
 *   widest      ratio of the box's width to its height that may not be passed, else EDML_ERR_UNUSUAL
 *   completion  where joints are that were not seen, at most 9; NULL: pairs with one are zero
 * Also returns EDML_ERR_NOT_FINITE and EDML_ERR_DEGENERATE; that of a completion that does not say where
 * the missing joints are leaves nothing of use in edm. */
edml_status edml_edm_f32(float edm[EDML_PAIRS], const edml_keypoint in[EDML_JOINTS], int fewest,
                         float widest, const edml_completion *completion);

/* Distances in 3D that the model's network predicts (section 3.2); NaN if it is of the other kind.
 *   distance  [91] metres, >= 0
 *   edm       [91] as from edml_edm_f32() */
void edml_net_f32(float distance[EDML_PAIRS], const float edm[EDML_PAIRS],
                  const edml_model *model, edml_work *work);
void edml_net_fconv_f32(float distance[EDML_PAIRS], const float edm[EDML_PAIRS],
                        const edml_model *model, edml_fconv_work *work);

/* One Jacobi step: the sine of a rotation in the plane of the axes p and q, |sine| <= sqrt(1/2). */
typedef struct {
    float sine;
    uint8_t p, q;
} edml_rotation_f32;

/* Eigenvalues and eigenvectors of a symmetric matrix. */
typedef struct {
    float value[EDML_JOINTS];               /* descending */
    float vector[EDML_JOINTS][EDML_JOINTS]; /* row k belongs to value[k]: unit length, its largest
                                               component positive */
    edml_rotation_f32 turn[640];            /* work memory */
} edml_eigen_f32;

/* All eigenpairs by cyclic Jacobi, to rounding; only the upper triangle of `a` is read.  The
 * largest |entry| must be within 2^-50 to 2^56, or zero. */
void edml_jacobi_f32(edml_eigen_f32 *eigen, const edml_matrix_f32 *a);

/* Classical multidimensional scaling: the points whose distances are nearest, in the sense of
 * the Gram matrix (section 3.3).  Only the three largest eigenpairs are computed, and not to the
 * last bit: tests/test_mds.c holds a sample of people, their distances off by up to 100 mm, to
 * 0.05 mm of the full decomposition; rarely, a pose is further off.
 *   x         [14] metres, centroid at the origin, principal axes, either mirror image
 *   distance  [91] metres, at most 4 */
void edml_mds_f32(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS], edml_work *work);

/* What the refinement minimises; d are the pose's distances, D the network's. */
typedef enum {
    EDML_STRESS_NONE,   /* nothing: keep classical MDS */
    EDML_STRESS_SQUARE, /* sum (d^2 - D^2)^2, s-stress */
    EDML_STRESS_RAW,    /* sum (d - D)^2 */
    EDML_STRESS_EQ2     /* sum |d^2 - D^2|, eq. 2, by reweighting */
} edml_objective;

/* Moves the points downhill, at most `steps` steps of conjugate gradient; the objective never
 * rises.  Returns the number of steps taken. */
int edml_refine_f32(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS],
                    edml_objective objective, int steps, edml_work *work);

/* Objective as a mean over the 91 pairs, m^4, m^2 and m^2; 0 for EDML_STRESS_NONE. */
float edml_stress_f32(const edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS],
                      edml_objective objective);

/* Turns the points into the more human one of the two mirror images (section 3.3): a linear
 * score of how far limbs and head point forward of the torso.  Returns the margin. */
float edml_mirror_f32(edml_point x[EDML_JOINTS], const edml_model *model);

/* Turns the points to the camera: the rotation whose scaled-orthographic image fits the seen
 * joints best, moved so that mid-hip is the origin.  EDML_ERR_DEGENERATE if no rotation is better
 * than others: points or image are on a line, or have nothing to do with each other.
 *   seen  bit j: joint j of `in` counts; at least 4 */
edml_status edml_orient_f32(edml_point x[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS],
                            uint16_t seen);

/* Moves the seen joints of a pose of edml_orient_f32() toward where the image has them, the less the
 * more the two disagree; mid-hip stays the origin.
 *   seen  bit j: joint j of `in` counts */
void edml_blend_f32(edml_point x[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS], uint16_t seen,
                    const edml_model *model);

/* ---- The stages in fixed point ------------------------------------------------------------- */

/* What the stage of the same name above does, in Q24.  Ranges are narrower, and not checked:
 * distances 0 to 3 m; matrices of a Frobenius norm up to 90, whose eigenpairs come out to 2^-20 or
 * so, absolutely; `widest` up to 3.75; points of edml_mds_q24().  Those to be refined may be any
 * within 63 m on each axis, but where two are 8 m or more apart they stay as they are.  A stress
 * above 64 is given as 64. */
typedef struct {
    int32_t x, y, z; /* metres, Q24 */
} edml_point_q24;

typedef struct {
    int32_t at[EDML_JOINTS][EDML_JOINTS];
} edml_matrix_q24;

typedef struct {
    int32_t sine;
    uint8_t p, q;
} edml_rotation_q24;

typedef struct {
    int32_t value[EDML_JOINTS], vector[EDML_JOINTS][EDML_JOINTS];
    edml_rotation_q24 turn[640];
} edml_eigen_q24;

edml_status edml_edm_q24(int32_t edm[EDML_PAIRS], const edml_keypoint_q16 in[EDML_JOINTS],
                         int fewest, int32_t widest, const edml_completion *completion);
void edml_net_q24(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                  const edml_model *model, edml_work_q24 *work); /* a quantised model */
void edml_net_fconv_q24(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                        const edml_model *model, edml_fconv_work_q24 *work); /* edml_fconv_q7 */
void edml_jacobi_q24(edml_eigen_q24 *eigen, const edml_matrix_q24 *a);
void edml_mds_q24(edml_point_q24 x[EDML_JOINTS], const int32_t distance[EDML_PAIRS],
                  edml_work_q24 *work);
int edml_refine_q24(edml_point_q24 x[EDML_JOINTS], const int32_t distance[EDML_PAIRS],
                    edml_objective objective, int steps, edml_work_q24 *work);
int32_t edml_stress_q24(const edml_point_q24 x[EDML_JOINTS], const int32_t distance[EDML_PAIRS],
                        edml_objective objective);
int32_t edml_mirror_q24(edml_point_q24 x[EDML_JOINTS], const edml_model *model);
edml_status edml_orient_q24(edml_point_q24 x[EDML_JOINTS],
                            const edml_keypoint_q16 in[EDML_JOINTS], uint16_t seen);
void edml_blend_q24(edml_point_q24 x[EDML_JOINTS], const edml_keypoint_q16 in[EDML_JOINTS],
                    uint16_t seen, const edml_model *model);

/* ---- Work memory: public so that it can be allocated; its members are not part of the interface */

struct edml_work {
    float distance[EDML_PAIRS];
    edml_matrix_f32 matrix;
    edml_point x[EDML_JOINTS];
    union { /* stages that do not overlap in time */
        float layer[2][192];
        struct {
            int32_t layer[2][192], edm[EDML_PAIRS];
        } q24;
        edml_rotation_f32 turn[320];
        edml_point step[4][EDML_JOINTS];
    } use;
};

struct edml_work_q24 {
    int32_t distance[EDML_PAIRS];
    edml_matrix_q24 matrix;
    edml_point_q24 x[EDML_JOINTS];
    union {
        int32_t layer[2][192];
        edml_rotation_q24 turn[320];
        edml_point_q24 step[4][EDML_JOINTS];
    } use;
};

enum { EDML_CHANNELS = 64 }; /* of a map of FConv */

typedef struct {
    float wide[7 * 7 * EDML_CHANNELS], narrow[4 * 4 * EDML_CHANNELS];
    float sum[2][EDML_CHANNELS], image[EDML_JOINTS * EDML_JOINTS];
} edml_fconv_maps_f32;

typedef struct {
    int16_t wide[7 * 7 * EDML_CHANNELS], narrow[4 * 4 * EDML_CHANNELS];
    int32_t sum[2][EDML_CHANNELS], image[EDML_JOINTS * EDML_JOINTS];
} edml_fconv_maps_q7;

struct edml_fconv_work {
    edml_work lift;
    union {
        edml_fconv_maps_f32 f32;
        edml_fconv_maps_q7 q7;
    } maps;
};

struct edml_fconv_work_q24 {
    edml_work_q24 lift;
    edml_fconv_maps_q7 maps;
};

#ifdef __cplusplus
}
#endif

#endif
