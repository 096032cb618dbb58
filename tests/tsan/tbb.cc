// What the thread sanitizer must know of TBB, whose library is not instrumented: that a task sees
// what was done before it was spawned, that who waits sees what the tasks did, and that TBB's own
// allocator hands memory on from one thread to another. TBB's entry points are defined here in
// front of the library's, so that nothing of ours needs to be suppressed.
#include <dlfcn.h>
#include <oneapi/tbb/detail/_small_object_pool.h>
#include <oneapi/tbb/detail/_task.h>
#include <oneapi/tbb/parallel_for.h>
#include <sanitizer/tsan_interface.h>

#include <cstdlib>
#include <new>

namespace tbb::detail {
namespace {

// The library's own function of that mangled name.
template <class Function>
Function* library(const char* name) {
  void* const found = dlsym(RTLD_NEXT, name);
  if (!found) std::abort();
  return reinterpret_cast<Function*>(found);
}

// Stands in for a task that another thread may run.
class Announced : public d1::task {
 public:
  explicit Announced(d1::task& real) : real_(real) {}
  task* execute(d1::execution_data& data) override { return run(&task::execute, data); }
  task* cancel(d1::execution_data& data) override { return run(&task::cancel, data); }

 private:
  // Where it throws, TBB cancels it next.
  task* run(task* (task::*what)(d1::execution_data&), d1::execution_data& data) {
    __tsan_acquire(this);
    task* const next = (real_.*what)(data);
    delete this;
    return next;
  }
  d1::task& real_;
};

Announced& announce(d1::task& task) {
  auto* const announced = new Announced(task);
  __tsan_release(announced);
  return *announced;
}

void* allocateBytes(std::size_t size) {
  void* const found = std::aligned_alloc(128, (size + 127) / 128 * 128);
  if (!found) throw std::bad_alloc();
  return found;
}

// The counter that a wait_context is released through (by instrumented code of the headers).
void acquireFrom(d1::wait_context& context) {
  static_assert(sizeof(d1::wait_context) == 16, "its counter is the second word");
  __tsan_acquire(reinterpret_cast<char*>(&context) + 8);
}

}  // namespace

namespace r1 {

void __TBB_EXPORTED_FUNC spawn(d1::task& task, d1::task_group_context& context) {
  static auto* const real = library<void(d1::task&, d1::task_group_context&)>(
      "_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextE");
  real(announce(task), context);
}

void __TBB_EXPORTED_FUNC spawn(d1::task& task, d1::task_group_context& context, d1::slot_id slot) {
  static auto* const real = library<void(d1::task&, d1::task_group_context&, d1::slot_id)>(
      "_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextEt");
  real(announce(task), context, slot);
}

void __TBB_EXPORTED_FUNC execute_and_wait(d1::task& task, d1::task_group_context& context,
                                          d1::wait_context& wait,
                                          d1::task_group_context& waitContext) {
  static auto* const real =
      library<void(d1::task&, d1::task_group_context&, d1::wait_context&, d1::task_group_context&)>(
          "_ZN3tbb6detail2r116execute_and_waitERNS0_2d14taskERNS2_18task_group_contextERNS2_12wait_"
          "contextES6_");
  try {
    real(task, context, wait, waitContext);
  } catch (...) {
    acquireFrom(wait);
    throw;
  }
  acquireFrom(wait);
}

void __TBB_EXPORTED_FUNC wait(d1::wait_context& wait, d1::task_group_context& context) {
  static auto* const real = library<void(d1::wait_context&, d1::task_group_context&)>(
      "_ZN3tbb6detail2r14waitERNS0_2d112wait_contextERNS2_18task_group_contextE");
  try {
    real(wait, context);
  } catch (...) {
    acquireFrom(wait);
    throw;
  }
  acquireFrom(wait);
}

// The sanitizer follows memory through malloc and free.
void* __TBB_EXPORTED_FUNC allocate(d1::small_object_pool*&, std::size_t size,
                                   const d1::execution_data&) {
  return allocateBytes(size);
}
void* __TBB_EXPORTED_FUNC allocate(d1::small_object_pool*&, std::size_t size) {
  return allocateBytes(size);
}
void __TBB_EXPORTED_FUNC deallocate(d1::small_object_pool&, void* at, std::size_t,
                                    const d1::execution_data&) {
  std::free(at);
}
void __TBB_EXPORTED_FUNC deallocate(d1::small_object_pool&, void* at, std::size_t) {
  std::free(at);
}
void* __TBB_EXPORTED_FUNC cache_aligned_allocate(std::size_t size) { return allocateBytes(size); }
void __TBB_EXPORTED_FUNC cache_aligned_deallocate(void* at) { std::free(at); }
// NOLINTBEGIN(readability-identifier-naming)
void* __TBB_EXPORTED_FUNC allocate_memory(std::size_t size) { return allocateBytes(size); }
void __TBB_EXPORTED_FUNC deallocate_memory(void* at) { std::free(at); }
// NOLINTEND(readability-identifier-naming)

}  // namespace r1
}  // namespace tbb::detail
