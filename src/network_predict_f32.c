#include "../lib/network/predict_f32.c"
