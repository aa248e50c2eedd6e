#include "../../include/edmlift/body.h"
