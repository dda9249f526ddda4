// Makes oneTBB's hand-offs of tasks visible to ThreadSanitizer. Debian's libtbb is not
// instrumented, so every result of a parallel loop looks like a race. Suppressing libtbb's frames
// would also hide our own races, because libtbb is at the bottom of every worker's stack. These
// functions are linked into the tested programs; they replace libtbb's entry points and call them.
#include <dlfcn.h>
#include <oneapi/tbb/detail/_task.h>
#include <sanitizer/tsan_interface.h>

#include <cstdlib>
#include <new>

namespace tbb::detail {
namespace {

template <typename Function>
Function* in_libtbb(const char* symbol) {
  void* const found = dlsym(RTLD_NEXT, symbol);
  if (!found) std::abort();
  return reinterpret_cast<Function*>(found);
}

/// Wraps a spawned task: all that its creator did happens before its execution.
class HandedOff final : public d1::task {
 public:
  explicit HandedOff(d1::task& spawned) : spawned_(spawned) { __tsan_release(this); }

  d1::task* execute(d1::execution_data& data) override {
    __tsan_acquire(this);
    d1::task* const next = spawned_.execute(data);
    delete this;
    return next;
  }

  d1::task* cancel(d1::execution_data& data) override {
    __tsan_acquire(this);
    d1::task* const next = spawned_.cancel(data);
    delete this;
    return next;
  }

 private:
  d1::task& spawned_;
};

/// After libtbb has seen the count reach zero, this reads it again in instrumented code. So all
/// that the finished tasks did happens before what follows.
void join(d1::wait_context& finished) { finished.reserve(0); }

}  // namespace

namespace r1 {

void spawn(d1::task& task, d1::task_group_context& context) {
  using Spawn = void(d1::task&, d1::task_group_context&);
  static Spawn* const spawn_in_libtbb =
      in_libtbb<Spawn>("_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextE");
  spawn_in_libtbb(*new HandedOff(task), context);
}

void spawn(d1::task& task, d1::task_group_context& context, d1::slot_id slot) {
  using Spawn = void(d1::task&, d1::task_group_context&, d1::slot_id);
  static Spawn* const spawn_in_libtbb =
      in_libtbb<Spawn>("_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextEt");
  spawn_in_libtbb(*new HandedOff(task), context, slot);
}

void execute_and_wait(d1::task& task, d1::task_group_context& task_context, d1::wait_context& until,
                      d1::task_group_context& wait_context) {
  using ExecuteAndWait =
      void(d1::task&, d1::task_group_context&, d1::wait_context&, d1::task_group_context&);
  static ExecuteAndWait* const execute_and_wait_in_libtbb = in_libtbb<ExecuteAndWait>(
      "_ZN3tbb6detail2r116execute_and_waitERNS0_2d14taskERNS2_18task_group_contextERNS2_12wait_"
      "contextES6_");
  execute_and_wait_in_libtbb(task, task_context, until, wait_context);
  join(until);
}

void wait(d1::wait_context& until, d1::task_group_context& context) {
  using Wait = void(d1::wait_context&, d1::task_group_context&);
  static Wait* const wait_in_libtbb =
      in_libtbb<Wait>("_ZN3tbb6detail2r14waitERNS0_2d112wait_contextERNS2_18task_group_contextE");
  wait_in_libtbb(until, context);
  join(until);
}

// libtbb's pools pass memory between threads without the sanitizer's knowledge; it knows `new`.
// Callers only test whether there is a pool; nobody reads it.
void* allocate(d1::small_object_pool*& pool, std::size_t bytes) {
  static char no_pool;
  pool = reinterpret_cast<d1::small_object_pool*>(&no_pool);
  return ::operator new (bytes, std::align_val_t{d1::task_alignment});
}

void* allocate(d1::small_object_pool*& pool, std::size_t bytes, const d1::execution_data&) {
  return allocate(pool, bytes);
}

void deallocate(d1::small_object_pool&, void* object, std::size_t) {
  ::operator delete (object, std::align_val_t{d1::task_alignment});
}

void deallocate(d1::small_object_pool& pool, void* object, std::size_t bytes,
                const d1::execution_data&) {
  deallocate(pool, object, bytes);
}

}  // namespace r1
}  // namespace tbb::detail
