#include "files/checksum.hpp"

#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace dapple {
namespace {

Checksum words_of(const XXH128_hash_t& hash) { return {hash.high64, hash.low64}; }

}  // namespace

Checksum checksum(std::string_view bytes) {
  return words_of(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string hex_text(const Checksum& checksum) {
  return fmt::format("{:016x}{:016x}", checksum[0], checksum[1]);
}

struct ChecksumStream::State {
  XXH3_state_t xxh3;
};

// On the heap: the state is 576 bytes, aligned to 64, and xxhash.h stays in this file.
ChecksumStream::ChecksumStream() : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(&state_->xxh3);
}

ChecksumStream::~ChecksumStream() = default;

void ChecksumStream::add(std::span<const std::byte> bytes) {
  XXH3_128bits_update(&state_->xxh3, bytes.data(), bytes.size());
}

Checksum ChecksumStream::value() const { return words_of(XXH3_128bits_digest(&state_->xxh3)); }

}  // namespace dapple
