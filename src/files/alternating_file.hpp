// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace nscdd {

/// A file that is changed again and again, and yet is complete under its name at every moment, however the
/// program ends. There are two copies: `path`, which is never touched while it has that name, and the spare
/// copy `path.next`. A change takes three steps. 1. The spare copy gets the change that the other one has
/// already, or the bytes of the other one if copying is faster. 2. It gets the new change. 3. It takes the
/// name by a rename. So a reader of `path` always meets a finished version and does not disturb the writer.
/// `path.lock` keeps a second writer away. If `path` is a symbolic link, it stays one, and all this holds for
/// the file it leads to. Every function throws Error naming the file if the system refuses.
class AlternatingFile {
 public:
  /// Changes the file of the given name; must leave it closed.
  using Change = std::function<void(const std::string& path)>;

  /// The names beside `path`: of the spare copy, of the version before, of the lock.
  static std::vector<std::string> names_beside(const std::string& path);

  /// Takes the lock and removes what a killed run left. `path` stays as it is. Throws Error naming a file
  /// that has one of these names but is not left by a run.
  explicit AlternatingFile(const std::string& path);
  ~AlternatingFile();  ///< `path` keeps its last complete change
  AlternatingFile(const AlternatingFile&) = delete;
  AlternatingFile& operator=(const AlternatingFile&) = delete;

  void create(const Change& make);  ///< replaces what there is
  void change(Change change);

 private:
  void take_lock() const;
  bool copying_is_faster() const;
  void copy_to_spare() const;
  void swap();
  std::string path_, spare_, previous_, lock_;
  int lock_descriptor_ = -1;
  Change missing_;              ///< the change that the spare does not have yet, if there is one
  double missing_seconds_ = 0;  ///< how long that change took
};

}  // namespace nscdd
