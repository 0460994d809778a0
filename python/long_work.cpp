// SPDX-License-Identifier: GPL-3.0-or-later
#include "long_work.hpp"

#include <chrono>

namespace nscdd::python {

bool LongWork::is_time() {
  using namespace std::chrono;
  const std::int64_t now = duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
  if (now - last_check_ < 50) return false;
  last_check_ = now;
  return true;
}

bool LongWork::goes_on(Index done, Index total) {
  if (!is_time() && done < total) return !failed_;
  return call([&] {
    if (!progress_.is_none()) progress_(done, total);
  });
}

void LongWork::require_going_on() {
  if (!goes_on()) throw Ended{};
}

Monitor LongWork::monitor() {
  return [this](Index done, Index total) { return goes_on(done, total); };
}

InertiaMethod LongWork::watched(InertiaMethod method) {
  method.analyse = [this, analyse = std::move(method.analyse)](const InertiaPattern& pattern) {
    require_going_on();
    InertiaFamily family = analyse(pattern);
    family.factorise = [this, factorise = std::move(family.factorise)](const SparseMatrix& lower,
                                                                       const std::array<double, 2>& parameters) {
      require_going_on();
      InertiaFactor factor = factorise(lower, parameters);
      for (InertiaFactor::Solve* solve :
           {&factor.solve, &factor.solve_from_border, &factor.solve_to_border, &factor.solve_on_border})
        if (*solve)
          *solve = [this, inner = std::move(*solve)](const Vector& b) {
            require_going_on();
            return inner(b);
          };
      return factor;
    };
    return family;
  };
  return method;
}

SpectralOptions LongWork::watched(SpectralOptions options) {
  options.inertia = watched(std::move(options.inertia));
  options.checkpoint = [this] { require_going_on(); };
  return options;
}

}  // namespace nscdd::python
