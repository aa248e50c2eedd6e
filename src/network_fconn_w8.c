#include "../lib/network/fconn_w8.c"
