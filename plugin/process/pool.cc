#include "plugin/process/pool.h"

#include <fmt/format.h>

#include <utility>

#include "plugin/host/library.h"

namespace moma {

std::shared_ptr<ProcessPool> ProcessPool::of(const ProcessCommand& command) {
  // The points of a sweep are read one by one and do not know each other; their shared pool lives as long as one
  // of them.
  static std::mutex mutex;
  static std::map<ProcessCommand, std::weak_ptr<ProcessPool>> all;
  const std::scoped_lock lock(mutex);
  std::erase_if(all, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<ProcessPool>& place = all[command];
  std::shared_ptr<ProcessPool> pool = place.lock();
  if (pool == nullptr || !pool->unchanged()) {
    pool = std::make_shared<ProcessPool>(command);
    place = pool;
  }
  return pool;
}

ProcessPool::~ProcessPool() {
  for (const std::unique_ptr<Session>& session : idle_) session->hang_up();  // all end at the same time
}

std::map<fs::path, std::string> ProcessPool::files() const {
  const std::scoped_lock lock(mutex_);
  return files_;
}

bool ProcessPool::unchanged() const {
  try {
    for (const auto& [file, digest] : files())
      if (plugin_digest(file) != digest) return false;
  } catch (const PluginError&) {
    return false;
  }
  return true;
}

void ProcessPool::check(const Session& session) {
  std::map<fs::path, std::string> files;
  for (const fs::path& file : command_.files) files[file] = plugin_digest(file);
  for (const std::string& name : session.files()) {
    const fs::path file = (command_.directory / name).lexically_normal();
    files[file] = plugin_digest(file);
  }
  const std::scoped_lock lock(mutex_);
  if (files_.empty()) {
    files_ = std::move(files);
    return;
  }
  for (const auto& [file, digest] : files) {
    const auto found = files_.find(file);
    if (found == files_.end())
      throw PluginError(
          fmt::format("its process names {} as a part of itself, which an earlier one did not", file.string()));
    if (found->second != digest)
      throw PluginError(
          fmt::format("{} has changed since the suite was read; start moma again to use the new one", file.string()));
  }
}

std::unique_ptr<Session> ProcessPool::take(const std::shared_ptr<const std::string>& setup, double control_period) {
  std::unique_ptr<Session> session;
  {
    const std::scoped_lock lock(mutex_);
    if (!idle_.empty()) {
      session = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  const bool fresh = session == nullptr;
  if (fresh) session = std::make_unique<Session>(command_);
  session->set_up(setup, control_period);
  if (fresh) check(*session);
  return session;
}

void ProcessPool::give_back(std::unique_ptr<Session> session) noexcept {
  if (session == nullptr || session->broken()) return;
  try {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(session));
  } catch (...) {  // no memory to keep it
  }
}

}  // namespace moma
