/* Calls edmlift.lift(), or with an argument edmlift.adapt() by that format, with a list of the keypoints on
 * standard input: numbers that a blank parts, three of each, or "None".  Prints the triples of the result, in
 * hexadecimal, or what was raised.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "py/runtime.h"

struct object {
    enum { NONE, NUMBER, TEXT, ARRAY } kind;
    double number;
    const char *text;
    size_t count;
    mp_obj_t *items;
};
struct object none_object;
const mp_obj_type_t mp_type_ValueError = {"ValueError"}, mp_type_module = {"module"};
static const mp_obj_type_t mp_type_TypeError = {"TypeError"};
extern const mp_obj_module_t edmlift_module;

static mp_obj_t new_object(int kind)
{
    mp_obj_t object = calloc(1, sizeof *object);
    object->kind = kind;
    return object;
}

void mp_raise_msg_varg(const mp_obj_type_t *type, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    printf("%s: ", type->name);
    vprintf(format, arguments);
    puts("");
    exit(1);
}

void mp_raise_ValueError(const char *text) { mp_raise_msg_varg(&mp_type_ValueError, "%s", text); }

mp_float_t mp_obj_get_float(mp_obj_t object)
{
    if (object->kind != NUMBER) mp_raise_msg_varg(&mp_type_TypeError, "no number");
    return object->number;
}

void mp_obj_get_array_fixed_n(mp_obj_t object, size_t count, mp_obj_t **items)
{
    if (object->kind != ARRAY) mp_raise_msg_varg(&mp_type_TypeError, "no tuple or list");
    if (object->count != count)
        mp_raise_msg_varg(&mp_type_ValueError, "%d items, not %d", (int)object->count, (int)count);
    *items = object->items;
}

const char *mp_obj_str_get_str(mp_obj_t object)
{
    if (object->kind != TEXT) mp_raise_msg_varg(&mp_type_TypeError, "no string");
    return object->text;
}

mp_obj_t mp_obj_new_float(mp_float_t number)
{
    mp_obj_t object = new_object(NUMBER);
    object->number = number;
    return object;
}

mp_obj_t mp_obj_new_tuple(size_t count, const mp_obj_t *items)
{
    mp_obj_t object = new_object(ARRAY);
    object->count = count;
    object->items = calloc(count, sizeof *items);
    memcpy(object->items, items, count * sizeof *items);
    return object;
}

mp_obj_t mp_obj_new_list(size_t count, mp_obj_t *items) { return mp_obj_new_tuple(count, items); }

static const mp_obj_fun_t *find(int key)
{
    const mp_obj_dict_t *globals = edmlift_module.globals;
    for (size_t n = 0; n < globals->count; n++)
        if (globals->table[n].key == MP_ROM_QSTR(key)) return globals->table[n].value;
    mp_raise_ValueError("no such function");
}

static mp_obj_t read_list(void)
{
    enum { MOST = 300 };
    mp_obj_t number[MOST], item[MOST];
    size_t numbers = 0, items = 0;
    char word[64];
    while (items < MOST && scanf("%63s", word) == 1) {
        if (strcmp(word, "None") == 0) {
            item[items++] = mp_const_none;
            continue;
        }
        number[numbers++] = mp_obj_new_float(strtod(word, NULL));
        if (numbers == 3) {
            item[items++] = mp_obj_new_tuple(numbers, number);
            numbers = 0;
        }
    }
    return mp_obj_new_list(items, item);
}

int main(int argc, char **argv)
{
    mp_obj_t name = new_object(TEXT), result;
    if (argc > 1) {
        name->text = argv[1];
        result = find(MP_QSTR_adapt)->call.two(read_list(), name);
    } else {
        result = find(MP_QSTR_lift)->call.one(read_list());
    }
    for (size_t j = 0; j < result->count; j++) {
        const mp_obj_t *const axis = result->items[j]->items;
        printf("%a %a %a\n", axis[0]->number, axis[1]->number, axis[2]->number);
    }
    return 0;
}
