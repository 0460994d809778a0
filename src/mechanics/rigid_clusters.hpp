// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Two points at constant distance, to first order: the centres of grains at a rigid frictionless contact.
struct Bar {
  Index a = 0, b = 0;
};

/// Rigid clusters of points tied by bars: for each point the number of its cluster, or -1. A cluster moves as one rigid
/// body under every motion that keeps the lengths of its bars to first order. `centres`: d x n, d = 2 or 3.
///
/// A cluster begins with d points that are tied to each other. A point joins if bars tie it in d independent
/// directions; three points tied to each other join at once if all bars together hold them (as opposite sides of an
/// octahedron). Clusters with enough independent bars between them merge. Each step requires singular values of at
/// least 0.05, so that clusters are certainly rigid, but not always the largest: rings of clusters, for example, are
/// not sought. A cluster has more than d points. Equal input gives equal clusters.
std::vector<Index> rigid_clusters(const Matrix& centres, const std::vector<Bar>& bars);

}  // namespace nscdd
