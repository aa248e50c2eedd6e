#include "../lib/optional/camera_f32.c"
