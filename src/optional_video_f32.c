#include "../lib/optional/video_f32.c"
