#include "../lib/network/fconn_f32.c"
