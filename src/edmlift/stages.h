#include "../../include/edmlift/stages.h"
