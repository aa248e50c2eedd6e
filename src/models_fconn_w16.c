#include "../lib/models/fconn_w16.c"
