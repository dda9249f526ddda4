/* Types and macros that differ between OpenCL C and C++, so that the headers of this folder compile
   as both. Layout rule: structs have only scalars and fixed arrays, and no padding that a compiler
   could choose (tests/device/layout_test.cpp compares sizeof and offsets on the device). */
#ifndef DAPPLE_SHARED_LANGUAGE_H
#define DAPPLE_SHARED_LANGUAGE_H

#ifdef __OPENCL_VERSION__
#if !defined(DAPPLE_PREFILTERED) || !defined(DAPPLE_SHARED_ORIGIN)
#error "a kernel is compiled for a Variant: both of its options must be defined"
#endif
/* In C99 an inline function has no definition where a call to it is not inlined. PoCL and Intel's
   runtime provide one, and the figures are of their code. Compilers for GPUs may not, so functions
   are static there. */
#ifdef DAPPLE_STATIC_FUNCTIONS
#define inline static inline
#endif
#define DAPPLE_GLOBAL __global
typedef char schar; /* signed in OpenCL C */
#define DAPPLE_FUNCTION inline
/* For functions whose vectors would otherwise be passed through memory, and for bodies of loops
   that the compiler should vectorize. Not for the triangle tests, which then spill registers:
   experiment 708. */
#define DAPPLE_INLINE __attribute__((always_inline)) inline
/* For loops over axes. Otherwise their arrays of vectors stay in memory: experiment 709. */
#define DAPPLE_UNROLL _Pragma("unroll")
/* For loops over sixteen lanes or more, of scalars without aliases. Otherwise PoCL's compiler uses
   vectors of four: experiment 710. */
#if defined(__clang__)
#define DAPPLE_SIXTEEN_LANES _Pragma("clang loop vectorize_width(16) interleave(disable)")
#else
#define DAPPLE_SIXTEEN_LANES
#endif
#define DAPPLE_CACHE_ALIGNED __attribute__((aligned(64)))
#define dapple_bits_to_float(bits) as_float(bits)
#else
#include <bit>
#include <cmath>
#include <cstdint>
namespace dapple {
using schar = std::int8_t;
using uchar = std::uint8_t;
using ushort = std::uint16_t;
using uint = std::uint32_t;
}  // namespace dapple
#define DAPPLE_GLOBAL
#define DAPPLE_FUNCTION inline
#define DAPPLE_CACHE_ALIGNED alignas(64)
#define dapple_bits_to_float(bits) std::bit_cast<float>(bits)
#endif

#endif
