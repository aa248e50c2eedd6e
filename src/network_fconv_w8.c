#include "../lib/network/fconv_w8.c"
