#include "../lib/joints/adapt_f32.c"
