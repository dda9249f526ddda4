// NumPy arrays: as spans on the way in and from vectors on the way out, both without copies.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple::python {

namespace nb = nanobind;

/// (n, 3) float32, C-contiguous.
using VectorsIn =
    nb::ndarray<const float, nb::numpy, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
/// (n,) float32 and uint32.
using FloatsIn = nb::ndarray<const float, nb::numpy, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using IndicesIn =
    nb::ndarray<const std::uint32_t, nb::numpy, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
/// (n, 2) float32.
using CoordinatesIn =
    nb::ndarray<const float, nb::numpy, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using FloatsOut = nb::ndarray<float, nb::numpy>;
using IndicesOut = nb::ndarray<std::uint32_t, nb::numpy>;

inline std::span<const V3f> vectors(const VectorsIn& array) {
  static_assert(sizeof(V3f) == 3 * sizeof(float));
  return {reinterpret_cast<const V3f*>(array.data()), array.shape(0)};
}

/// An array of `shape` that owns `values`.
template <class Number, class Value>
nb::ndarray<Number, nb::numpy> array_of(std::vector<Value>&& values,
                                        std::initializer_list<std::size_t> shape) {
  auto* kept = new std::vector<Value>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<Value>*>(p); });
  return {reinterpret_cast<Number*>(kept->data()), shape, owner};
}

/// (n,) from n numbers, and (n, 3) from n vectors.
inline FloatsOut array_of(std::vector<float>&& values) {
  const std::size_t count = values.size();
  return array_of<float>(std::move(values), {count});
}
inline FloatsOut array_of(std::vector<V3f>&& values) {
  const std::size_t count = values.size();
  return array_of<float>(std::move(values), {count, 3});
}

}  // namespace dapple::python
