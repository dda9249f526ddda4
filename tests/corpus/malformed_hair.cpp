// HAIR files that are cut off, whose counts do not fit their bytes, or whose values are not valid
// numbers.
#include <limits>

#include "corpus/corpus.hpp"
#include "support/files/hair_builder.hpp"

namespace dapple::test {
namespace {

void add(MalformedCases& cases, const std::string& name, const Bytes& bytes,
         const std::string& says) {
  cases.push_back({"hair_" + name, {"scene.hair", {{"scene.hair", bytes}}, {}}, says});
}

/// A valid file in which `value` replaces the four bytes at the offset `at`.
Bytes with(std::size_t at, std::uint32_t value) {
  Bytes bytes = two_strands().bytes();
  for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<std::uint8_t>(value >> (8 * k));
  return bytes;
}

void add_cut_files(MalformedCases& cases) {
  const Bytes sound = two_strands().bytes();
  const auto cut = [&](std::ptrdiff_t bytes) {
    return Bytes(sound.begin(), sound.begin() + bytes);
  };
  add(cases, "of_nothing", {}, "is not a HAIR file");
  add(cases, "of_its_name_alone", cut(4), "ends in its header (it has 4 bytes of 128)");
  add(cases, "of_half_a_header", cut(64), "ends in its header");
  add(cases, "of_a_header_alone", cut(128), "ends early");
  add(cases, "without_its_last_byte", cut(static_cast<std::ptrdiff_t>(sound.size()) - 1),
      "ends early: 2 strands and 6 points need 200 bytes, it has 199");
  add(cases, "that_is_a_glb", GltfBuilder().glb(), "is not a HAIR file");
}

void add_counts(MalformedCases& cases) {
  add(cases, "of_all_strands_there_can_be", with(4, 0xffffffffu), "its 4,294,967,295 strands");
  add(cases, "of_no_strand", with(4, 0), "its 0 strands of 0 segments take 0");
  add(cases, "of_all_points_there_can_be", with(8, 0xffffffffu), "points (at most");
  add(cases, "of_many_points", with(8, 1u << 28), "need 3,221,225,600 bytes");
  add(cases, "of_all_segments_there_can_be", with(16, 0xffffffffu), "8,589,934,590 segments");
  add(cases, "of_a_segment_too_many", with(16, 3), "of 6 segments take 8");
  add(cases, "of_a_segment_too_few", with(16, 1), "of 2 segments take 4");
  add(cases, "without_points", with(12, 0), "has no array of points");
  add(cases, "of_unknown_arrays", with(12, 0x22), "the format does not know");
  add(cases, "of_all_arrays_and_bytes_of_one", with(12, 31), "ends early");
}

void add_values(MalformedCases& cases) {
  HairBuilder builder = two_strands();
  builder.thickness = {1, 1, 1, -1, 1, 1};
  add(cases, "of_negative_thickness", builder.bytes(), "point 3 has a thickness of -1");
  builder.thickness[3] = std::numeric_limits<float>::infinity();
  add(cases, "of_infinite_thickness", builder.bytes(), "point 3 has a thickness of inf");
  builder.thickness.clear();
  builder.transparency.assign(6, std::numeric_limits<float>::quiet_NaN());
  add(cases, "of_no_transparency", builder.bytes(), "point 0 has a transparency of nan");
  builder.transparency.clear();
  builder.points.assign(18, std::numeric_limits<float>::quiet_NaN());
  add(cases, "of_no_finite_point", builder.bytes(), "has no strand that is longer than thick");
  builder.points.assign(18, 3.0f);
  add(cases, "without_length", builder.bytes(), "has no strand that is longer than thick");
}

}  // namespace

void add_malformed_hair(MalformedCases& cases) {
  add_cut_files(cases);
  add_counts(cases);
  add_values(cases);
}

}  // namespace dapple::test
