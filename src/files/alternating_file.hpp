// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace nscdd {

/// A file that is changed again and again and yet complete under its name at every moment, however the
/// program ends. There are two copies: `path`, never touched while it has that name, and `path.next`. The
/// spare one gets the change that the other one has already (or its bytes, where that is faster), then the
/// new change, and takes the name. Whoever reads `path` meets a finished version and does not disturb the
/// writer. `path.lock` keeps a second writer away. A symbolic link stays one: `path` is then what it leads
/// to. Every function throws Error naming the file where the system refuses.
class AlternatingFile {
 public:
  /// Changes the file of the given name; must leave it closed.
  using Change = std::function<void(const std::string& path)>;

  /// The names beside `path`: spare, version before, lock.
  static std::vector<std::string> names_beside(const std::string& path);

  /// Takes the lock; leftovers of a run that was killed are removed, `path` is left as it is. Throws Error
  /// naming a file of one of these names that no run left.
  explicit AlternatingFile(const std::string& path);
  ~AlternatingFile();  ///< `path` stays with its last complete change
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
  double missing_seconds_ = 0;  ///< that it took
};

}  // namespace nscdd
