/* As on other devices. */
#undef __AVX512DQ__
#undef __AVX__
#include "lanes_of_patterns.h"
