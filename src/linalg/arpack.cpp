// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "core/memory.hpp"
#include "linalg/krylov.hpp"
#include "linalg/threads.hpp"

#include <arpack/arpack.hpp>

namespace nscdd {
namespace {

constexpr double fixed_share = 0.001;

std::mutex one_call_at_a_time;  // ARPACK's Fortran SAVE variables are shared by the whole process

// The same vector for the same size, in practice not orthogonal to any eigenvector.
Vector start_vector(Index n) {
  Vector v(n);
  std::uint64_t state = 0x9e3779b97f4a7c15ULL;
  for (Index i = 0; i < n; ++i) {  // splitmix64
    state += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    z ^= z >> 31;
    v[i] = static_cast<double>(z >> 11) * 0x1.0p-52 - 1.0;
  }
  return v;
}

a_int checked_size(Index n, Index basis) {
  if (n < arpack_smallest_size) fail("ARPACK: expected a problem of size >= {}, met {}", arpack_smallest_size, n);
  require_memory(bytes_of_matrix(n, std::min(n, basis) + 4), fmt::format("a basis of {} vectors", basis));
  return static_cast<a_int>(n);
}

// A reverse-communication run, in ARPACK's names; no other runs at the same time. Mode 2 is for symmetric problems.
struct Workspace {
  OneBlasThread serial_blas;
  a_int n, nev, ncv;
  std::lock_guard<std::mutex> lock{one_call_at_a_time};
  Vector resid, workd, workl;
  Matrix v;
  std::vector<a_int> select;
  a_int iparam[11] = {};
  a_int ipntr[14] = {};
  a_int lworkl, ido = 0, info = 1;  // info = 1: resid holds the start vector
  Workspace(Index size, Index wanted, const ArpackOptions& options, a_int mode)
      : n(checked_size(size, options.basis)),
        nev(static_cast<a_int>(std::min(wanted, size - 2))),
        ncv(static_cast<a_int>(std::min(size, std::max(options.basis, 2 * wanted + 3)))),
        resid(start_vector(size)),
        workd(Vector::Zero(3 * size)),
        workl(Vector::Zero(mode == 2 ? ncv * (ncv + 8) : 3 * ncv * ncv + 6 * ncv)),
        v(Matrix::Zero(size, ncv)),
        select(at(ncv), 0),
        lworkl(static_cast<a_int>(workl.size())) {
    iparam[0] = 1;  // exact shifts
    iparam[2] = static_cast<a_int>(options.maximum_restarts);
    iparam[3] = 1;
    iparam[6] = mode;
  }
  auto block(int which) { return workd.segment(ipntr[which] - 1, n); }
  bool any_converged() const { return info >= 0 && iparam[4] >= 1; }
};

}  // namespace

LanczosResult lanczos(Index n, const LinearMap& a, const LinearMap& m, const LinearMap& m_inverse, SpectrumEnd end,
                      const ArpackOptions& options, const Vector& start) {
  LanczosResult result;
  Workspace w(n, 1, options, 2);
  if (start.size() == n && start.norm() > 0) w.resid = start / start.norm() + fixed_share * w.resid / w.resid.norm();
  const auto which = end == SpectrumEnd::largest ? arpack::which::largest_algebraic : arpack::which::smallest_algebraic;
  while (true) {
    arpack::saupd(w.ido, arpack::bmat::generalized, w.n, which, w.nev, options.tolerance, w.resid.data(), w.ncv,
                  w.v.data(), w.n, w.iparam, w.ipntr, w.workd.data(), w.workl.data(), w.lworkl, w.info);
    if (w.ido == -1 || w.ido == 1) {
      const Vector ax = a(w.block(0));
      w.block(1) = m_inverse(ax);
      w.block(0) = ax;  // mode 2 wants A x left in place of x
    } else if (w.ido == 2) {
      w.block(1) = m(w.block(0));
    } else {
      break;
    }
  }
  if (!w.any_converged()) return result;  // data, not an error
  Vector value(w.nev);
  Matrix z(n, w.nev);
  a_int status = 0;
  arpack::seupd(1, arpack::howmny::ritz_vectors, w.select.data(), value.data(), z.data(), w.n, 0.0,
                arpack::bmat::generalized, w.n, which, w.nev, options.tolerance, w.resid.data(), w.ncv, w.v.data(), w.n,
                w.iparam, w.ipntr, w.workd.data(), w.workl.data(), w.lworkl, status);
  if (status != 0) return result;
  result.value = value[0];
  result.vector = z.col(0);
  result.converged = w.info == 0;
  return result;
}

ArnoldiResult arnoldi(Index n, const LinearMap& a, const ArpackOptions& options, double unit_tolerance) {
  ArnoldiResult result;
  // Six are requested, so that cutting a complex pair after the sixth does not affect the first.
  Workspace w(n, std::min<Index>(6, n - 3), options, 1);
  while (true) {
    arpack::naupd(w.ido, arpack::bmat::identity, w.n, arpack::which::largest_magnitude, w.nev, options.tolerance,
                  w.resid.data(), w.ncv, w.v.data(), w.n, w.iparam, w.ipntr, w.workd.data(), w.workl.data(), w.lworkl,
                  w.info);
    if (w.ido != -1 && w.ido != 1) break;
    w.block(1) = a(w.block(0));
    ++result.applications;
  }
  if (!w.any_converged()) return result;
  Vector real = Vector::Zero(w.nev + 1), imaginary = real, workev(3 * w.ncv);
  Matrix z = Matrix::Zero(n, w.nev + 1);
  a_int status = 0;
  arpack::neupd(1, arpack::howmny::ritz_vectors, w.select.data(), real.data(), imaginary.data(), z.data(), w.n, 0.0,
                0.0, workev.data(), arpack::bmat::identity, w.n, arpack::which::largest_magnitude, w.nev,
                options.tolerance, w.resid.data(), w.ncv, w.v.data(), w.n, w.iparam, w.ipntr, w.workd.data(),
                w.workl.data(), w.lworkl, status);
  if (status != 0) return result;
  // A complex pair has two columns: the real part of its vector, then the imaginary part.
  const Index found = w.iparam[4];
  Index best = -1;
  for (Index k = 0; k < found; ++k) {
    if (std::hypot(real[k] - 1, imaginary[k]) < unit_tolerance) {
      ++result.units;
    } else if (best < 0 || std::hypot(real[k], imaginary[k]) > std::hypot(real[best], imaginary[best])) {
      best = k;
    }
  }
  if (best < 0) return result;
  result.value = {real[best], std::abs(imaginary[best])};
  const Index first = imaginary[best] < 0 ? best - 1 : best;
  const bool pair = imaginary[best] != 0;
  const Vector x = z.col(first), zero = Vector::Zero(n), y = pair ? Vector(z.col(first + 1)) : zero;
  // (A - lambda)(x + i y), in real arithmetic
  const Vector rx = a(x) - result.value.real() * x + result.value.imag() * y;
  const Vector ry = pair ? Vector(a(y) - result.value.real() * y - result.value.imag() * x) : zero;
  result.applications += pair ? 2 : 1;
  result.residual = std::sqrt((rx.squaredNorm() + ry.squaredNorm()) / (x.squaredNorm() + y.squaredNorm()));
  result.converged = w.info == 0;
  return result;
}

}  // namespace nscdd
