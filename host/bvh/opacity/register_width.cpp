// Finds the width of the processor's vector registers.
#include "bvh/opacity/register_width.hpp"

#ifdef DAPPLE_TARGET

namespace dapple {

const int kFloatsPerRegister = [] {
  __builtin_cpu_init();
  const bool has_512_bits =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl");
  return has_512_bits ? 16 : __builtin_cpu_supports("avx2") ? 8 : 4;
}();

}  // namespace dapple

#endif
