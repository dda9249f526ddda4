// One device, one in-order queue: buffers, kernels by file and name, timed launches. What
// host/wavefront sees of OpenCL; the OpenCL types stay in context.cpp.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "dapple/device.hpp"

namespace dapple {

class Pages;

/// Device memory; freed with the last copy.
class Buffer {
 public:
  struct Memory;
  Buffer() = default;
  Buffer(std::shared_ptr<Memory> memory, std::size_t bytes)
      : memory_(std::move(memory)), bytes_(bytes) {}
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] Memory* memory() const { return memory_.get(); }

 private:
  std::shared_ptr<Memory> memory_;
  std::size_t bytes_ = 0;
};

/// What a buffer holds, for the host to read: the device's own memory where both share one, else a
/// copy. No kernel may write to the buffer while a view of it lives.
class HostView {
 public:
  HostView() = default;
  HostView(std::shared_ptr<const void> keeper, std::span<const std::byte> bytes)
      : keeper_(std::move(keeper)), bytes_(bytes) {}
  template <class T>
  [[nodiscard]] std::span<const T> values() const {
    return {reinterpret_cast<const T*>(bytes_.data()), bytes_.size() / sizeof(T)};
  }

 private:
  std::shared_ptr<const void> keeper_;
  std::span<const std::byte> bytes_;
};

/// A kernel argument: a buffer, or a struct or number by value. It only points to what it is made
/// from, which must live until the launch is enqueued.
struct KernelArgument {
  KernelArgument(const Buffer& b) : buffer(&b) {}  // NOLINT: implicit, so that calls read as lists
  template <class T>
  requires std::is_trivially_copyable_v<T> KernelArgument(const T& v)
      : value(&v), size(sizeof v) {}  // NOLINT
  const Buffer* buffer = nullptr;
  const void* value = nullptr;
  std::size_t size = 0;
};

/// What a program is compiled for. Few of these, integers only.
struct Variant {
  bool prefiltered = false;
  bool shared_origin = false;  ///< rays traced together start from one point
  [[nodiscard]] std::string options() const;
  auto operator<=>(const Variant&) const = default;
};

/// Kernel `name` of kernels/`name`.cl unless `file` says otherwise.
struct KernelName {
  std::string name;
  std::string file;
  Variant variant;
  /// "packet.cl".
  [[nodiscard]] std::string source_file() const { return (file.empty() ? name : file) + ".cl"; }
  auto operator<=>(const KernelName&) const = default;
};

/// How far kernels are compiled: programs alone, which tells whether they can be, or to the machine
/// code that PoCL makes of each when it is first launched.
enum class CompileTo { programs, machine_code };

class DeviceContext {
 public:
  DeviceContext(const std::string& name, std::string kernel_dir,
                Packets packets = Packets::automatic);
  ~DeviceContext();
  DeviceContext(const DeviceContext&) = delete;
  DeviceContext& operator=(const DeviceContext&) = delete;

  [[nodiscard]] const DeviceInfo& info() const;
  /// What the device was chosen by, and where kernels are read, as the constructor got them.
  [[nodiscard]] const std::string& chosen_by() const;
  [[nodiscard]] const std::string& kernel_dir() const;
  /// With the host: share() makes no copies.
  [[nodiscard]] bool shares_memory() const;
  /// The ray packets that the device was opened with.
  [[nodiscard]] Packets packets() const;
  /// What users should know of how it works here: "compiled kernels are not kept: ...".
  [[nodiscard]] std::vector<std::string> notes() const;

  /// Uninitialized memory, rounded up to whole cache lines. Throws Error device. Where it is shared
  /// with the host, its pages are kept for later buffers of that size.
  Buffer allocate(std::size_t bytes);
  /// The same, full of zeros.
  Buffer allocate_zeros(std::size_t bytes);
  /// Read-only copy of host data; on devices that share memory with the host no copy is
  /// made and the data must stay where it is.
  Buffer share(const void* data, std::size_t bytes);
  /// `offset`: bytes into the buffer.
  void write(const Buffer& buffer, const void* data, std::size_t bytes, std::size_t offset = 0);
  /// Waits for all launches before it. `offset`: bytes into the buffer.
  void read(const Buffer& buffer, void* data, std::size_t bytes, std::size_t offset = 0);

  /// Waits for all launches before it.
  HostView view(const Buffer& buffer);

  /// While what it returns lives, the host may write to what it shares with the device by this
  /// buffer, and no kernel may read it; nothing where it shares none. Waits for all launches.
  std::shared_ptr<void> lend(const Buffer& buffer);

  /// Compiles a kernel ahead of its first launch.
  void prepare(const KernelName& kernel);
  /// Whether other processes get what is compiled here: PoCL's, if the kernel cache has a place.
  [[nodiscard]] bool keeps_compiled() const;
  /// Whether it has been compiled so far, here or for the kernel cache. Throws Error failed where
  /// its source cannot be read.
  [[nodiscard]] bool is_compiled(const KernelName& kernel, CompileTo to) const;
  /// From here on launches of nothing are of one group, which finds nothing to do: drivers compile
  /// some of a kernel when it is first launched.
  void warm_up();
  /// The most items a work-group of the kernel can have here.
  std::size_t largest_group(const KernelName& kernel);
  /// Enqueues `items` work-items, rounded up to whole groups of `group`: kernels check
  /// bounds. `label` names the pass in pass_seconds().
  void launch(const KernelName& name, const std::string& label, std::size_t items,
              const std::vector<KernelArgument>& arguments, std::size_t group = 64);
  /// Enqueues work-items enough to keep the device busy, which take tickets for `ticket_count`
  /// parts of the work, below 2^31, by tickets: take_ticket() of kernels/vectors/tickets.clh. Three
  /// arguments are added here.
  void launch_with_tickets(const KernelName& name, const std::string& label,
                           std::size_t ticket_count, std::vector<KernelArgument> arguments,
                           std::size_t group = 64);
  /// Number of work-groups that are launched for so many tickets.
  [[nodiscard]] std::size_t groups_with_tickets(std::size_t ticket_count) const;
  void finish();
  /// Waits like finish(), but whatever has become of the launches.
  void wait() noexcept;

  /// Device seconds of all finished launches, by label.
  [[nodiscard]] const std::map<std::string, double>& pass_seconds() const;

 private:
  struct State;
  /// A buffer of `bytes` on pages of at least as many.
  Buffer on_pages(std::unique_ptr<Pages> pages, std::size_t bytes);
  /// The buffer's memory, which must be on the host; unmapped with the last copy.
  std::shared_ptr<void> map(const Buffer& buffer, bool writes);

  std::unique_ptr<State> state_;
};

}  // namespace dapple
