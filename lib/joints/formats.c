/* The keypoints of detectors: a row a format.
 *
 * The order of `limb`: right shoulder, elbow, wrist, left ones, right hip, knee, ankle, left ones.
 * test_adapt.c has the detectors' own lists of names.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stddef.h>

#include "edmlift.h"

#define NO EDML_NO_KEYPOINT
#define NO_FACE                                                                                            \
    {NO, NO}, { NO, NO, NO }
#define COCO_LIMBS {6, 8, 10, 5, 7, 9, 12, 14, 16, 11, 13, 15}
#define COCO_FACE {3, 4}, {1, 2, 0}
#define BLAZEPOSE_LIMBS {12, 14, 16, 11, 13, 15, 24, 26, 28, 23, 25, 27}
#define MPI_LIMBS {2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}

/* Name, keypoints, normalised by what, limb, ears, face, crown, centre. */
const edml_format edml_coco17 = {"coco17", 17, 0, COCO_LIMBS, COCO_FACE, NO, NO};
const edml_format edml_movenet17 = {"movenet17", 17, EDML_BY_SQUARE, COCO_LIMBS, COCO_FACE, NO, NO};
const edml_format edml_body25 = {"body25", 25,          0,  {2, 3, 4, 5, 6, 7, 9, 10, 11, 12, 13, 14},
                                 {18, 17}, {16, 15, 0}, NO, NO};
const edml_format edml_body25b = {"body25b", 25, 0, COCO_LIMBS, COCO_FACE, 18, NO};
const edml_format edml_coco18 = {"coco18", 18, 0, MPI_LIMBS, {17, 16}, {15, 14, 0}, NO, NO};
const edml_format edml_mpi15 = {"mpi15", 15, 0, MPI_LIMBS, NO_FACE, 0, NO};
const edml_format edml_cpm14 = {"cpm14", 14, 0, MPI_LIMBS, NO_FACE, 0, NO};
const edml_format edml_mpii16 = {"mpii16", 16, 0, {12, 11, 10, 13, 14, 15, 2, 1, 0, 3, 4, 5},
                                 NO_FACE,  9,  NO};
const edml_format edml_lsp14 = {"lsp14", 14, 0, {8, 7, 6, 9, 10, 11, 2, 1, 0, 3, 4, 5}, NO_FACE, 13, NO};
const edml_format edml_h36m17_right_first = {
    "h36m17_right_first", 17, 0, {14, 15, 16, 11, 12, 13, 1, 2, 3, 4, 5, 6}, NO_FACE, NO, 10};
const edml_format edml_h36m17_left_first = {
    "h36m17_left_first", 17, 0, {14, 15, 16, 11, 12, 13, 4, 5, 6, 1, 2, 3}, NO_FACE, NO, 10};
const edml_format edml_blazepose33 = {
    "blazepose33", 33, EDML_BY_IMAGE, BLAZEPOSE_LIMBS, {7, 8}, {2, 5, 0}, NO, NO};
const edml_format edml_halpe26 = {"halpe26", 26, 0, COCO_LIMBS, COCO_FACE, 17, NO};
const edml_format edml_crowdpose14 = {"crowdpose14", 14, 0, {1, 3, 5, 0, 2, 4, 7, 9, 11, 6, 8, 10},
                                      NO_FACE,       12, NO};
const edml_format edml_aic14 = {"aic14", 14, 0, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, NO_FACE, 12, NO};

const edml_format *const edml_formats[] = {
    &edml_coco17,
    &edml_movenet17,
    &edml_body25,
    &edml_body25b,
    &edml_coco18,
    &edml_mpi15,
    &edml_cpm14,
    &edml_mpii16,
    &edml_lsp14,
    &edml_h36m17_right_first,
    &edml_h36m17_left_first,
    &edml_blazepose33,
    &edml_halpe26,
    &edml_crowdpose14,
    &edml_aic14,
    NULL,
};

static int same_text(const char *a, const char *b) /* strcmp() would be a dependency */
{
    while (*a != '\0' && *a == *b) a++, b++;
    return *a == *b;
}

const edml_format *edml_format_find(const char *name)
{
    for (int n = 0; edml_formats[n] != NULL; n++)
        if (same_text(edml_formats[n]->name, name)) return edml_formats[n];
    return NULL;
}
