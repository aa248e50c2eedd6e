/* edml_predict() of any image in the body's frame.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS predict
#include "../native.h"

static edml_work work;

/* A person's, or joints anywhere within the frame. */
static int draw_image(edml_image *image, choices *from)
{
    sighting frame[EDML_JOINTS];
    edml_keypoint in[EDML_JOINTS];
    if (draw_one_in(from, 2)) {
        draw_frame(frame, from);
        to_keypoints(in, frame, EDML_JOINTS);
        return edml_body_frame(image, in, 5, &edml_default_imputation) == EDML_OK;
    }
    const double angle = draw_between(from, -3.2, 3.2);
    image->down.u = to_real(sin(angle));
    image->down.v = to_real(cos(angle));
    image->seen = (uint16_t)(draw_bits(from, 2) & ALL_SEEN);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int seen = image->seen >> j & 1;
        image->at[j].u = to_real(draw_between(from, -1, 1) * (seen ? 3.5 : 3.9));
        image->at[j].v = to_real(draw_between(from, -1, 1) * (seen ? 1 : 3.9));
    }
    return 1;
}

static void check_prediction(const edml_prediction *said, const edml_model *model)
{
    const double most = IS_EXACT ? 100 : 3; /* metres; in fixed point limited by the network */
    for (int k = 0; k < EDML_PAIRS && model->gives & EDML_GIVES_DISTANCES; k++)
        REQUIRE(from_real(said->distance[k]) >= 0 && from_real(said->distance[k]) <= most,
                "a bad distance");
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double share = from_real(said->share[j]);
        REQUIRE(share >= 0 && share <= 1, "a bad share");
        if (!(model->gives & EDML_GIVES_POINTS)) continue;
        const double sum = fabs(from_real(said->x[j].x)) + fabs(from_real(said->x[j].y)) +
                           fabs(from_real(said->x[j].z));
        REQUIRE(sum <= 6 * most, "a point is too far away");
    }
}

void FUZZ_TARGET(predict)(choices *from)
{
    edml_image image;
    edml_prediction said;
    snapshot before;
    place3 up;
    const edml_model *model = draw_model(from);
    const uint32_t less = draw_below(from, 64);
    const size_t work_bytes = sizeof work - (less < 4 ? less : 0);
    const int knows_up = draw_up(&up, from);
    const double length = sqrt(up.x * up.x + up.y * up.y + up.z * up.z);
    const int is_unit = knows_up && length > 1e-6 && length < 1e6;
    const double scale = is_unit ? 1 / length : 1;
    const point upwards = {to_real(scale * up.x), to_real(scale * up.y), to_real(scale * up.z)};
    memset(&image, 0, sizeof image);
    if (!draw_image(&image, from)) return;
    memset(&said, 0xA5, sizeof said);
    take_snapshot(&before, &said, sizeof said);
    const edml_status status = edml_predict(&said, &image, is_unit ? &upwards : NULL, model, &work,
                                            work_bytes);
    if (!check_status(status, ALLOW(EDML_ERR_WORK_TOO_SMALL), &before)) {
        REQUIRE(work_bytes < edml_model_work_bytes(model), "enough work memory was refused");
        return;
    }
    REQUIRE(work_bytes >= edml_model_work_bytes(model), "too small a work memory was taken");
    check_prediction(&said, model);
#ifdef EDML_FUZZ_Q
    edml_prediction watched;
    memset(&watched, 0xA5, sizeof watched);
    WATCH(status, checked_predict(&watched, &image, is_unit ? &upwards : NULL, model, &taken), &said,
          &watched, sizeof said);
#endif
}
