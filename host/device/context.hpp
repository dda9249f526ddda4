// One OpenCL device with one in-order queue. In: host data, kernel names and arguments. Out:
// buffers, launches, and the device seconds of each pass. host/passes uses OpenCL through this
// file alone; OpenCL's own types stay in context.cpp.
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

/// Device memory. Copies share it; the last one frees it.
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

/// A buffer's contents, for the host to read: the device's own memory when host and device share
/// it, else a copy. No kernel may write to the buffer while a view of it lives.
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

/// A kernel argument: a buffer, or a struct or number by value. It points to the original, which
/// must live until the launch is enqueued.
struct KernelArgument {
  KernelArgument(const Buffer& b) : buffer(&b) {}  // NOLINT: implicit, so that calls read as lists
  template <class T>
  requires std::is_trivially_copyable_v<T> KernelArgument(const T& v)
      : value(&v), size(sizeof v) {}  // NOLINT
  const Buffer* buffer = nullptr;
  const void* value = nullptr;
  std::size_t size = 0;
};

/// The -D options that a program is compiled with: few of them, integers only.
struct Variant {
  bool prefiltered = false;
  bool shared_origin = false;  ///< the rays of a packet share their origin
  [[nodiscard]] std::string options() const;
  auto operator<=>(const Variant&) const = default;
};

/// Kernel `name` of kernels/`name`.cl unless `file` says otherwise.
struct KernelName {
  std::string name;
  std::string file;
  Variant variant;
  /// Path below kernels/: "occlusion/packet.cl".
  [[nodiscard]] std::string source_file() const { return (file.empty() ? name : file) + ".cl"; }
  auto operator<=>(const KernelName&) const = default;
};

/// How far kernels are compiled: programs only, which shows whether they compile at all, or also
/// the machine code that PoCL makes of each kernel at its first launch.
enum class CompileTo { programs, machine_code };

class DeviceContext {
 public:
  DeviceContext(const std::string& name, std::string kernel_dir,
                Packets packets = Packets::automatic);
  ~DeviceContext();
  /// Keeps the kernels that were compiled so far for later processes, as the destructor does.
  void keep_compiled() const;
  DeviceContext(const DeviceContext&) = delete;
  DeviceContext& operator=(const DeviceContext&) = delete;

  [[nodiscard]] const DeviceInfo& info() const;
  /// The constructor's `name`, which chose the device, and its folder of kernel sources.
  [[nodiscard]] const std::string& chosen_by() const;
  [[nodiscard]] const std::string& kernel_dir() const;
  /// Whether device and host share one memory; share() makes no copies then.
  [[nodiscard]] bool shares_memory() const;
  /// The ray packets that the device was opened with.
  [[nodiscard]] Packets packets() const;
  /// Notes for the user, one line each: "compiled kernels are not kept: ...".
  [[nodiscard]] std::vector<std::string> notes() const;

  /// Uninitialized memory, rounded up to whole cache lines. Memory that the host shares keeps its
  /// pages for later buffers of that size. Throws Error device.
  Buffer allocate(std::size_t bytes);
  /// The same, full of zeros.
  Buffer allocate_zeros(std::size_t bytes);
  /// A buffer for kernels to read, with a copy of host data. When device and host share memory,
  /// it uses `data` itself, which must then outlive the buffer unmoved.
  Buffer share(const void* data, std::size_t bytes);
  /// Waits until the data is copied. `offset`: bytes into the buffer.
  void write(const Buffer& buffer, const void* data, std::size_t bytes, std::size_t offset = 0);
  /// Waits for all launches before it. `offset`: bytes into the buffer.
  void read(const Buffer& buffer, void* data, std::size_t bytes, std::size_t offset = 0);

  /// Waits for all launches before it.
  HostView view(const Buffer& buffer);

  /// Lets the host write to the memory that it shares with the device in `buffer`. This ends with
  /// the last copy of the returned pointer; no kernel may read the buffer until then. Returns null
  /// when the buffer is not in shared memory. Waits for all launches before it.
  std::shared_ptr<void> lend(const Buffer& buffer);

  /// Compiles a kernel ahead of its first launch.
  void prepare(const KernelName& kernel);
  /// Whether other processes can reuse kernels that this one compiles: true on PoCL when the kernel
  /// cache has a folder to keep them in.
  [[nodiscard]] bool keeps_compiled() const;
  /// Whether the kernel's program is compiled in this context, or the kernel is in the kernel
  /// cache, compiled as far as `to`. Throws Error failed when its source cannot be read.
  [[nodiscard]] bool is_compiled(const KernelName& kernel, CompileTo to) const;
  /// From now on a launch of 0 items runs one work-group, which finds no work, instead of none:
  /// drivers finish compiling a kernel at its first launch.
  void warm_up();
  /// Maximum number of work-items in a work-group of the kernel on this device.
  std::size_t largest_group(const KernelName& kernel);
  /// Enqueues `items` work-items, rounded up to whole work-groups of `group`, so kernels must check
  /// bounds. `label` names the pass in pass_seconds().
  void launch(const KernelName& name, const std::string& label, std::size_t items,
              const std::vector<KernelArgument>& arguments, std::size_t group = 64);
  /// Enqueues enough work-items to occupy the device. They share the work by tickets, of which
  /// there are `ticket_count`, below 2^31: take_ticket() in kernels/vectors/tickets.clh. Adds three
  /// arguments after the kernel's own: tickets, first_ticket and ticket_count.
  void launch_with_tickets(const KernelName& name, const std::string& label,
                           std::size_t ticket_count, std::vector<KernelArgument> arguments,
                           std::size_t group = 64);
  /// Number of work-groups that launch_with_tickets() starts for so many tickets.
  [[nodiscard]] std::size_t groups_with_tickets(std::size_t ticket_count) const;
  /// Waits for all launches and adds their times to pass_seconds(). Throws Error device.
  void finish();
  /// Waits for all launches, and ignores errors.
  void wait() noexcept;

  /// Device seconds of all finished launches, by label.
  [[nodiscard]] const std::map<std::string, double>& pass_seconds() const;

 private:
  /// Throws Error device where PoCL would have to link the kernel and cannot.
  void require_linker_for(const KernelName& kernel) const;
  struct State;
  /// A buffer of `bytes` that uses `pages`, which hold at least as many.
  Buffer on_pages(std::unique_ptr<Pages> pages, std::size_t bytes);
  /// Maps the buffer, which must be in the host's memory. The last copy unmaps it.
  std::shared_ptr<void> map(const Buffer& buffer, bool writes);

  std::unique_ptr<State> state_;
};

}  // namespace dapple
