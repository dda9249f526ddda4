// Whether values of enumerations that callers give are among their enumerators.
#pragma once

namespace dapple {

/// `last`: the last enumerator of an enumeration without gaps, from 0 on.
template <class Enumeration>
bool is_enumerator(Enumeration value, Enumeration last) {
  return static_cast<int>(value) >= 0 && static_cast<int>(value) <= static_cast<int>(last);
}

}  // namespace dapple
