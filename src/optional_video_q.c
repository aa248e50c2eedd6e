#include "../lib/optional/video_q.c"
