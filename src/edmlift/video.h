#include "../../include/edmlift/video.h"
