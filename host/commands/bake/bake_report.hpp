// The report of `dapple bake`. In: the result of bake(). Out: a summary as text, and statistics as
// JSON.
#pragma once

#include <string>

#include "dapple/bake.hpp"

namespace dapple {

struct BakeSeconds {
  double load = 0, write = 0, total = 0;
};

/// A line on a texture's charts and coverage.
std::string texture_note(const BakedTexture& texture);

/// A line on the occlusion textures of the file that were `replaced`; empty: none.
std::string replaced_note(std::size_t replaced);

/// A line on primitives whose materials are unlit; empty: none.
std::string unlit_note(std::size_t primitives);

void write_statistics(const BakeResult& result, const BakeSeconds& seconds,
                      const std::string& path);

void print_summary(const BakeStatistics& s, const BakeSeconds& seconds, const std::string& output);

}  // namespace dapple
