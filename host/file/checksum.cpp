#include "file/checksum.hpp"

#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace dapple {

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

Checksum ChecksumStream::value() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(&state_->xxh3);
  return {hash.high64, hash.low64};
}

}  // namespace dapple
