// Layout: header, table of the sections' sizes, sections. Each begins at a multiple of
// kSectionAlignment, and the bytes between them are zero. The checksum covers the whole file, with
// zeros in place of the checksum itself, so a change of any bit is detected.
#include "files/sealed_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>

#include "dapple/error.hpp"
#include "files/checksum.hpp"

namespace dapple {
namespace {

/// As in PNG's signature, the first byte is not text, and the line ends are damaged when a transfer
/// treats the file as text.
constexpr std::array<char, 8> kMagic = {'\x89', 'D', 'A', 'P', '\r', '\n', '\x1a', '\n'};
constexpr std::uint32_t kLayoutVersion = 1;
constexpr std::uint32_t kByteOrder = 0x01020304;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t layout = kLayoutVersion;
  std::uint32_t byte_order = kByteOrder;
  std::array<char, 16> kind{};
  std::uint32_t version = 0;
  std::uint32_t section_count = 0;
  std::uint64_t file_bytes = 0;
  Checksum checksum{};
  std::array<std::uint64_t, 8> spare{};
};
static_assert(sizeof(Header) == kSectionAlignment);

/// `bytes` rounded up to the beginning of the next section.
std::uint64_t aligned(std::uint64_t bytes) {
  return (bytes + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw Error(ErrorKind::input, path + ": " + reason);
}

/// Calls `take` with all bytes of the file in order: header, table and sections, each followed by
/// the zeros that align the next one.
template <class Take>
void for_each_section(const Header& header, std::span<const std::uint64_t> sizes,
                      std::span<const Section> sections, const Take& take) {
  static constexpr std::array<std::byte, kSectionAlignment> kZeros{};
  const auto take_aligned = [&](Section section) {
    take(section);
    take(Section(kZeros).first(aligned(section.size()) - section.size()));
  };
  take_aligned(std::as_bytes(std::span(&header, 1)));
  take_aligned(std::as_bytes(sizes));
  for (const Section& section : sections) take_aligned(section);
}

Header sealed_header(const SealedKind& kind, std::span<const std::uint64_t> sizes,
                     std::span<const Section> sections) {
  Header header;
  assert(kind.name.size() < header.kind.size());
  std::copy(kind.name.begin(), kind.name.end(), header.kind.begin());
  header.version = kind.version;
  header.section_count = static_cast<std::uint32_t>(sizes.size());
  header.file_bytes = sizeof header + aligned(sizes.size_bytes());
  for (const std::uint64_t size : sizes) header.file_bytes += aligned(size);
  ChecksumStream checksum;
  for_each_section(header, sizes, sections, [&](Section section) { checksum.add(section); });
  header.checksum = checksum.value();
  return header;
}

/// A whole file, mapped for reading.
struct Mapping {
  std::shared_ptr<const void> memory;
  Section bytes;
};

// MAP_POPULATE: the checksum reads the whole file right after this.
Mapping map_file(const std::string& path) {
  // O_NONBLOCK: if the path names a FIFO, open() must not block.
  const int descriptor = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) refuse(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  struct stat status {};
  const bool is_file = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  const auto size = is_file ? static_cast<std::size_t>(status.st_size) : 0;
  void* address = MAP_FAILED;
  if (size > 0) address = mmap(nullptr, size, PROT_READ, MAP_SHARED | MAP_POPULATE, descriptor, 0);
  const int problem = errno;
  close(descriptor);
  if (!is_file) refuse(path, "cannot be read: it is not a regular file");
  if (size == 0) refuse(path, "damaged: it is empty");
  if (address == MAP_FAILED)
    refuse(path, fmt::format("cannot be read: {}", std::strerror(problem)));
  return {std::shared_ptr<const void>(address, [size](void* at) { munmap(at, size); }),
          {static_cast<const std::byte*>(address), size}};
}

std::string text_of(const std::array<char, 16>& name) {
  return {name.begin(), std::find(name.begin(), name.end(), '\0')};
}

/// The file's header, which may still be damaged: the checksum is verified later. Throws Error
/// input when it is of another kind, version or size.
Header read_header(const std::string& path, const SealedKind& kind, Section bytes) {
  Header header;
  const std::size_t there = std::min(bytes.size(), sizeof header);
  std::memcpy(&header, bytes.data(), there);
  if (there < sizeof kMagic || header.magic != kMagic) {
    refuse(path, fmt::format("no {} file of dapple, or damaged", kind.name));
  }
  if (bytes.size() < sizeof header) {
    refuse(path, fmt::format("damaged: it ends in its header, after {} bytes", bytes.size()));
  }
  if (header.layout != kLayoutVersion || header.byte_order != kByteOrder) {
    refuse(path, "written by another version of dapple or another kind of machine, or damaged");
  }
  if (text_of(header.kind) != kind.name) {
    refuse(path, fmt::format("no {} file of dapple, or damaged", kind.name));
  }
  if (header.version != kind.version) {
    refuse(path, fmt::format("{} file of version {}, this program reads version {}", kind.name,
                             header.version, kind.version));
  }
  if (header.file_bytes != bytes.size()) {
    refuse(path, fmt::format("damaged: it has {} bytes, and {} when it was written", bytes.size(),
                             header.file_bytes));
  }
  return header;
}

void check_checksum(const std::string& path, Header header, Section bytes) {
  const Checksum expected = header.checksum;
  header.checksum = {};
  ChecksumStream checksum;
  checksum.add(std::as_bytes(std::span(&header, 1)));
  checksum.add(bytes.subspan(sizeof header));
  if (checksum.value() != expected) refuse(path, "damaged: its checksum is not that of its bytes");
}

// The checksum is correct here, so sizes that do not fit mean that another program made the file.
std::vector<Section> split(const std::string& path, const Header& header, Section bytes) {
  const std::uint64_t count = header.section_count;
  const std::uint64_t table_end = sizeof header + aligned(count * sizeof(std::uint64_t));
  bool fits = count <= kMaxSections && table_end <= bytes.size();
  std::vector<Section> sections;
  std::uint64_t offset = table_end;
  for (std::uint64_t i = 0; fits && i < count; ++i) {
    std::uint64_t size = 0;
    std::memcpy(&size, &bytes[sizeof header + i * sizeof size], sizeof size);
    fits = size <= bytes.size() - offset && aligned(size) <= bytes.size() - offset;
    if (fits) sections.push_back(bytes.subspan(offset, size));
    offset += aligned(size);
  }
  if (!fits || offset != bytes.size()) refuse(path, "damaged: its sections do not fit into it");
  return sections;
}

}  // namespace

void write_sealed_file(const std::string& path, const SealedKind& kind,
                       std::span<const Section> sections, Durable durable) {
  if (sections.size() > kMaxSections) {
    throw Error(ErrorKind::failed, fmt::format("cannot write {}: {} sections, and at most {} fit",
                                               path, sections.size(), kMaxSections));
  }
  std::vector<std::uint64_t> sizes;
  for (const Section& section : sections) sizes.push_back(section.size());
  const Header header = sealed_header(kind, sizes, sections);
  PendingFile file(path);
  for_each_section(header, sizes, sections, [&](Section section) {
    file.write(reinterpret_cast<const char*>(section.data()), section.size());
  });
  file.close(durable);
  try {
    open_sealed_file(file.temporary_path(), kind);
  } catch (const Error&) {
    file.fail("what was read back differs from what was written");
  }
  file.commit();
}

void write_sealed_file(const std::string& path, const SealedKind& kind,
                       std::initializer_list<Section> sections, Durable durable) {
  write_sealed_file(path, kind, std::span(sections.begin(), sections.size()), durable);
}

SealedFile open_sealed_file(const std::string& path, const SealedKind& kind) {
  SealedFile file;
  Mapping mapping = map_file(path);
  const Header header = read_header(path, kind, mapping.bytes);
  check_checksum(path, header, mapping.bytes);
  file.sections_ = split(path, header, mapping.bytes);
  file.mapping_ = std::move(mapping.memory);
  file.path_ = path;
  return file;
}

Section SealedFile::section(std::size_t index) const { return section_of(index, 1); }

Section SealedFile::section_of(std::size_t index, std::size_t value_bytes) const {
  if (index >= sections_.size() || sections_[index].size() % value_bytes != 0) {
    refuse(path_, fmt::format("its section {} is not what this program expects", index));
  }
  return sections_[index];
}

}  // namespace dapple
