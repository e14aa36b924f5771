#include <nanobind/nanobind.h>

#include <stdexcept>

#include "controller/config/json_node.h"
#include "python/bindings/bindings.h"

namespace moma::python {

void check_size(Eigen::Index found, Eigen::Index wanted, const char* what) {
  if (found == wanted) return;
  throw std::invalid_argument(std::string(what) + ": found " + std::to_string(found) + " numbers, expected " +
                              std::to_string(wanted));
}

config::Node node_of(const std::string& json, const std::string& name) {
  return config::node_from_json(config::parse_json(json, name), name);
}

}  // namespace moma::python

NB_MODULE(_core, module) {
  module.doc() = "moma's controller library; the package moma has the face of it.";
  nanobind::exception<moma::config::ConfigError>(module, "ConfigError", PyExc_ValueError);
  moma::python::bind_robot(module);
  moma::python::bind_controller(module);
  moma::python::bind_case(module);
  moma::python::bind_suite(module);
  moma::python::bind_trials(module);
}
