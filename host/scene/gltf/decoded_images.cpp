#include "scene/gltf/decoded_images.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "dapple/error.hpp"
#include "scene/gltf/document/uri.hpp"

namespace dapple::gltf {
namespace {

/// The limit of the pixels that are decoded at a time, unless one image alone has more: a quarter
/// of a gigabyte.
constexpr std::uint64_t kMaxAhead = std::uint64_t{1} << 26;

}  // namespace

ImageBytes read_image(const Document& document, int image, const std::string& what) {
  const ImageSource& source = document.images[static_cast<std::size_t>(image)];
  ImageBytes result;
  if (source.buffer_view >= 0) {
    result.bytes = view_bytes(document, source.buffer_view);
    return result;
  }
  result.owned = is_data_uri(source.uri)
                     ? decode_data_uri(source.uri, what)
                     : read_regular_file(resolve_uri(document.base, source.uri, what), what);
  result.bytes = result.owned;
  return result;
}

const ColorImage& DecodedImages::get(int image, const std::string& what) {
  if (image == last_image_) return last_;
  last_image_ = -1;
  if (!ahead_.contains(image)) decode_ahead(image);
  if (const auto found = ahead_.find(image); found != ahead_.end()) {
    last_ = std::move(found->second);
    ahead_.erase(found);
  } else {
    last_ = decode(read_image(document_, image, what).bytes, what);
  }
  last_image_ = image;
  return last_;
}

ColorImage DecodedImages::take(int image, const std::string& what) {
  get(image, what);
  last_image_ = -1;
  return std::move(last_);
}

ColorImage DecodedImages::decode(std::span<const std::uint8_t> bytes,
                                 const std::string& what) const {
  if (with_colors_) return decode_color(bytes, what);
  AlphaImage alpha = decode_alpha(bytes, what);
  return {alpha.width, alpha.height, {}, std::move(alpha.alpha)};
}

void DecodedImages::decode_ahead(int image) {
  const auto first = std::find(expected_.begin(), expected_.end(), image);
  if (first == expected_.end()) return;
  const auto most = static_cast<std::ptrdiff_t>(tbb::this_task_arena::max_concurrency());
  const auto end = first + std::min(most, expected_.end() - first);
  std::vector<std::pair<int, ImageBytes>> batch;
  std::uint64_t pixels = 0;
  auto next = first;
  for (; next != end; ++next) {
    ImageBytes file;
    try {
      file = read_image(document_, *next, "");
    } catch (const Error&) {
      continue;  // get() throws it
    }
    pixels += pixel_count(file.bytes);
    if (pixels > kMaxAhead && !batch.empty()) break;
    batch.emplace_back(*next, std::move(file));
  }
  expected_.erase(expected_.begin(), next);
  if (batch.size() < 2) return;
  std::vector<std::optional<ColorImage>> contents(batch.size());
  tbb::parallel_for(std::size_t{0}, batch.size(), [&](std::size_t i) {
    try {
      contents[i] = decode(batch[i].second.bytes, "");
    } catch (const Error&) {  // get() throws it
    }
  });
  for (std::size_t i = 0; i < batch.size(); ++i)
    if (contents[i]) ahead_.emplace(batch[i].first, std::move(*contents[i]));
}

}  // namespace dapple::gltf
