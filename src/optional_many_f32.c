#include "../lib/optional/many_f32.c"
