#include "../include/edmlift.h"
