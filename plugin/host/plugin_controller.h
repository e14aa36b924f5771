#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/host/plugin.h"

namespace moma {

/// Room for what a plugin has to say.
using PluginText = std::array<char, 4096>;

/// Its words, as far as there are any, without control characters and what is no UTF-8; else `otherwise`.
std::string plugin_says(PluginText& text, const char* otherwise);

/// Runs `call`; false, with the reason, where an exception came out of the plugin.
template <typename Call>
bool plugin_call(std::string& thrown, Call call) {
  try {
    call();
    return true;
  } catch (const std::exception& e) {
    thrown = e.what();
  } catch (...) {
    thrown = "an exception of unknown type";
  }
  return false;
}

/// See Plugin::make().
class PluginController final : public StepController {
 public:
  explicit PluginController(std::shared_ptr<const Plugin> plugin);
  ~PluginController() override;
  PluginController(const PluginController&) = delete;
  PluginController& operator=(const PluginController&) = delete;

  void reset(std::span<const ObjectShape> objects) override;
  void step(const Observation& observation, StepResult& result) noexcept override;
  void prepare(StepResult& result) const override;
  std::string_view failure() const noexcept override { return failure_; }

 private:
  void stop() noexcept;
  void fail(std::string_view what, std::string_view detail, StepResult& result) noexcept;
  void read(StepResult& result) noexcept;

  std::shared_ptr<const Plugin> plugin_;
  void* controller_ = nullptr;
  const VectorX limits_;
  std::size_t num_objects_ = 0;
  std::vector<double> numbers_;  // of an observation
  VectorX command_;
  moma_observation seen_{};
  moma_step_result answer_{};
  StepResult checked_;  // its details
  PluginText text_{};
  std::string failure_;
};

}  // namespace moma
