#include "../../include/edmlift/camera.h"
