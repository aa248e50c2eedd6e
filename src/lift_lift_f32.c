#include "../lib/lift/lift_f32.c"
