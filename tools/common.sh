# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the tools: the root of the tree, and functions that announce and run their steps.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
total_steps=1
current_step=0
started=$SECONDS

# step TEXT: announces the next step with the time elapsed so far.
step() {
  current_step=$((current_step + 1))
  printf '[%d/%d] %s (%d s elapsed)\n' "$current_step" "$total_steps" "$1" "$((SECONDS - started))"
}

# quietly LOG COMMAND...: runs a command with its output in a log, which is printed only if the command fails.
quietly() {
  local log=$1
  shift
  mkdir -p "$(dirname "$log")"
  if ! "$@" >"$log" 2>&1; then
    cat "$log" >&2
    printf '%s failed: %s\n' "$(basename "$0")" "$*" >&2
    exit 1
  fi
}
