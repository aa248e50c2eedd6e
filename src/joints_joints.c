#include "../lib/joints/joints.c"
