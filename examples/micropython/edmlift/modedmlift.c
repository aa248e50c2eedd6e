/* edmlift as a module of MicroPython:
 *
 *     edmlift.lift(keypoints) -> [(x, y, z), ...]          14 joints in metres, of 14 keypoints
 *     edmlift.adapt(keypoints, format) -> [(x, y, c), ...] 14 keypoints, of a detector's
 *
 * A keypoint is (x, y, c), or None where the detector did not see it.
 *
 * SPDX-License-Identifier: MIT
 */
#include "edmlift.h"
#include "py/runtime.h"

static edml_keypoint read_keypoint(mp_obj_t object)
{
    const edml_keypoint unseen = {0, 0, 0};
    if (object == mp_const_none) return unseen;
    mp_obj_t *number;
    mp_obj_get_array_fixed_n(object, 3, &number);
    const edml_keypoint seen = {(float)mp_obj_get_float(number[0]), (float)mp_obj_get_float(number[1]),
                                (float)mp_obj_get_float(number[2])};
    return seen;
}

static void read_keypoints(edml_keypoint keypoint[], mp_obj_t objects, size_t count)
{
    mp_obj_t *object;
    mp_obj_get_array_fixed_n(objects, count, &object);
    for (size_t n = 0; n < count; n++) keypoint[n] = read_keypoint(object[n]);
}

static mp_obj_t new_triple(float x, float y, float z)
{
    mp_obj_t numbers[] = {mp_obj_new_float((mp_float_t)x), mp_obj_new_float((mp_float_t)y),
                          mp_obj_new_float((mp_float_t)z)};
    return mp_obj_new_tuple(3, numbers);
}

static mp_obj_t edmlift_lift(mp_obj_t keypoints)
{
    edml_keypoint in[EDML_JOINTS];
    edml_pose pose;
    mp_obj_t joint[EDML_JOINTS];
    read_keypoints(in, keypoints, EDML_JOINTS);
    edml_work *work = m_new(edml_work, 1); /* not static: threads of some ports run at the same time */
    const edml_status status = edml_lift(&pose, in, NULL, &edml_direct_w16, work, sizeof *work);
    m_del(edml_work, work, 1);
    if (status != EDML_OK)
        mp_raise_msg_varg(&mp_type_ValueError, MP_ERROR_TEXT("%s"), edml_status_name(status));
    for (int j = 0; j < EDML_JOINTS; j++)
        joint[j] = new_triple(pose.joint[j].x, pose.joint[j].y, pose.joint[j].z);
    return mp_obj_new_list(EDML_JOINTS, joint);
}
static MP_DEFINE_CONST_FUN_OBJ_1(edmlift_lift_obj, edmlift_lift);

static mp_obj_t edmlift_adapt(mp_obj_t keypoints, mp_obj_t name)
{
    edml_keypoint out[EDML_JOINTS];
    mp_obj_t joint[EDML_JOINTS];
    const edml_format *format = edml_format_find(mp_obj_str_get_str(name));
    if (format == NULL) mp_raise_ValueError(MP_ERROR_TEXT("unknown format"));
    edml_keypoint *in = m_new(edml_keypoint, format->keypoints);
    read_keypoints(in, keypoints, format->keypoints);
    edml_adapt(out, in, format);
    m_del(edml_keypoint, in, format->keypoints);
    for (int j = 0; j < EDML_JOINTS; j++) joint[j] = new_triple(out[j].x, out[j].y, out[j].c);
    return mp_obj_new_list(EDML_JOINTS, joint);
}
static MP_DEFINE_CONST_FUN_OBJ_2(edmlift_adapt_obj, edmlift_adapt);

static const mp_rom_map_elem_t edmlift_globals_table[] = {
    {MP_ROM_QSTR(MP_QSTR___name__), MP_ROM_QSTR(MP_QSTR_edmlift)},
    {MP_ROM_QSTR(MP_QSTR_lift), MP_ROM_PTR(&edmlift_lift_obj)},
    {MP_ROM_QSTR(MP_QSTR_adapt), MP_ROM_PTR(&edmlift_adapt_obj)},
};
static MP_DEFINE_CONST_DICT(edmlift_globals, edmlift_globals_table);

const mp_obj_module_t edmlift_module = {
    .base = {&mp_type_module},
    .globals = (mp_obj_dict_t *)&edmlift_globals,
};
MP_REGISTER_MODULE(MP_QSTR_edmlift, edmlift_module);
