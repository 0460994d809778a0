// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/sweep.hpp>

#include <variant>

namespace nscdd {

/// A matrix of a case for other programs, with its description in ASCII.
struct CaseOperator {
  std::string name;     ///< "M"; of subdomain 3 "M_3"
  std::string formula;  ///< in the symbols of docs/notation.md, such as "H^T M^-1 H"
  std::string meaning;
  std::string unit;  ///< "1" for a pure number, "" for numbers of grains and contacts
  std::variant<SparseMatrix, Matrix, std::vector<Index>> values;
  bool symmetric = false;  ///< to the last bit

  std::array<Index, 2> shape() const;
};

struct OperatorParameters {
  double epsilon = 1.0;   ///< of the linear law, 1/kg; 0 is the rigid limit
  double eta = infinity;  ///< of the network of Stage 2, 1/kg
  double relaxation = 1;  ///< omega of B
  bool dense = true;      ///< also S, P and B, which are n_Gamma x n_Gamma
};

/// Computes the operators of a model one after another. Those of the undivided packing:
///     M, H, W = H^T M^-1 H
/// For each subdomain E that holds a grain:
///     M_E, H_E, A_E; G_E, the columns of H_E of Stage 1, unless these are all;
///     grains_E and contacts_E (of G_E: active_contacts_E), the global numbers of its rows and columns
/// If the interface is not empty, X = X_infinity, the generic one ([ADI12] eq. (17)). With `dense`,
///     S = X_epsilon on the contacts of Stage 1, P = X_eta on all contacts, and B = I - omega P^-1 S
/// Shapes are those of docs/notation.md; for eta = infinity P is X, sparse. `selection` is that of the model. The
/// monitor follows the columns of B; returns false if it stops the work. Throws Error for an operator that overflows.
bool case_operators(const Model& model, const Selection& selection, const OperatorParameters& parameters,
                    const Sink<CaseOperator>& sink, const Monitor& monitor = {});

}  // namespace nscdd
