// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded before a program (LD_PRELOAD), sends it a signal as it writes: once so many bytes have gone to files of a
// name. Tests of interrupted and killed runs need it, because a signal sent by a clock comes too late on one machine
// and too early on another. The environment says what to do: NSCDD_SIGNAL_FILES (a pattern of names, as in a shell),
// NSCDD_SIGNAL_BYTES and NSCDD_SIGNAL (a number).
#include <dlfcn.h>
#include <fnmatch.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

// Bytes that remain until the signal is due.
std::atomic<long long> remaining{std::atoll(std::getenv("NSCDD_SIGNAL_BYTES"))};
std::atomic<bool> sent{false};

void count(const char* path, std::size_t bytes) {
  const char* slash = std::strrchr(path, '/');
  const char* name = slash == nullptr ? path : slash + 1;
  if (::fnmatch(std::getenv("NSCDD_SIGNAL_FILES"), name, 0) == 0) remaining -= static_cast<long long>(bytes);
}

void count(int file, std::size_t bytes) {
  std::array<char, 4096> path{};
  const std::string link = "/proc/self/fd/" + std::to_string(file);
  if (::readlink(link.c_str(), path.data(), path.size() - 1) > 0) count(path.data(), bytes);
}

void send_if_due() {
  if (remaining > 0 || sent.exchange(true)) return;
  const int signal = std::atoi(std::getenv("NSCDD_SIGNAL"));
  std::raise(signal);
  if (signal == SIGINT || signal == SIGTERM) std::raise(signal);  // as `timeout` does
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

// The program writes tables by fwrite and fflush, so that a row is whole once they have ended; HDF5 writes by pwrite.
extern "C" {

std::size_t fwrite(const void* data, std::size_t size, std::size_t length, std::FILE* stream) {
  static const auto original = next<decltype(&::fwrite)>("fwrite");
  const std::size_t done = original(data, size, length, stream);
  count(::fileno(stream), size * done);
  return done;
}

int fflush(std::FILE* stream) {
  static const auto original = next<decltype(&::fflush)>("fflush");
  const int result = original(stream);
  send_if_due();
  return result;
}

ssize_t pwrite(int file, const void* data, std::size_t size, off_t offset) {
  static const auto original = next<decltype(&::pwrite)>("pwrite");
  const ssize_t done = original(file, data, size, offset);
  if (done > 0) count(file, static_cast<std::size_t>(done));
  send_if_due();
  return done;
}

// A change of name counts as if it wrote some bytes, so that signals fall between it and what comes next, too.
int rename(const char* from, const char* to) {
  static const auto original = next<decltype(&::rename)>("rename");
  const int result = original(from, to);
  count(to, 1000);
  send_if_due();
  return result;
}
}
