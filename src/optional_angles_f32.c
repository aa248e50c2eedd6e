#include "../lib/optional/angles_f32.c"
