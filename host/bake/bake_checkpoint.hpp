// The checkpoint of a bake: everything that was traced so far, in order. A bake takes the same
// samples each time, so that one that is resumed needs the rays of the later ones only. In: a
// function that traces samples. Out: one that first returns what is in a file, and then traces.
#pragma once

#include <string>
#include <vector>

#include "bake/samples/sample_tracer.hpp"
#include "dapple/render.hpp"
#include "render/render_settings.hpp"
#include "render/stopwatch.hpp"

namespace dapple {

class BakeCheckpoint {
 public:
  /// Files as `control` names them; neither: nothing is kept. Reads the file `control.resume`.
  /// Throws Error failed if it is damaged, usage if `settings` are not those that it was
  /// made with.
  BakeCheckpoint(const RenderControl& control, Settings settings);
  BakeCheckpoint(const BakeCheckpoint&) = delete;
  BakeCheckpoint& operator=(const BakeCheckpoint&) = delete;

  /// `trace`, but with results of the file as long as there are some. The checkpoint must outlive
  /// the function, and functions must be called one after the other, as in the first bake. They
  /// throw Error failed if the requested value is not the next in the file.
  TraceSamples with(TraceSamples trace);

  /// Writes the file if it is time, or `now`. After a failure, which failure() returns, the last
  /// file stays, and the bake goes on.
  void save(bool now);
  [[nodiscard]] const std::string& failure() const { return failure_; }

  /// The number of points whose values came from the file.
  [[nodiscard]] std::uint64_t points_read() const { return points_read_; }

 private:
  /// Of one call: how to find its values.
  struct Call {
    std::uint64_t first = 0;  ///< into values_
    std::uint64_t samples = 0, points = 0, rays = 0;
    std::uint32_t hash = 0, lights = 0;
    float largest = 0;
    std::uint32_t bent = 0;
  };

  void read();
  [[nodiscard]] TracedSamples replay(std::span<const SurfaceSample> samples, std::uint32_t hash);
  void record(std::span<const SurfaceSample> samples, std::uint32_t hash,
              const TracedSamples& found);

  const RenderControl& control_;
  Settings settings_;
  std::vector<Call> calls_;
  std::vector<float> values_;
  std::size_t next_ = 0, saved_ = 0;  ///< calls
  std::uint64_t points_read_ = 0;
  Stopwatch since_saved_;
  std::string failure_;
};

}  // namespace dapple
