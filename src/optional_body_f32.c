#include "../lib/optional/body_f32.c"
