// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/saddle_point_family.hpp"

#include <cmath>
#include <optional>

namespace nscdd {
namespace {

// Inexactness from which solutions are refined by one step, which takes as long as three more.
constexpr double refined_above(SolutionAccuracy accuracy) {
  return accuracy == SolutionAccuracy::refined ? 1e-10 : 1e-6;
}

}  // namespace

struct ShiftedPencilFamily::Preparation {
  Preparation(const Contraction& b, SystemForm form, const InertiaMethod& method)
      : matrices(b, form), method_name(method.name), factors(method.analyse(matrices.pattern())) {}
  SaddlePointFamily matrices;
  std::string method_name;
  InertiaFamily factors;
};

class ShiftedPencil::Implementation {
 public:
  Implementation(std::shared_ptr<const ShiftedPencilFamily::Preparation> preparation, double epsilon, double eta,
                 double sigma, SolutionAccuracy accuracy)
      : shift(sigma), preparation_(std::move(preparation)), epsilon_(epsilon), eta_(eta) {
    SparseMatrix matrix = matrices().matrix(epsilon, eta, sigma);
    factor = preparation_->factors.factorise(matrix, {epsilon, eta});
    if (!factor.regular) return;
    inexactness = nscdd::inexactness(factor, matrix, matrices().interface_size());
    if (inexactness > refined_above(accuracy)) refinement_ = std::move(matrix);
  }

  Index below() const { return matrices().most_negative() - factor.negative_eigenvalues; }

  double solution_error() const { return refinement_ ? inexactness * inexactness : inexactness; }

  Vector solve(const Vector& g) const {
    if (!refinement_) return -factor.solve_on_border(g);
    const Vector x = factor.solve_from_border(g);
    return -(x.tail(g.size()) + factor.solve_to_border(symmetric_residual(*refinement_, x, whole(g))));
  }

  Response respond(const Vector& g) const {
    Vector x = factor.solve_from_border(g);
    if (refinement_) x += factor.solve(symmetric_residual(*refinement_, x, whole(g)));
    return matrices().response(x, epsilon_, eta_, shift);
  }

  double shift;
  InertiaFactor factor;
  double inexactness = infinity;

 private:
  const SaddlePointFamily& matrices() const { return preparation_->matrices; }

  Vector whole(const Vector& g) const {
    Vector right = Vector::Zero(matrices().rows());
    right.tail(g.size()) = g;
    return right;
  }

  std::shared_ptr<const ShiftedPencilFamily::Preparation> preparation_;
  double epsilon_, eta_;
  std::optional<SparseMatrix> refinement_;  // the matrix, if solutions take a step of refinement
};

ShiftedPencil::ShiftedPencil(std::shared_ptr<const Implementation> implementation)
    : implementation_(std::move(implementation)) {}
bool ShiftedPencil::regular() const { return implementation_->factor.regular; }
double ShiftedPencil::inexactness() const { return implementation_->inexactness; }
double ShiftedPencil::solution_error() const { return implementation_->solution_error(); }
double ShiftedPencil::shift() const { return implementation_->shift; }
Index ShiftedPencil::below() const { return implementation_->below(); }
Vector ShiftedPencil::solve(const Vector& g) const { return implementation_->solve(g); }
ShiftedPencil::Response ShiftedPencil::respond(const Vector& g) const { return implementation_->respond(g); }

ShiftedPencilFamily::ShiftedPencilFamily(const Contraction& b, SystemForm form, const InertiaMethod& method)
    : preparation_(std::make_shared<const Preparation>(b, form, method)) {}

bool ShiftedPencilFamily::serves(const Contraction& b, SystemForm form, const InertiaMethod& method) const {
  const SaddlePointFamily& own = preparation_->matrices;
  return &b.system.parts() == &own.contraction.system.parts() &&
         &b.preconditioner.parts() == &own.contraction.preconditioner.parts() &&
         std::isinf(b.preconditioner.eta()) == own.generic && form == own.form &&
         method.name == preparation_->method_name;
}

ShiftedPencil ShiftedPencilFamily::at(double epsilon, double eta, double sigma, SolutionAccuracy accuracy) const {
  return ShiftedPencil(
      std::make_shared<const ShiftedPencil::Implementation>(preparation_, epsilon, eta, sigma, accuracy));
}

void ShiftedPencilFamily::release() const { preparation_->factors.release(); }
Index ShiftedPencilFamily::unknowns() const { return preparation_->matrices.rows(); }

}  // namespace nscdd
