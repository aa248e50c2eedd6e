#include "../lib/network/fconn_w16.c"
