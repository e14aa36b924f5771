#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "eval/run/listener.h"

namespace moma::run {

/// Where results go unless told otherwise: results/NAME.db under the working directory; the folder is made. `part`
/// stands behind the name, e.g. ".shard-1-of-8".
std::filesystem::path usual_store(const std::string& suite, const std::string& part = "");

/// Arguments as a shell would take them again.
std::string command_line(const std::vector<std::string>& arguments);

/// "stopped WHAT: SAVED saved in FILE; to go on: COMMAND".
std::string stopped_text(const std::string& what, const std::string& saved, const std::filesystem::path& file,
                         const std::vector<std::string>& arguments);

/// What is said of a run that has no end, though nobody is at work: it was killed, or, where no lock was left beside
/// the store, this is a copy that was taken while it went on.
std::string no_end_text(const std::string& started, bool lock_left);

/// Tells of runs that have no end, by when they began. `lock_left`: RunLock::there() before this program took it.
void tell_killed(const std::vector<std::string>& started, bool lock_left, const Listener& listener);

/// All cores, but one thread for each rank of an mpirun: ranks are usually as many as cores.
int usual_threads(bool cluster = false);

}  // namespace moma::run
