#include "../lib/models/fconn_f32.c"
