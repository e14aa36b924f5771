#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "eval/run/listener.h"

namespace moma::run {

/// Returns the default store, results/NAME.db in the working directory, and creates the folder. `part` follows the
/// name, e.g. ".shard-1-of-8".
std::filesystem::path usual_store(const std::string& suite, const std::string& part = "");

/// Returns arguments quoted for a shell.
std::string command_line(const std::vector<std::string>& arguments);

/// Returns "stopped WHAT: SAVED saved in FILE; to go on: COMMAND".
std::string stopped_text(const std::string& what, const std::string& saved, const std::filesystem::path& file,
                         const std::vector<std::string>& arguments);

/// Describes a run without an end that no process works on: it was killed or, if no lock is beside the store, the file
/// is a copy that was taken during the run.
std::string no_end_text(const std::string& started, bool lock_left);

/// Reports runs without an end by their start times. `lock_left`: RunLock::there() before this program took the lock.
void tell_killed(const std::vector<std::string>& started, bool lock_left, const Listener& listener);

/// Returns the number of cores, or one thread per rank of an mpirun: ranks are usually as many as cores.
int usual_threads(bool cluster = false);

}  // namespace moma::run
