// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/sweep.hpp>

#include <variant>

namespace nscdd {

/// A matrix of a case, for other programs, with what a reader needs to use it. Texts are ASCII.
struct CaseOperator {
  std::string name;     ///< "M"; of subdomain 3 "M_3"
  std::string formula;  ///< in the symbols of docs/notation.md, such as "H^T M^-1 H"
  std::string meaning;
  std::string unit;  ///< "1" for a pure number, "" for numbers of grains and contacts
  std::variant<SparseMatrix, Matrix, std::vector<Index>> values;
  bool symmetric = false;  ///< to the last bit

  std::array<Index, 2> shape() const;
};

/// Which of the operators of a case are asked for.
struct OperatorParameters {
  double epsilon = 1.0;   ///< of the linear law, 1/kg; 0 is the rigid limit
  double eta = infinity;  ///< of the network that Stage 2 sees, 1/kg
  double relaxation = 1;  ///< omega of B
  bool dense = true;      ///< S, P and B as well: n_Gamma x n_Gamma, most of it not zero
};

/// Hands the operators of a model to `sink`, one after another. Those of the undivided packing:
///     M, H, W = H^T M^-1 H
/// For each subdomain E that holds a grain:
///     M_E, H_E, A_E; G_E, the columns of H_E that Stage 1 works with, unless these are all;
///     grains_E and contacts_E (of G_E: active_contacts_E), the global numbers behind its rows and columns
/// Where the interface is not empty, X = X_infinity, the generic one ([ADI12] eq. (17)). With `dense`,
///     S = X_epsilon on the contacts of Stage 1, P = X_eta on all contacts, and B = I - omega P^-1 S
/// Matrices of subdomains are d n_E and n_Gamma high as in docs/notation.md; P is sparse for eta = infinity, where it
/// is X. `selection` is that of the model. The monitor follows the columns of B; returns false where it ends the work.
/// Throws Error for an operator that is not finite in double precision.
bool case_operators(const Model& model, const Selection& selection, const OperatorParameters& parameters,
                    const Sink<CaseOperator>& sink, const Monitor& monitor = {});

}  // namespace nscdd
