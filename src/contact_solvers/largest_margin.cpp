// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/largest_margin.hpp"

#include "linalg/sparse_cholesky.hpp"
#include "linalg/sparse_entries.hpp"
#include "mechanics/contact_frame.hpp"

namespace nscdd {
namespace {

constexpr Index most_iterations = 80;
constexpr double first_delta = 1e-4, shortest_step = 1e-8, towards_edge = 0.995;

// The second-order cone {x_0 >= |(x_1, ..., x_{D-1})|}, its own dual cone; in the plane a quadrant. Its inner points
// have the two eigenvalues x_0 -+ |(x_1, ...)| > 0.
template <int D>
using ConeVector = Eigen::Matrix<double, D, 1>;
template <int D>
using ConeBlock = Eigen::Matrix<double, D, D>;

// J x = (x_0, -x_1, ...).
template <int D>
ConeVector<D> reflected(ConeVector<D> x) {
  x.template tail<D - 1>() *= -1;
  return x;
}
// The smaller eigenvalue: u_n - mu |u_t| of scaled velocities.
template <int D>
double cone_margin(const ConeVector<D>& x) {
  return x[0] - x.template tail<D - 1>().norm();
}
// x_0^2 - x_1^2 - ..., the product of both eigenvalues.
template <int D>
double cone_determinant(const ConeVector<D>& x) {
  return cone_margin<D>(x) * (x[0] + x.template tail<D - 1>().norm());
}

// Jordan's product a o b, with the unit (1, 0, ...).
template <int D>
ConeVector<D> cone_product(const ConeVector<D>& a, const ConeVector<D>& b) {
  ConeVector<D> c = a[0] * b + b[0] * a;
  c[0] = a.dot(b);
  return c;
}
// The b with a o b = c.
template <int D>
ConeVector<D> cone_quotient(const ConeVector<D>& c, const ConeVector<D>& a) {
  const double first = c.dot(reflected<D>(a)) / cone_determinant<D>(a);
  ConeVector<D> b = (c - first * a) / a[0];
  b[0] = first;
  return b;
}

// The largest step t with x + t d in the cone, for x inside.
template <int D>
double step_to_edge(const ConeVector<D>& x, const ConeVector<D>& d) {
  const double root = std::sqrt(cone_determinant<D>(x));
  const ConeVector<D> n = x / root;
  const double first = d.dot(reflected<D>(n));
  const ConeVector<D> turned = d - (first + d[0]) / (n[0] + 1) * n;
  const double fall = turned.template tail<D - 1>().norm() - first;
  return fall > 0 ? root / fall : infinity;
}

// The scaling of Nesterov and Todd of x and z inside the cone: symmetric F with F z = F^-1 x.
template <int D>
struct ConeScaling {
  ConeBlock<D> factor, inverse;  // F and F^-1

  ConeScaling(const ConeVector<D>& x, const ConeVector<D>& z) {
    const double det_x = cone_determinant<D>(x), det_z = cone_determinant<D>(z),
                 size = std::sqrt(std::sqrt(det_x / det_z));
    const ConeVector<D> a = x / std::sqrt(det_x), b = z / std::sqrt(det_z), e = ConeVector<D>::Unit(0);
    const ConeVector<D> w = (a + reflected<D>(b)) / std::sqrt(2 * (1 + a.dot(b)));  // of determinant 1
    const ConeVector<D> up = w + e, down = reflected<D>(w) + e;
    ConeBlock<D> minus_j = ConeBlock<D>::Identity();
    minus_j(0, 0) = -1;
    factor = size * (minus_j + up * up.transpose() / (1 + w[0]));
    inverse = (minus_j + down * down.transpose() / (1 + w[0])) / size;
  }
};

// Tangential components are scaled by mu, so that K and K* are second-order cones; speeds are relative to max |q_c|,
// masses to sum_c 1 / W_nn. x is lambda, z = u - s e with e the normals, room = 1 - s. Without M and H the variables v
// are impulses of contacts, and W stands for both M and H.
template <int D>
class InteriorPoint {
 public:
  InteriorPoint(const LocalFrictionProblem& problem, const Vector& friction, const Vector& weights)
      : bodies_(problem.h.cols() > 0),
        contacts_(problem.contacts()),
        mass_scale_(problem.w.diagonal()(Eigen::seqN(0, contacts_, D)).cwiseInverse().sum()),
        scale_(problem.size()),
        e_(Vector::Zero(problem.size())),
        h_(bodies_ ? problem.h : problem.w) {
    for (Index k = 0; k < scale_.size(); ++k) scale_[k] = k % D == 0 ? 1 : friction[k / D];
    e_(Eigen::seqN(0, contacts_, D)) = weights;
    if (bodies_) {
      mass_ = problem.mass / mass_scale_;
    } else {
      const SparseMatrix transposed = h_.transpose();
      h_ = scale_.asDiagonal() * (0.5 * mass_scale_ * (h_ + transposed));
    }
    h_ = h_ * scale_.asDiagonal();
    transposed_ = h_.transpose();
    u_ = scale_.cwiseProduct(problem.q) / speed_scale(problem);
    v_ = Vector::Zero(h_.rows());
    x_ = Vector::Zero(u_.size());
    x_(Eigen::seqN(0, contacts_, D)).setConstant(0.5 / weights.sum());
    s_ = margin() - 1;
    best_ = v_;
    best_margin_ = margin();
  }

  LargestMargin run(double speed, const Monitor& monitor) {
    // Without M and H, u = W y has the rounding of impulses y = lambda / delta.
    const double least_delta = bodies_ ? 1e-12 : 1e-6, least_gap = bodies_ ? 1e-10 : 1e-8;
    LargestMargin result;
    const double first = gap(slack(), x_, 1 - s_, tau_);
    for (double now = first; now > least_gap && result.factorisations < most_iterations;
         now = gap(slack(), x_, 1 - s_, tau_)) {
      ++result.factorisations;
      delta_ = std::max(least_delta, first_delta * now / first);
      if (!iterate(now) || !report(monitor, result.factorisations, most_iterations)) break;
      if (margin() <= best_margin_) continue;
      best_ = v_;
      best_margin_ = margin();
    }
    const double square = bodies_ ? best_.dot(mass_ * best_) : best_.dot(h_ * best_);
    result.speed = speed * std::sqrt(std::max(0.0, square));
    result.velocities = bodies_ ? Vector(speed * best_) : Vector(speed * mass_scale_ * scale_.cwiseProduct(best_));
    result.impulses = x_(Eigen::seqN(0, contacts_, D));
    result.slack = slack()(Eigen::seqN(0, contacts_, D));
    return result;
  }

 private:
  using Part = ConeVector<D>;
  using Blocks = std::vector<ConeBlock<D>>;
  struct Step {
    Vector x, v, u;
    double s = 0, tau = 0;
  };

  Vector slack() const { return u_ - s_ * e_; }
  double gap(const Vector& z, const Vector& x, double room, double tau) const {
    return (z.dot(x) + room * tau) / static_cast<double>(contacts_ + 1);
  }
  double margin() const {
    double least = infinity;
    for (Index k = 0; k < u_.size(); k += D) least = std::min(least, cone_margin<D>(u_.segment<D>(k)) / e_[k]);
    return least;
  }
  static Vector times(const Blocks& blocks, const Vector& x) {
    Vector y(x.size());
    for (Index c = 0; c < count(blocks); ++c) y.segment<D>(D * c) = blocks[at(c)] * x.segment<D>(D * c);
    return y;
  }
  static SparseMatrix block_diagonal(const Blocks& blocks) {
    SparseEntries entries;
    entries.reserve(D * D * blocks.size());
    for (Index k = 0; k < D * count(blocks); ++k)  // zeros are stored: one pattern for all
      for (Index i = 0; i < D; ++i) entries.add(k - k % D + i, k, blocks[at(k / D)](i, k % D));
    return entries.matrix(D * count(blocks), D * count(blocks));
  }

  bool factorise() {
    SparseMatrix matrix;
    if (bodies_)
      matrix = SparseMatrix(h_ * block_diagonal(scaling_)) * transposed_ + delta_ * mass_;
    else
      matrix = h_ + delta_ * block_diagonal(inverse_);
    if (!analysis_) analysis_.emplace(matrix);
    factor_.emplace(*analysis_, matrix);
    return factor_->positive_definite();
  }
  // dx + D du = g,  H dx - delta M dv = -(H x - delta M v),  du = H^T dv.
  Step solve(const Vector& g, const Vector& x, const Vector& v) const {
    Step step;
    if (bodies_) {
      step.v = factor_->solve(h_ * (g + x) - delta_ * (mass_ * v));
      step.u = transposed_ * step.v;
      step.x = g - times(scaling_, step.u);
    } else {
      step.x = factor_->solve(delta_ * times(inverse_, g) - h_ * (x - delta_ * v));
      step.v = (x + step.x) / delta_ - v;
      step.u = transposed_ * step.v;
    }
    return step;
  }
  // The step with dx + D dz = g and room dtau - tau ds = cap; of_margin: what a change of s by 1 adds.
  Step whole_step(const Vector& g, double cap, const Step& of_margin) const {
    Step step = solve(g, x_, v_);
    const double room = 1 - s_;
    step.s = -(cap / room + e_.dot(step.x)) / (e_.dot(of_margin.x) + tau_ / room);
    step.x += step.s * of_margin.x;
    step.v += step.s * of_margin.v;
    step.u += step.s * of_margin.u;
    step.tau = (cap + tau_ * step.s) / room;
    return step;
  }
  double longest(const Step& step) const {  // at most 1 / towards_edge
    const Vector z = slack(), dz = step.u - step.s * e_;
    double fall = std::max({towards_edge, -step.tau / tau_, step.s / (1 - s_)});
    for (Index k = 0; k < z.size(); k += D)
      fall = std::max({fall, 1 / step_to_edge<D>(x_.segment<D>(k), Part(step.x.template segment<D>(k))),
                       1 / step_to_edge<D>(z.segment<D>(k), dz.segment<D>(k))});
    return 1 / fall;
  }
  // Mehrotra's predictor and corrector from complementarity `now`. Returns false if it makes no progress.
  bool iterate(double now) {
    const Vector z = slack();
    const double room = 1 - s_;
    std::vector<ConeScaling<D>> scalings;
    scaling_.clear();
    inverse_.clear();
    for (Index k = 0; k < z.size(); k += D) {
      const ConeScaling<D>& of = scalings.emplace_back(x_.segment<D>(k), z.segment<D>(k));
      scaling_.push_back(of.factor * of.factor);
      inverse_.push_back(of.inverse * of.inverse);
    }
    if (!factorise()) return false;
    const Step of_margin = solve(times(scaling_, e_), Vector::Zero(x_.size()), Vector::Zero(v_.size()));
    const Step ahead = whole_step(-x_, -room * tau_, of_margin);
    const Vector dz = ahead.u - ahead.s * e_;
    const double reach = std::min(1.0, longest(ahead));
    const double after = gap(z + reach * dz, x_ + reach * ahead.x, room - reach * ahead.s, tau_ + reach * ahead.tau);
    const double centre = now * std::pow(std::clamp(after / now, 0.0, 1.0), 3);
    Vector g(x_.size());
    for (Index c = 0; c < contacts_; ++c) {
      const ConeScaling<D>& of = scalings[at(c)];
      const Part middle = of.factor * z.segment<D>(D * c), change_z = of.factor * dz.segment<D>(D * c),
                 change_x = of.inverse * ahead.x.template segment<D>(D * c);
      const Part right = centre * Part::Unit(0) - cone_product<D>(middle, middle) - cone_product<D>(change_z, change_x);
      g.segment<D>(D * c) = of.factor * cone_quotient<D>(right, middle);
    }
    const Step step = whole_step(g, centre - room * tau_ + ahead.s * ahead.tau, of_margin);
    const double length = towards_edge * longest(step);
    if (!(length > shortest_step) || !step.v.allFinite() || !step.x.allFinite()) return false;
    x_ += length * step.x;
    v_ += length * step.v;
    u_ += length * step.u;
    s_ += length * step.s;
    tau_ += length * step.tau;
    return true;
  }

  const bool bodies_;
  const Index contacts_;
  const double mass_scale_;
  Vector scale_, e_;
  SparseMatrix h_, transposed_, mass_;
  Vector x_, v_, u_, best_;
  double s_ = 0, tau_ = 0.5, best_margin_ = 0, delta_ = 0;
  Blocks scaling_, inverse_;  // D with D z = x, and D^-1
  std::optional<CholeskyAnalysis> analysis_;
  std::optional<SparseCholesky> factor_;
};

}  // namespace

double speed_scale(const LocalFrictionProblem& problem) {
  const double largest = problem.q.reshaped(problem.dimension, problem.contacts()).colwise().norm().maxCoeff();
  return largest > 0 ? largest : 1;
}

LargestMargin largest_margin(const LocalFrictionProblem& problem, const Vector& friction, const Vector& weights,
                             const Monitor& monitor) {
  return in_dimension(problem, [&](auto dimension) {
    return InteriorPoint<dimension()>(problem, friction, weights).run(speed_scale(problem), monitor);
  });
}

}  // namespace nscdd
