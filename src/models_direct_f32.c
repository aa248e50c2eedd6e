#include "../lib/models/direct_f32.c"
