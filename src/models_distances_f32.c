#include "../lib/models/distances_f32.c"
