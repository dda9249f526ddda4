#include "device/context.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "device/driver_needs.hpp"
#include "device/environment_while.hpp"
#include "device/lent_pages.hpp"
#include "device/opencl.hpp"
#include "device/page_pool.hpp"
#include "device/platforms.hpp"
#include "device/programs/kernel_cache.hpp"
#include "device/programs/kernel_source.hpp"
#include "device/staged_read.hpp"

namespace dapple {
namespace {

/// Number of launches after which their events are collected: a long render must not hold many.
constexpr std::size_t kEventsHeld = 256;

/// Maximum number of work-groups of a compute unit that take tickets. PoCL's first threads take
/// many work-groups at once; with so many, each of its threads still gets one.
constexpr std::size_t kGroupsTakingTickets = 32;

/// Tickets are counted modulo 2^32. The count begins here, so that it overflows early in every
/// process, not only in long renders.
constexpr cl_uint kFirstTicket = 0xfffff000u;

/// The pattern that buffers are cleared with. PoCL stores one pattern after the other, so a
/// pattern of one byte would be slow (experiment 701).
constexpr cl_ulong8 kZeros{};

/// `bytes`, rounded up to whole patterns, at least one.
std::size_t whole_patterns(std::size_t bytes) {
  const std::size_t patterns = (bytes + sizeof kZeros - 1) / sizeof kZeros;
  return std::max<std::size_t>(patterns, 1) * sizeof kZeros;
}

std::string first_lines(const std::string& text, int count) {
  std::size_t end = 0;
  for (int i = 0; i < count && end != std::string::npos; ++i) end = text.find('\n', end + 1);
  return text.substr(0, end);
}

/// A context whose compiler does not run several work-items in the lanes of a vector. The kernels
/// are vectors already: Intel's compiler took five to eight times as long (experiment 732). It
/// reads the variable here; if the user has set it, that stays.
cl::Context make_context(const cl::Device& device) {
  const char* const kVectorizer = "CL_CONFIG_CPU_VECTORIZER_MODE";
  const EnvironmentWhile off(kVectorizer, std::getenv(kVectorizer) ? "" : "1");
  return cl::Context(device);
}

/// Returns the result of clBuildProgram(). When memory runs out, LLVM throws an exception through
/// PoCL's C code, which then keeps its locks: the next call of PoCL would never return. Therefore
/// `noexcept` ends the process.
cl_int compile(const cl::Program& program, const cl::Device& device,
               const std::string& options) noexcept {
  return clBuildProgram(program(), 1, &device(), options.c_str(), nullptr, nullptr);
}

}  // namespace

struct Buffer::Memory {
  cl::Buffer buffer;
  bool on_host = false;  ///< uses the host's memory, and may be mapped
};

struct DeviceContext::State {
  DriverInUse driver_in_use;
  DeviceInfo info;
  std::string chosen_by;
  std::string kernel_dir;
  Packets packets = Packets::automatic;
  cl::Device device;
  bool shares_memory = false;  ///< device and host share one memory
  std::shared_ptr<PagePool> page_pool = std::make_shared<PagePool>();
  cl::Context context;
  cl::CommandQueue queue;
  std::unique_ptr<StagedRead> staged_read;  ///< made when it is needed
  std::map<std::pair<std::string, Variant>, cl::Program> programs;
  std::map<std::tuple<std::string, std::string, Variant>, cl::Kernel> kernels;
  std::vector<std::string> known_programs;  ///< texts that name them in KernelCache
  std::vector<std::pair<std::string, cl::Event>> events;
  std::map<std::string, double> pass_seconds;
  Buffer tickets;  ///< counter; empty before the first launch and after a failed one
  cl_uint next_ticket = kFirstTicket;
  bool warming_up = false;

  /// For the compiler; dapple/shared/language.h says what functions are static for.
  [[nodiscard]] std::string options(const Variant& variant) const {
    const bool has_static_functions = packets == Packets::scalar || info.kind != "CPU";
    return variant.options() + (has_static_functions ? " -DDAPPLE_STATIC_FUNCTIONS" : "");
  }
  /// The text that names a program of that source in KernelCache.
  [[nodiscard]] std::string known_by(const std::string& source, const Variant& variant) const;
  cl::Program& program(const std::string& file, const Variant& variant);
  [[nodiscard]] bool has(const KernelName& name) const {
    return kernels.contains({name.source_file(), name.name, name.variant});
  }
  cl::Kernel& kernel(const KernelName& name);
  void collect_events();
};

std::string Variant::options() const {
  return fmt::format("-cl-std=CL1.2 -w -DDAPPLE_PREFILTERED={} -DDAPPLE_SHARED_ORIGIN={}",
                     prefiltered ? 1 : 0, shared_origin ? 1 : 0);
}

std::string DeviceContext::State::known_by(const std::string& source,
                                           const Variant& variant) const {
  return fmt::format("{}\n{}\n{}\n{}\n{}", info.platform, info.driver, info.name, options(variant),
                     source);
}

cl::Program& DeviceContext::State::program(const std::string& file, const Variant& variant) {
  const auto key = std::pair(file, variant);
  if (const auto found = programs.find(key); found != programs.end()) return found->second;
  const std::string source = expand_kernel(file, kernel_dir);
  const std::string known = known_by(source, variant);
  cl::Program built(context, source);
  cl_int result = CL_SUCCESS;
  KernelCache::of_process().build(known,
                                  [&] { result = compile(built, device, options(variant)); });
  if (result != CL_SUCCESS) {
    const auto log = built.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
    std::string shortage = KernelCache::of_process().shortage();  // others fill disks, too
    if (!shortage.empty()) shortage.insert(0, "; ");
    throw Error(ErrorKind::device,
                fmt::format("{}: the OpenCL compiler of {} rejected it ({}{}):\n{}", file,
                            info.name, opencl_error_name(result), shortage, first_lines(log, 12)));
  }
  known_programs.push_back(known);
  return programs.emplace(key, built).first->second;
}

cl::Kernel& DeviceContext::State::kernel(const KernelName& name) {
  const std::string file = name.source_file();
  const auto key = std::tuple(file, name.name, name.variant);
  if (const auto found = kernels.find(key); found != kernels.end()) return found->second;
  return kernels.emplace(key, cl::Kernel(program(file, name.variant), name.name.c_str()))
      .first->second;
}

void DeviceContext::State::collect_events() {
  for (auto& [label, event] : events) {
    const auto begin = event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
    const auto end = event.getProfilingInfo<CL_PROFILING_COMMAND_END>();
    pass_seconds[label] += static_cast<double>(end - begin) * 1e-9;
  }
  events.clear();
}

DeviceContext::DeviceContext(const std::string& name, std::string kernel_dir, Packets packets)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.chosen_by = name;
  s.kernel_dir = std::move(kernel_dir);
  if (!s.kernel_dir.empty() && !std::filesystem::is_directory(s.kernel_dir))
    throw Error(ErrorKind::usage, "--kernel-dir " + s.kernel_dir + ": there is no such folder");
  s.packets = packets;
  s.device = choose_device(name);
  s.info = describe(s.device);
  in_opencl("opening " + s.info.name, [&] {
    // GPUs may have the host's memory, too, but their drivers may copy what the host allocated.
    s.shares_memory =
        (s.device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0 && !has_own_memory(s.device);
    s.context = make_context(s.device);
    s.queue = cl::CommandQueue(s.context, s.device, CL_QUEUE_PROFILING_ENABLE);
  });
}

// Kernels are compiled when they are first launched, not before.
DeviceContext::~DeviceContext() { keep_compiled(); }

void DeviceContext::keep_compiled() const {
  for (const std::string& program : state_->known_programs) KernelCache::of_process().keep(program);
}

const DeviceInfo& DeviceContext::info() const { return state_->info; }

const std::string& DeviceContext::chosen_by() const { return state_->chosen_by; }

const std::string& DeviceContext::kernel_dir() const { return state_->kernel_dir; }

bool DeviceContext::shares_memory() const { return state_->shares_memory; }

Packets DeviceContext::packets() const { return state_->packets; }

std::vector<std::string> DeviceContext::notes() const {
  const std::string& refusals = KernelCache::of_process().refusals();
  if (refusals.empty()) return {};
  return {"compiled kernels are not kept: " + refusals};
}

Buffer DeviceContext::on_pages(std::unique_ptr<Pages> pages, std::size_t bytes) {
  auto memory = std::make_shared<Buffer::Memory>();
  memory->buffer = cl::Buffer(state_->context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR,
                              pages->bytes(), pages->data());
  hand_over(std::move(pages), memory->buffer, state_->page_pool);
  memory->on_host = true;
  return Buffer(std::move(memory), bytes);
}

Buffer DeviceContext::allocate(std::size_t bytes) {
  return in_opencl(fmt::format("allocating {} bytes on {}", bytes, state_->info.name), [&] {
    const std::size_t size = whole_patterns(bytes);
    if (state_->shares_memory) return on_pages(state_->page_pool->take(size), bytes);
    auto memory = std::make_shared<Buffer::Memory>();
    memory->buffer = cl::Buffer(state_->context, CL_MEM_READ_WRITE, size);
    return Buffer(std::move(memory), bytes);
  });
}

Buffer DeviceContext::share(const void* data, std::size_t bytes) {
  if (bytes == 0) return allocate(0);
  return in_opencl(fmt::format("uploading {} bytes to {}", bytes, state_->info.name), [&] {
    const cl_mem_flags placing = state_->shares_memory ? CL_MEM_USE_HOST_PTR : CL_MEM_COPY_HOST_PTR;
    auto memory = std::make_shared<Buffer::Memory>();
    // OpenCL takes a mutable pointer, but only reads through it because of CL_MEM_READ_ONLY.
    memory->buffer =
        cl::Buffer(state_->context, CL_MEM_READ_ONLY | placing, bytes, const_cast<void*>(data));
    memory->on_host = state_->shares_memory;
    return Buffer(std::move(memory), bytes);
  });
}

Buffer DeviceContext::allocate_zeros(std::size_t bytes) {
  if (!state_->shares_memory) {
    Buffer buffer = allocate(bytes);
    in_opencl("clearing a buffer", [&] {
      state_->queue.enqueueFillBuffer(buffer.memory()->buffer, kZeros, 0, whole_patterns(bytes));
    });
    return buffer;
  }
  return in_opencl(fmt::format("allocating {} bytes on {}", bytes, state_->info.name), [&] {
    return on_pages(state_->page_pool->take_zeros(whole_patterns(bytes)), bytes);
  });
}

std::shared_ptr<void> DeviceContext::map(const Buffer& buffer, bool writes) {
  const cl::Buffer& memory = buffer.memory()->buffer;
  const cl_map_flags access = writes ? CL_MAP_READ | CL_MAP_WRITE : CL_MAP_READ;
  void* data = state_->queue.enqueueMapBuffer(memory, CL_TRUE, access, 0, buffer.bytes());
  return {data, [queue = state_->queue, buffer](void* mapped) {
            try {
              queue.enqueueUnmapMemObject(buffer.memory()->buffer, mapped);
            } catch (const cl::Error&) {  // the memory is freed anyway
            }
          }};
}

HostView DeviceContext::view(const Buffer& buffer) {
  if (!buffer.bytes()) return {};
  if (!buffer.memory()->on_host) {
    std::shared_ptr<Pages> copy(state_->page_pool->take(buffer.bytes()).release(),
                                [pool = state_->page_pool](Pages* pages) {
                                  pool->give_back(std::unique_ptr<Pages>(pages));
                                });
    in_opencl("reading from the device", [&] {
      if (!state_->staged_read)
        state_->staged_read = std::make_unique<StagedRead>(state_->context, state_->queue);
      state_->staged_read->read(buffer.memory()->buffer, copy->data(), buffer.bytes());
    });
    return {copy, {static_cast<const std::byte*>(copy->data()), buffer.bytes()}};
  }
  return in_opencl("reading from the device", [&] {
    const std::shared_ptr<void> mapped = map(buffer, false);
    return HostView(mapped, {static_cast<const std::byte*>(mapped.get()), buffer.bytes()});
  });
}

std::shared_ptr<void> DeviceContext::lend(const Buffer& buffer) {
  if (!buffer.bytes() || !buffer.memory()->on_host) return nullptr;
  return in_opencl("writing to shared memory", [&] { return map(buffer, true); });
}

void DeviceContext::write(const Buffer& buffer, const void* data, std::size_t bytes,
                          std::size_t offset) {
  if (bytes == 0) return;
  in_opencl("writing to the device", [&] {
    state_->queue.enqueueWriteBuffer(buffer.memory()->buffer, CL_TRUE, offset, bytes, data);
  });
}

void DeviceContext::read(const Buffer& buffer, void* data, std::size_t bytes, std::size_t offset) {
  if (bytes == 0) return;
  in_opencl("reading from the device", [&] {
    state_->queue.enqueueReadBuffer(buffer.memory()->buffer, CL_TRUE, offset, bytes, data);
  });
}

void DeviceContext::require_linker_for(const KernelName& kernel) const {
  if (state_->info.platform != kPoclPlatform || state_->has(kernel)) return;
  if (!is_compiled(kernel, CompileTo::machine_code)) require_linker();
}

void DeviceContext::prepare(const KernelName& kernel) {
  require_linker_for(kernel);
  in_opencl("compiling kernel " + kernel.name, [&] { state_->kernel(kernel); });
}

bool DeviceContext::keeps_compiled() const {
  return state_->info.platform == kPoclPlatform && KernelCache::of_process().keeps();
}

bool DeviceContext::is_compiled(const KernelName& kernel, CompileTo to) const {
  const std::string file = kernel.source_file();
  if (state_->programs.contains({file, kernel.variant})) return true;
  const std::string source = expand_kernel(file, state_->kernel_dir);
  return KernelCache::of_process().has(state_->known_by(source, kernel.variant),
                                       to == CompileTo::machine_code ? kernel.name : "");
}

void DeviceContext::warm_up() { state_->warming_up = true; }

std::size_t DeviceContext::largest_group(const KernelName& kernel) {
  require_linker_for(kernel);
  return in_opencl("compiling kernel " + kernel.name, [&]() -> std::size_t {
    cl::Kernel& compiled = state_->kernel(kernel);
    // Mesa says 32 of every kernel, and launches larger work-groups.
    if (state_->info.platform == kMesaPlatform)
      return state_->device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
    return compiled.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(state_->device);
  });
}

void DeviceContext::launch(const KernelName& name, const std::string& label, std::size_t items,
                           const std::vector<KernelArgument>& arguments, std::size_t group) {
  if (items == 0 && !state_->warming_up) return;
  require_linker_for(name);
  in_opencl("running pass " + label, [&] {
    cl::Kernel& kernel = state_->kernel(name);
    cl_uint index = 0;
    for (const KernelArgument& argument : arguments) {
      if (argument.buffer && argument.buffer->memory()) {
        kernel.setArg(index++, argument.buffer->memory()->buffer);
      } else if (argument.buffer) {
        kernel.setArg(index++, sizeof(cl_mem), nullptr);  // the kernel does not read it
      } else {
        kernel.setArg(index++, argument.size, argument.value);
      }
    }
    cl::Event event;
    state_->queue.enqueueNDRangeKernel(
        kernel, cl::NullRange, cl::NDRange(std::max(items + group - 1, group) / group * group),
        cl::NDRange(group), nullptr, &event);
    state_->events.emplace_back(label, event);
  });
  if (state_->events.size() >= kEventsHeld) finish();
}

std::size_t DeviceContext::groups_with_tickets(std::size_t ticket_count) const {
  return std::min(ticket_count, kGroupsTakingTickets * state_->info.compute_units);
}

void DeviceContext::launch_with_tickets(const KernelName& name, const std::string& label,
                                        std::size_t ticket_count,
                                        std::vector<KernelArgument> arguments, std::size_t group) {
  State& s = *state_;
  if (ticket_count == 0 && !s.warming_up) return;
  // If anything throws from here on, the next launch makes a new counter.
  Buffer tickets = std::exchange(s.tickets, {});
  if (!tickets.bytes()) {
    tickets = allocate(sizeof s.next_ticket);
    s.next_ticket = kFirstTicket;
    write(tickets, &s.next_ticket, sizeof s.next_ticket);
  }
  const std::size_t groups = std::max<std::size_t>(groups_with_tickets(ticket_count), 1);
  const auto count = static_cast<cl_uint>(ticket_count);
  arguments.insert(arguments.end(), {tickets, s.next_ticket, count});
  launch(name, label, groups * group, arguments, group);
  // The launch takes all tickets, and each work-item one more, beyond the last ticket.
  s.next_ticket += static_cast<cl_uint>(ticket_count + groups * group);
  s.tickets = std::move(tickets);
}

void DeviceContext::finish() {
  in_opencl("waiting for " + state_->info.name, [&] {
    state_->queue.finish();
    state_->collect_events();
  });
}

void DeviceContext::wait() noexcept { clFinish(state_->queue()); }

const std::map<std::string, double>& DeviceContext::pass_seconds() const {
  return state_->pass_seconds;
}

}  // namespace dapple
