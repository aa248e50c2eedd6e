/* The pipeline: strings the stages together.  With LIFT_BY_FCONV it is that of the network that has
 * a lift, and memory, of its own.
 *
 * SPDX-License-Identifier: MIT
 */

#ifdef LIFT_BY_FCONV
#define LIFT NAME(edml_lift_fconv)
#define NET NAME(edml_net_fconv)
#define CAN_RUN RUNS_FCONV
#define SHARED(memory) (&(memory)->lift)
typedef fconv_work_memory lift_memory;
#else
#define LIFT NAME(edml_lift)
#define NET NAME(edml_net)
#define CAN_RUN RUNS
#define SHARED(memory) (memory)
typedef work_memory lift_memory;
#endif

edml_status LIFT(pose *out, const keypoint in[EDML_JOINTS], const edml_model *model,
                 lift_memory *memory)
{
    if (out == NULL || in == NULL || model == NULL || memory == NULL) return EDML_ERR_ARGUMENT;
    if (!CAN_RUN(model)) return EDML_ERR_MODEL;
    work_memory *work = SHARED(memory);
    real *edm = work->use.layer[0];
    edml_status status = NAME(edml_edm)(edm, in, model->fewest_joints, SETTING(model->widest),
                                        model->completion);
    if (status != EDML_OK) return status;

    const uint16_t seen = seen_joints(in);
    const edml_objective objective = (edml_objective)model->objective;
    NET(work->distance, edm, model, memory);
    NAME(edml_mds)(work->x, work->distance, work);
    NAME(edml_refine)(work->x, work->distance, objective, model->refine_steps, work);
    const real residual = SQRT(NAME(edml_stress)(work->x, work->distance, EDML_STRESS_RAW));
    const real margin = NAME(edml_mirror)(work->x, model);
    status = NAME(edml_orient)(work->x, in, seen);
    if (status != EDML_OK) return status;
    NAME(edml_blend)(work->x, in, seen, model);
    for (int j = 0; j < EDML_JOINTS; j++) {
        out->joint[j].x = RESULT(work->x[j].x);
        out->joint[j].y = RESULT(work->x[j].y);
        out->joint[j].z = RESULT(work->x[j].z);
    }
    out->residual = RESULT(residual);
    out->mirror_margin = RESULT(margin);
    out->seen = seen;
    return EDML_OK;
}
