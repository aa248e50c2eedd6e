#include "../lib/optional/camera_q.c"
