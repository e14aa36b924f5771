#include "eval/store/machine.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <sqlite3.h>
#include <sys/utsname.h>
#include <zstd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "controller/config/json.h"
#include "eval/store/hash.h"

namespace moma::store {
namespace {

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0 || line.rfind("Model", 0) == 0) {
      const std::size_t colon = line.find(": ");
      if (colon != std::string::npos) return line.substr(colon + 2);
    }
  }
  return "unknown";
}

/// The features by which the C library picks its mathematical functions.
std::string cpu_features() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  std::string features = "x86-64";
  if (__builtin_cpu_supports("avx2")) features += "+avx2";
  if (__builtin_cpu_supports("fma")) features += "+fma";
  if (__builtin_cpu_supports("fma4")) features += "+fma4";
  return features;
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "other";
#endif
}

}  // namespace

Machine this_machine() {
  Machine machine;
  utsname names{};
  if (::uname(&names) == 0) {
    machine.host = names.nodename;
    machine.os = fmt::format("{} {} {}, glibc {}", names.sysname, names.release, names.machine, gnu_get_libc_version());
  }
  machine.cpu = cpu_model();
  machine.cpu_count = static_cast<int>(std::thread::hardware_concurrency());
  const Json libraries = {{"ode", kOdeVersion},           {"eigen", kEigenVersion},
                          {"coal", kCoalVersion},         {"urdfdom", kUrdfdomVersion},
                          {"qp", kQpSolverVersion},       {"sqlite", sqlite3_libversion()},
                          {"zstd", ZSTD_versionString()}, {"glibc", gnu_get_libc_version()}};
  machine.libraries = libraries.dump();
  const std::string flags = to_hex(hash_text(kCompilerFlags)).substr(0, 8);
  machine.machine_class =
      fmt::format("{} glibc-{} {} flags-{} ode-{} eigen-{} coal-{} {}", cpu_features(), gnu_get_libc_version(),
                  kCompiler, flags, kOdeVersion, kEigenVersion, kCoalVersion, kQpSolverVersion);
  return machine;
}

std::string version_text() {
  const std::string commit = kGitCommit;
  if (commit.empty()) return fmt::format("moma {}", kVersion);
  return fmt::format("moma {} ({}{})", kVersion, commit.substr(0, 12), kGitDirty ? ", changed" : "");
}

std::string utc_now() {
  const auto now = std::chrono::system_clock::now();
  const auto since = now.time_since_epoch();
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(since).count() % 1000;
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03d}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(now)), ms);
}

}  // namespace moma::store
