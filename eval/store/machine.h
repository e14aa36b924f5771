#pragma once

#include <string>

namespace moma::store {

// Facts about this build, part of every invocation's record.
extern const char* const kVersion;
extern const char* const kBuildType;
extern const char* const kCompiler;
extern const char* const kCompilerFlags;
extern const char* const kOdeVersion;
extern const char* const kEigenVersion;
extern const char* const kCoalVersion;
extern const char* const kUrdfdomVersion;
extern const char* const kQpSolverVersion;

/// The commit that was checked out when the program was built; "" outside of a git checkout.
extern const char* const kGitCommit;
/// True if tracked files differed from that commit.
extern const bool kGitDirty;

/// "moma 1.0 (0123456789ab, changed)".
std::string version_text();

/// This program on this machine, as table `invocation` keeps it.
struct Machine {
  std::string host;
  std::string os;   ///< kernel and C library
  std::string cpu;  ///< model name
  int cpu_count = 0;
  std::string libraries;      ///< JSON object, name: version
  std::string machine_class;  ///< what may change last bits: CPU features, C library, compiler, libraries
};

Machine this_machine();

/// Now, UTC, ISO 8601 with milliseconds.
std::string utc_now();

}  // namespace moma::store
