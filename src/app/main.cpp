// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/verbs.hpp"

int main(int argc, char** argv) {
  nscdd::app::open_standard_streams();
  const nscdd::app::Outcome outcome = nscdd::app::run_program(argc, argv, {});
  if (!outcome.error.empty()) nscdd::app::note("error: {}", outcome.error);
  return outcome.code;
}
