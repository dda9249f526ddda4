/* lanes_of_patterns.h as compiled for an x86 without AVX-512. */
#undef __AVX512DQ__
#include "lanes_of_patterns.h"
