// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_program.hpp"

#include <fcntl.h>
#include <linux/capability.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace nscdd::testing {
namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  if (value == nullptr) throw std::runtime_error(std::string("the environment has no ") + name);
  return value;
}

[[noreturn]] void refuse(const std::string& what) {
  throw std::runtime_error(what + ": " + std::generic_category().message(errno));
}

// A file descriptor closed by its owner.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  bool open() const { return number_ >= 0; }
  void reset(int number) {
    close();
    number_ = number;
  }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

// One stream of the program: captured through a pipe, or sent elsewhere.
struct Stream {
  Descriptor ours, theirs;
  std::string captured;

  explicit Stream(const fs::path& target, bool terminal = false) {
    if (terminal) {
      ours.reset(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
      if (!ours.open() || ::grantpt(ours.number()) != 0 || ::unlockpt(ours.number()) != 0) refuse("terminal");
      theirs.reset(::open(::ptsname(ours.number()), O_RDWR | O_NOCTTY | O_CLOEXEC));
      if (!theirs.open()) refuse("terminal");
      return;
    }
    if (!target.empty()) {
      theirs.reset(::open(target.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
      if (!theirs.open()) refuse(target.string());
      return;
    }
    std::array<int, 2> ends{};
    // Closed on exec: a program started by another thread must not hold our pipe open.
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) refuse("pipe");
    ours.reset(ends[0]);
    theirs.reset(ends[1]);
  }

  void read_some() {
    std::array<char, 65536> buffer{};
    const ssize_t length = ::read(ours.number(), buffer.data(), buffer.size());
    if (length > 0) captured.append(buffer.data(), static_cast<std::size_t>(length));
    // A terminal that nobody holds open any more is an error rather than an end.
    if (length == 0 || (length < 0 && errno != EINTR)) ours.close();
  }
};

// What the new process does before it becomes the program; nothing here may allocate.
[[noreturn]] void become_program(const char* folder, char* const* arguments, char* const* environment,
                                 const RunOptions& options, const Stream& output, const Stream& error) {
  const bool placed = ::dup2(output.theirs.number(), STDOUT_FILENO) >= 0 &&
                      ::dup2(error.theirs.number(), STDERR_FILENO) >= 0 && ::chdir(folder) == 0;
  if (!placed) ::_exit(127);
  // A test program started in the background hands down signals that are ignored.
  if (::signal(SIGINT, SIG_DFL) == SIG_ERR || ::signal(SIGTERM, SIG_DFL) == SIG_ERR) ::_exit(127);
  if (options.largest_file) {
    const rlimit limit{*options.largest_file, *options.largest_file};
    // The signal would end the program; without it a write fails, as on a full disk.
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0 || ::signal(SIGXFSZ, SIG_IGN) == SIG_ERR) ::_exit(127);
  }
  // Without this capability the superuser is held to permissions too; others are anyway, and may not drop it.
  if (options.obey_permissions) ::prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0);
  ::execve(arguments[0], arguments, environment);
  ::_exit(127);
}

// Reads both streams until the program has closed them; one that has stopped itself is killed.
void follow(pid_t process, Stream& output, Stream& error, const RunOptions& options) {
  using clock = std::chrono::steady_clock;
  const auto deadline = clock::now() + std::chrono::minutes(4);
  while (output.ours.open() || error.ours.open()) {
    std::array<pollfd, 2> polled{{{output.ours.number(), POLLIN, 0}, {error.ours.number(), POLLIN, 0}}};
    ::poll(polled.data(), polled.size(), 5);  // descriptors below 0 are passed over
    if (polled[0].revents != 0) output.read_some();
    if (polled[1].revents != 0) error.read_some();
    siginfo_t state{};
    if (::waitid(P_PID, static_cast<id_t>(process), &state, WSTOPPED | WNOHANG) == 0 && state.si_pid != 0 &&
        options.signal_at && options.signal_at->while_stopped) {
      options.signal_at->while_stopped();
      ::kill(process, SIGKILL);
    }
    if (clock::now() > deadline) ::kill(process, SIGKILL);
  }
}

// Exit code and peak memory of a program that has ended.
Outcome wait_for(pid_t process) {
  int status = 0;
  rusage used{};
  while (::wait4(process, &status, 0, &used) < 0)
    if (errno != EINTR) refuse("wait4");
  Outcome outcome;
  outcome.exit_code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  outcome.peak_memory = static_cast<std::size_t>(used.ru_maxrss) * 1024;  // Linux counts in KiB
  return outcome;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> values;
  std::istringstream stream(line);
  for (std::string value; std::getline(stream, value, ',');) values.push_back(value);
  if (!line.empty() && line.back() == ',') values.emplace_back();
  return values;
}

// What is loaded before the program already, such as a library broken on purpose.
std::string also_loaded() {
  const char* others = std::getenv("LD_PRELOAD");
  return others == nullptr ? "" : std::string(":") + others;
}

// As the kernel takes arguments and settings.
std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "nscdd-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) refuse(name);
  path_ = fs::canonical(name);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string read_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void write_file(const fs::path& path, const std::string& content) {
  if (path.has_parent_path()) fs::create_directories(path.parent_path());
  std::ofstream stream(path, std::ios::binary);
  stream << content;
  stream.close();
  if (!stream) throw std::runtime_error("cannot write " + path.string());
}

std::map<std::string, std::string> content_of(const fs::path& folder) {
  std::map<std::string, std::string> content;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (entry.is_symlink() || (!entry.is_regular_file() && !entry.is_directory())) {
      content[name] = "(link, pipe or device)";
    } else if (entry.is_directory()) {
      content[name + "/"] = "";
    } else {
      content[name] = read_file(entry.path());
    }
  }
  return content;
}

Outcome run_program(const fs::path& folder, const std::vector<std::string>& arguments, const RunOptions& options) {
  std::vector<std::string> words{environment("NSCDD_PROGRAM")};
  words.insert(words.end(), arguments.begin(), arguments.end());
  // Cases and studies are those of the source tree, wherever the program was built.
  ::setenv("NSCDD_DATA", source_folder().c_str(), 1);
  std::vector<std::string> settings;
  if (const auto& at = options.signal_at)
    settings = {"LD_PRELOAD=" + environment("NSCDD_SIGNAL_MODULE") + also_loaded(), "NSCDD_SIGNAL_FILES=" + at->files,
                "NSCDD_SIGNAL_BYTES=" + std::to_string(at->bytes), "NSCDD_SIGNAL=" + std::to_string(at->signal)};
  for (char** setting = environ; *setting != nullptr; ++setting)  // of two LD_PRELOAD the last one would count
    if (!options.signal_at || !std::string_view(*setting).starts_with("LD_PRELOAD=")) settings.emplace_back(*setting);
  const std::vector<char*> argument_pointers = pointers_to(words), setting_pointers = pointers_to(settings);

  Stream output(options.standard_output), error(options.standard_error, options.on_terminal);
  const pid_t process = ::fork();
  if (process < 0) refuse("fork");
  if (process == 0)
    become_program(folder.c_str(), argument_pointers.data(), setting_pointers.data(), options, output, error);
  output.theirs.close();
  error.theirs.close();
  follow(process, output, error, options);
  Outcome outcome = wait_for(process);
  if (outcome.exit_code == 127) throw std::runtime_error("cannot start " + words[0]);
  outcome.standard_output = output.captured;
  outcome.standard_error = error.captured;
  return outcome;
}

fs::path source_folder() { return environment("NSCDD_SOURCE"); }

const std::string& CsvTable::text(std::size_t row, const std::string& column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end()) throw std::runtime_error("the table has no column " + column);
  return rows.at(row).at(static_cast<std::size_t>(found - columns.begin()));
}

double CsvTable::number(std::size_t row, const std::string& column) const {
  const std::string& value = text(row, column);
  std::size_t read = 0;
  const double result = std::stod(value, &read);
  if (read != value.size()) throw std::runtime_error("not a number: " + value);
  return result;
}

CsvTable read_table(const std::string& csv) {
  CsvTable table;
  std::istringstream stream(csv);
  std::string line;
  std::getline(stream, line);
  table.columns = split(line);
  while (std::getline(stream, line)) {
    table.rows.push_back(split(line));
    if (table.rows.back().size() != table.columns.size())
      throw std::runtime_error("a row of another length than the first line: " + line);
  }
  return table;
}

}  // namespace nscdd::testing
