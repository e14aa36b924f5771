// A class with the step interface as a plugin: `is: echo` runs moma's own controller with the default parameters, so
// that a plugin can be held against the same controller without one, `is: tracked` one that takes account of
// uncertainty; others are faulty on purpose.
#include "controller/controller.h"
#include "plugin/plugin.h"

namespace {

using namespace moma;

class Classy {
 public:
  Classy(const plugin::Setup& setup, std::string kind)
      : kind_(std::move(kind)), inner_(setup.robot, parameters(kind_), setup.control_period) {}
  void reset(std::span<const ObjectShape> objects) {
    if (kind_ == "late") throw std::runtime_error("not among " + std::to_string(objects.size()) + " objects");
    inner_.reset(objects);
  }
  void prepare(StepResult& result) const { inner_.prepare(result); }
  void step(const Observation& seen, StepResult& result) {
    if (kind_ == "throwing" && seen.time > 0.05) throw std::runtime_error("time is up");
    inner_.step(seen, result);
    if (kind_ == "short" && seen.time > 0.05) result.command.conservativeResize(result.command.size() - 1);
    if (kind_ == "long" && seen.time > 0.05) result.command = VectorX::Zero(100);
  }

 private:
  static ControllerParams parameters(const std::string& kind) {
    ControllerParams params;
    params.prediction.enabled = params.uncertainty.enabled = kind == "tracked";
    return params;
  }
  std::string kind_;
  Controller inner_;
};

std::unique_ptr<Classy> make(const plugin::Setup& setup) {
  std::string kind = "echo";
  config::MapReader in(setup.parameters, "parameters");
  in.read("is", kind);
  in.finish();
  return std::make_unique<Classy>(setup, kind);
}

}  // namespace

MOMA_PLUGIN(make)
