// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace nscdd {

/// Starts this program again with other kernels if OpenBLAS has chosen those of the Prescott of 2004 for a processor
/// that it does not know, such as one newer than itself: they are slow, and their dsymv may crash. To be called first
/// in `main`. Without effect if OPENBLAS_CORETYPE is set.
void use_kernels_of_this_processor(char** argv);

}  // namespace nscdd
