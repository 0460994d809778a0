// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Two points whose distance does not change, to first order: the centres of grains at a rigid contact without
/// friction.
struct Bar {
  Index a = 0, b = 0;
};

/// Clusters of points that bars hold together: for each point the number of its cluster, or -1. A cluster moves as one
/// rigid body under every motion that keeps the lengths of its bars to first order. `centres`: d x n, d = 2 or 3.
///
/// A cluster begins with d points that are tied to each other. A point joins that bars tie to it in d independent
/// directions, and so do three points at once that are tied to each other and which all bars together hold (the
/// opposite sides of an octahedron). Clusters with enough independent bars between them become one. Each of these steps
/// is held by singular values of at least 0.05, so what is found is rigid. There may be more: rings of clusters, for
/// example, are not looked for. A cluster has more than d points. Equal input gives equal clusters.
std::vector<Index> rigid_clusters(const Matrix& centres, const std::vector<Bar>& bars);

}  // namespace nscdd
