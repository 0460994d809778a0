// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/threads.hpp"
#include <nscdd/core/fields.hpp>
#include <nscdd/spectra/spectral_radius.hpp>

#include <pybind11/pybind11.h>

#include <atomic>
#include <exception>

namespace nscdd::python {

namespace py = pybind11;

/// Work of the library on behalf of a thread of Python. While it runs, other threads of Python go on: the interpreter
/// lock is not held. Now and then, some twenty times per second at the most, Python's signal handlers are run and
/// `progress` is told of units done. What either raises, such as KeyboardInterrupt, ends the work and is raised.
/// No handler of the process is changed.
class LongWork {
 public:
  /// `progress`: called with (units done, units in all), or None.
  explicit LongWork(py::object progress = py::none()) : progress_(std::move(progress)) {}
  LongWork(const LongWork&) = delete;
  LongWork& operator=(const LongWork&) = delete;

  /// For work that takes a Monitor. This object must outlive the work.
  Monitor monitor();

  /// For work without one: every factorisation and solve first checks whether to stop.
  InertiaMethod watched(InertiaMethod method);
  /// Both for spectra: the factorisations, and the checkpoints between products.
  SpectralOptions watched(SpectralOptions options);

  /// Whether the work is to go on, for what asks at every iteration.
  bool goes_on() {
    return !failed_ && (!is_time() || call([] {}));
  }

  /// Calls back to Python at once. False where that raised, or something did before.
  template <class Call>
  bool call(Call&& back) {
    if (failed_) return false;
    const py::gil_scoped_acquire acquired;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      back();
    } catch (...) {
      if (!failed_.exchange(true)) failure_ = std::current_exception();
    }
    return !failed_;
  }

  /// The result of the work, in at most `threads` threads (0: all of the machine). Throws what it throws, and Error for
  /// another number of threads than the command line takes.
  template <class Work>
  auto run(Index threads, Work&& work) {
    check_bounds(threads, Field{.minimum = 0, .maximum = 4096}, "threads");
    std::optional<std::invoke_result_t<Work>> result;
    {
      const py::gil_scoped_release released;
      const ThreadLimit limit(threads);
      try {
        result.emplace(work());
      } catch (const Ended&) {  // why is said below
      } catch (...) {
        if (!failed_) throw;  // else it met this on its way out
      }
    }
    if (failure_) std::rethrow_exception(failure_);
    return std::move(*result);
  }

 private:
  struct Ended {};
  bool goes_on(Index done, Index total);
  void require_going_on();
  bool is_time();

  py::object progress_;
  std::atomic<bool> failed_ = false;
  std::exception_ptr failure_;               // written with the interpreter lock, read after the work
  std::atomic<std::int64_t> last_check_{0};  // when, in milliseconds
};

/// Whether what a callback returned asks to stop: False, of Python or of NumPy.
inline bool asks_to_stop(const py::object& returned) {
  py::detail::make_caster<bool> truth;
  return truth.load(returned, false) && !static_cast<bool>(truth);
}

}  // namespace nscdd::python
