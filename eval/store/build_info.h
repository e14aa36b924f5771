#pragma once

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
/// Whether tracked files differed from that commit.
extern const bool kGitDirty;

}  // namespace moma::store
