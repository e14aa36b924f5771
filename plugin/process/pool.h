#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "controller/config/paths.h"
#include "plugin/process/session.h"

namespace moma {

/// The processes of one command, for several threads at once: one for each concurrent motion, kept for later ones.
/// Points of a sweep share them.
class ProcessPool {
 public:
  /// Returns the command's pool, which all its users share. Starts nothing.
  static std::shared_ptr<ProcessPool> of(const ProcessCommand& command);

  explicit ProcessPool(ProcessCommand command) : command_(std::move(command)) {}
  ~ProcessPool();
  ProcessPool(const ProcessPool&) = delete;
  ProcessPool& operator=(const ProcessPool&) = delete;

  const ProcessCommand& command() const noexcept { return command_; }

  /// Returns an idle or a new process with this setup. Throws PluginError: it does not start, refuses the setup, or its
  /// files differ from those of the first one.
  std::unique_ptr<Session> take(const std::shared_ptr<const std::string>& setup, double control_period);
  /// A broken one is thrown away.
  void give_back(std::unique_ptr<Session> session) noexcept;

  /// Digest of each file that the processes are made of, by absolute path; known once one was taken.
  std::map<fs::path, std::string> files() const;

 private:
  void check(const Session& session);
  bool unchanged() const;

  const ProcessCommand command_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Session>> idle_;
  std::map<fs::path, std::string> files_;
};

}  // namespace moma
