#include "../lib/network/fconv_f32.c"
