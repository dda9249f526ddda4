/* As the device's compiler would have it. */
#include "lanes_of_patterns.h"
