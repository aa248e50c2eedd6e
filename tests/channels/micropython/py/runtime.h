/* Stands for MicroPython's: what modedmlift.c uses of it.  Objects are never freed, and an exception ends the
 * program.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PY_RUNTIME_H
#define PY_RUNTIME_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

typedef double mp_float_t;
typedef struct object *mp_obj_t;
typedef struct {
    const char *name;
} mp_obj_type_t;

extern const mp_obj_type_t mp_type_ValueError, mp_type_module;
extern struct object none_object;
#define mp_const_none (&none_object)

mp_float_t mp_obj_get_float(mp_obj_t object);
void mp_obj_get_array_fixed_n(mp_obj_t object, size_t count, mp_obj_t **items);
const char *mp_obj_str_get_str(mp_obj_t object);
mp_obj_t mp_obj_new_float(mp_float_t number);
mp_obj_t mp_obj_new_tuple(size_t count, const mp_obj_t *items);
mp_obj_t mp_obj_new_list(size_t count, mp_obj_t *items);
#define m_new(type, count) ((type *)malloc(sizeof(type) * (count)))
#define m_del(type, pointer, count) free(pointer)

#define MP_ERROR_TEXT(text) (text)
_Noreturn void mp_raise_ValueError(const char *text);
_Noreturn void mp_raise_msg_varg(const mp_obj_type_t *type, const char *format, ...);

enum { MP_QSTR___name__, MP_QSTR_edmlift, MP_QSTR_lift, MP_QSTR_adapt };
typedef struct {
    union {
        mp_obj_t (*one)(mp_obj_t);
        mp_obj_t (*two)(mp_obj_t, mp_obj_t);
    } call;
} mp_obj_fun_t;
typedef struct {
    const void *key, *value;
} mp_rom_map_elem_t;
typedef struct {
    size_t count;
    const mp_rom_map_elem_t *table;
} mp_obj_dict_t;
typedef struct {
    struct {
        const mp_obj_type_t *type;
    } base;
    mp_obj_dict_t *globals;
} mp_obj_module_t;

#define MP_DEFINE_CONST_FUN_OBJ_1(name, function) const mp_obj_fun_t name = {{.one = function}}
#define MP_DEFINE_CONST_FUN_OBJ_2(name, function) const mp_obj_fun_t name = {{.two = function}}
#define MP_DEFINE_CONST_DICT(name, of) const mp_obj_dict_t name = {sizeof(of) / sizeof((of)[0]), of}
#define MP_ROM_QSTR(name) ((const void *)(intptr_t)(name))
#define MP_ROM_PTR(pointer) pointer
#define MP_REGISTER_MODULE(name, module) extern const mp_obj_module_t module

#endif
