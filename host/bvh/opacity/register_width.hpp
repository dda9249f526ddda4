// Compiles code on rows of floats for the width of the processor's vector registers. In: a generic
// lambda. Out: what it writes, by the version for the widest registers that the processor has. No
// version contracts multiplications and additions, so all give the same bits.
#pragma once

#if defined(__x86_64__) && defined(__linux__)
#define DAPPLE_TARGET(name) __attribute__((target(name)))
#endif

/// For functions on rows that run inside the lambda of for_register_width(): only inlined code is
/// compiled for its instruction set.
#define DAPPLE_ALWAYS_INLINE inline __attribute__((always_inline))

namespace dapple {

#ifdef DAPPLE_TARGET

/// Floats in the widest vector register of this processor: 4, 8 or 16. 0, as good as 4, until the
/// library's static objects are made.
extern const int kFloatsPerRegister;

template <class Body>
DAPPLE_TARGET("avx512f,avx512bw,avx512cd,avx512dq,avx512vl")
void run_with_16_floats(const Body& body) {
  body.template operator()<16>();
}

template <class Body>
DAPPLE_TARGET("avx2")
void run_with_8_floats(const Body& body) {
  body.template operator()<8>();
}

/// Calls body.operator()<kLanes>(), kLanes the number of floats in a vector register. Write the
/// body as `[&]<int kLanes>() __attribute__((always_inline)) {...}`.
template <class Body>
void for_register_width(const Body& body) {
  switch (kFloatsPerRegister) {
    case 16:
      return run_with_16_floats(body);
    case 8:
      return run_with_8_floats(body);
    default:
      return body.template operator()<4>();
  }
}

#else

template <class Body>
void for_register_width(const Body& body) {
  body.template operator()<4>();
}

#endif

}  // namespace dapple
