#include "../lib/models/fconn_w8.c"
