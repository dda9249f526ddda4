// Checkpoint files: reading returns what was written; damaged files, and states that do not fit the
// picture, are refused with the file's name.
#include "render/partial/checkpoint.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

class CheckpointFile : public FilmFile {};

/// Writes a checkpoint of a few hundred bytes to `path`; returns its bytes.
std::string small_checkpoint(const std::string& path) {
  Checkpoint checkpoint;
  checkpoint.options = {{"--seed", "1"}};
  checkpoint.picture.metadata.samples = 8;
  TraceState state;
  state.slice_samples = 64;
  state.sums = {1, 2, 3, 4};
  state.squares = {0.5f, 0.25f};
  state.samples = {8, 8};
  state.round.groups = {{4, {{0, 4}, {1, 4}}}};
  write_checkpoint(path, checkpoint, state);
  return bytes_of(path);
}

void expect_refused(const std::string& path, ErrorKind kind = ErrorKind::failed) {
  const Error error = error_of([&] { read_checkpoint(path); });
  EXPECT_EQ(error.kind(), kind);
  EXPECT_TRUE(contains(error.what(), "--resume " + path + ": ")) << error.what();
}

TEST_F(CheckpointFile, ComesBackAsItWasWritten) {
  small_checkpoint(path("a.ckpt"));
  const Checkpoint read = read_checkpoint(path("a.ckpt"));
  EXPECT_EQ(read.options, (Settings{{"--seed", "1"}}));
  EXPECT_EQ(read.state.sums, (std::vector<std::int64_t>{1, 2, 3, 4}));
  EXPECT_EQ(read.state.squares, (std::vector<float>{0.5f, 0.25f}));
  EXPECT_EQ(read.state.samples, (std::vector<std::uint32_t>{8, 8}));
  ASSERT_EQ(read.state.round.groups.size(), 1u);
  EXPECT_EQ(read.state.round.groups[0].work[1].first_sample, 4u);
  check_state("", read.state, {2, 4, 2});
}

// The tests of sealed files flip every bit; here, one bit of each byte is flipped.
TEST_F(CheckpointFile, AFlippedBitAndAnotherLengthIsRefusedByName) {
  const std::string whole = small_checkpoint(path("a.ckpt"));
  for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 9) {
    std::string bytes = whole;
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << (bit % 8)));
    write_bytes(path("b.ckpt"), bytes);
    SCOPED_TRACE(bit);
    expect_refused(path("b.ckpt"));
  }
  for (std::size_t length = 0; length < whole.size(); length += 37) {
    write_bytes(path("b.ckpt"), whole.substr(0, length));
    expect_refused(path("b.ckpt"));
  }
  write_bytes(path("b.ckpt"), whole + "x");
  expect_refused(path("b.ckpt"));
  expect_refused(path("nosuch.ckpt"), ErrorKind::input);
}

TEST_F(CheckpointFile, TheLargestSliceOfAGpuIsAccepted) {
  small_checkpoint(path("a.ckpt"));
  TraceState state = read_checkpoint(path("a.ckpt")).state;
  state.slice_samples = kMaxSliceSamples;
  check_state("", state, {2, 4, 2});
}

TEST_F(CheckpointFile, StatesThatDoNotFitThePictureAreRefused) {
  small_checkpoint(path("a.ckpt"));
  const TraceState good = read_checkpoint(path("a.ckpt")).state;
  using Change = std::function<void(TraceState&)>;
  const Change changes[] = {
      [](auto& s) { s.sums.pop_back(); },
      [](auto& s) { s.sums[0] = 9; },
      [](auto& s) { s.sums[1] = -1; },
      [](auto& s) { s.squares.clear(); },
      [](auto& s) { s.samples.push_back(1); },
      [](auto& s) { s.samples[0] = 3; },
      [](auto& s) { s.samples[0] = ~0u; },
      [](auto& s) { s.slice_samples = 0; },
      [](auto& s) { s.slice_samples = kMaxSliceSamples + 1; },
      [](auto& s) { s.round.groups[0].samples = 0; },
      [](auto& s) { s.round.groups[0].samples = ~0u; },
      [](auto& s) { s.round.groups[0].work[1].pixel = 2; },
      [](auto& s) { s.round.groups[0].work.clear(); },
      [](auto& s) { s.round.groups[0].work.resize(3); },
      [](auto& s) { s.round.entry = 1; },
      [](auto& s) { s.round.entry = 2; },
      [](auto& s) { s.round.sample = 1; },
      [](auto& s) { s.round.sample = 4; },
  };
  for (const Change& change : changes) {
    TraceState state = good;
    change(state);
    const Error error = error_of([&] { check_state("--resume a.ckpt", state, {2, 4, 2}); });
    EXPECT_TRUE(contains(error.what(), "--resume a.ckpt: ")) << error.what();
  }
}

// The message is not of --resume: who begins anew where a checkpoint does not fit must not, as the
// file may be whole.
TEST_F(CheckpointFile, OneThatCannotBeReadIsAnotherFailureThanADamagedOne) {
  std::filesystem::create_symlink("loop.ckpt", path("loop.ckpt"));
  for (const std::string& file :
       {folder_.string(), path("loop.ckpt"), path(std::string(256, 'n'))}) {
    const Error error = error_of([&] { read_checkpoint(file); });
    EXPECT_EQ(error.kind(), ErrorKind::failed) << error.what();
    EXPECT_TRUE(std::string(error.what()).starts_with(file + ": cannot be read: ")) << error.what();
  }
}

}  // namespace
}  // namespace dapple
