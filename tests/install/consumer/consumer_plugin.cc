#include <plugin/plugin.h>

#include <controller/controller.h>

// moma's own controller with another servo gain, behind the plugin's border.
std::unique_ptr<moma::Controller> make(const moma::plugin::Setup& setup) {
  moma::ControllerParams params;
  moma::config::MapReader in(setup.parameters, "parameters");
  in.read("gain", params.servo.position, moma::config::Range::positive());
  in.finish();
  return std::make_unique<moma::Controller>(setup.robot, params, setup.control_period);
}

MOMA_PLUGIN(make)
