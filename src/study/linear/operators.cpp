// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/operators.hpp"

#include "core/fail.hpp"
#include "core/memory.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

bool with_spins(const ReferenceProblem& problem) { return problem.dofs_per_grain > problem.dimension; }

std::string_view unknowns(const ReferenceProblem& problem) {
  if (problem.dimension == 2) return with_spins(problem) ? "(v_x, v_y, spin) of each" : "(v_x, v_y) of each";
  return with_spins(problem) ? "(v_x, v_y, v_z, spins about three axes) of each" : "(v_x, v_y, v_z) of each";
}

std::string mass_unit(const ReferenceProblem& problem) { return with_spins(problem) ? "kg, of spins kg m^2" : "kg"; }

std::string h_unit(const ReferenceProblem& problem) { return problem.columns_per_contact > 1 ? "1, of spins m" : "1"; }

void hand_undivided(const Model& model, const Sink<CaseOperator>& sink) {
  const ReferenceProblem& problem = model.problem;
  sink({"M", "M = diag(m)", fmt::format("inertia of the grains, {} in turn", unknowns(problem)), mass_unit(problem),
        diagonal_matrix(problem.inertia), true});
  sink({"H", "H",
        fmt::format("H r: momenta that the contact impulses r give the grains; H^T V: the relative velocities of the "
                    "contacts; columns are {}, -n on one grain and +n on the other",
                    problem.columns_per_contact == 1 ? "the contacts"
                    : problem.dimension == 2         ? "the normal and the tangent of each contact"
                                                     : "the normal and the two tangents of each contact"),
        h_unit(problem), problem.h, false});
  const SparseMatrix root = scaled_connectivity(problem.inertia, problem.h);
  // W is symmetric to the last bit: the sums of W_ij and W_ji have the same terms in the same order.
  sink({"W", "W = H^T M^-1 H", "Delassus operator of the undivided packing: velocities that impulses cause", "1/kg",
        SparseMatrix(root.transpose() * root), true});
}

void hand_subdomains(const Model& model, const Selection& selection, const Sink<CaseOperator>& sink) {
  for (Index e = 0; e < count(model.parts.subdomains); ++e) {
    const Subdomain& own = model.parts.subdomains[at(e)];
    if (own.grains.empty()) continue;
    const auto hand = [&](const std::string& symbol, std::string formula, std::string meaning, std::string unit,
                          auto values, bool symmetric) {
      sink({fmt::format("{}_{}", symbol, e), std::move(formula), fmt::format("{}; E = {}", meaning, e), std::move(unit),
            std::move(values), symmetric});
    };
    hand("M", "M_E = diag(m / q)",
         "inertia of the copies in subdomain E: a q-th of that of a grain which q subdomains share",
         mass_unit(model.problem), diagonal_matrix(own.inertia), true);
    hand("H", "H_E", "the rows and columns of H that subdomain E has", h_unit(model.problem), own.h, false);
    hand("grains", "", "numbers in the packing, from 0, of the grains of subdomain E", "", own.grains, false);
    hand("contacts", "", "numbers of the columns of H, from 0, that are the columns of H_E", "", own.contacts, false);
    if (selection.restricted) {
      const Subdomain& kept = selection.restricted->subdomains[at(e)];
      hand("G", "G_E = H_E C_E", "columns of H_E of the contacts of Stage 1", h_unit(model.problem), kept.h, false);
      hand("active_contacts", "", "numbers of the columns of H, from 0, that are the columns of G_E", "", kept.contacts,
           false);
    }
    if (model.parts.interface_size() > 0)
      hand("A", "A_E", "gluing, sum_E A_E V_E = 0: +1 for the first copy of a row, -1 for the second", "1", own.a,
           false);
  }
}

// The formula of X_x. `h`: the letter of its connectivity.
std::string formula_of(std::string_view symbol, std::string_view flexibility, double value, char h) {
  if (std::isinf(value)) return fmt::format("{} = sum_E A_E M_E^-1 A_E^T", symbol);
  if (value == 0)
    return fmt::format(
        "{0} = sum_E A_E M_E^-1/2 (I - Pi_E) M_E^-1/2 A_E^T, Pi_E the projector onto the range of M_E^-1/2 {1}_E",
        symbol, h);
  return fmt::format("{0} = sum_E A_E (M_E + {2}_E {2}_E^T / {1})^-1 A_E^T, {1} = {3} 1/kg", symbol, flexibility, h,
                     value);
}

void require_finite(const Model& model, std::string_view name, const Matrix& matrix) {
  if (!matrix.allFinite())
    fail("case {}: expected a finite operator {}, met other numbers: its flexibility is too small for its masses",
         model.name, name);
}

// I - omega P^-1 S; none if the monitor stops the work.
std::optional<Matrix> contraction_matrix(const InterfaceOperator& p, const Matrix& s, double relaxation,
                                         const Monitor& monitor) {
  constexpr Index at_a_time = 64;
  const Index n = s.cols();
  Matrix b(n, n);
  for (Index first = 0; first < n; first += at_a_time) {
    const Index columns = std::min(at_a_time, n - first);
    for_each_in_parallel(columns, [&](Index k) { b.col(first + k) = -relaxation * p.solve(s.col(first + k)); });
    if (!report(monitor, first + columns, n)) return std::nullopt;
  }
  b.diagonal().array() += 1;
  return b;
}

}  // namespace

std::array<Index, 2> CaseOperator::shape() const {
  return std::visit(
      []<class Values>(const Values& one) -> std::array<Index, 2> {
        if constexpr (std::is_same_v<Values, std::vector<Index>>)
          return {count(one), 1};
        else
          return {one.rows(), one.cols()};
      },
      values);
}

bool case_operators(const Model& model, const Selection& selection, const OperatorParameters& parameters,
                    const Sink<CaseOperator>& sink, const Monitor& monitor) {
  const Index n = model.parts.interface_size();
  // S, P and B twice, as computed and in the file that HDF5 keeps in memory; the bytes of that file; and the condensed
  // matrix of a subdomain, or the present columns.
  if (parameters.dense)
    require_memory(12 * bytes_of_matrix(n, n), fmt::format("S, P and B of {} interface unknowns", n),
                   "--sparse-only, which leaves these out, or fewer subdomains");
  hand_undivided(model, sink);
  hand_subdomains(model, selection, sink);
  if (n == 0) return true;
  const InterfaceFamily all(model.parts);
  const InterfaceOperator p = all.at(parameters.eta);
  sink({"X", formula_of("X", "", infinity, 'H'), "interface operator of the generic algorithm: inertia only", "1/kg",
        p.generic(), true});
  if (!parameters.dense) return true;
  const InterfaceFamily stage_one = selection.restricted ? InterfaceFamily(*selection.restricted) : all;
  const InterfaceOperator s = stage_one.at(parameters.epsilon);
  require_finite(model, "S", s.dense());
  sink({"S", formula_of("S", "epsilon", parameters.epsilon, selection.restricted ? 'G' : 'H'),
        "X_epsilon, the interface operator of Stage 1: jumps that interface impulses cause", "1/kg", s.dense(), true});
  decltype(CaseOperator::values) values = p.generic();
  if (std::isfinite(parameters.eta)) {
    require_finite(model, "P", p.dense());
    values = p.dense();
  }
  sink({"P", formula_of("P", "eta", parameters.eta, 'H'), "X_eta, the interface operator that Stage 2 solves with",
        "1/kg", std::move(values), true});
  std::optional<Matrix> b = contraction_matrix(p, s.dense(), parameters.relaxation, monitor);
  if (!b) return false;
  require_finite(model, "B", *b);
  const std::string formula = parameters.relaxation == 1
                                  ? "B = I - P^-1 S"
                                  : fmt::format("B = I - omega P^-1 S, omega = {}", parameters.relaxation);
  sink({"B", formula, "contraction operator: maps the error of the interface impulses to that after an iteration", "1",
        *std::move(b), false});
  return true;
}

}  // namespace nscdd
