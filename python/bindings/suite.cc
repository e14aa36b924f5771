#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "controller/config/json_node.h"
#include "python/bindings/bindings.h"
#include "world/world_json.h"

namespace moma::python {

const SuitePoint& point_of(const Suite& suite, std::size_t i) {
  if (i < suite.points.size()) return suite.points[i];
  throw std::invalid_argument("point: found " + std::to_string(i) + ", the suite has " +
                              std::to_string(suite.points.size()));
}

World make_world(const SuitePoint& point, std::uint64_t index) {
  const long long size = point.worlds.size();
  if (size >= 0 && index >= static_cast<std::uint64_t>(size)) {
    throw std::invalid_argument("world " + std::to_string(index) + ": the suite's frozen set has the worlds 0 to " +
                                std::to_string(size - 1));
  }
  return point.worlds.make(point.robot->model, index);
}

void bind_suite(nb::module_& module) {
  nb::class_<Suite>(module, "Suite")
      .def_static("load", [](const std::string& file, const Overrides& changes) { return load_suite(file, changes); })
      .def_prop_ro("trials", [](const Suite& suite) { return suite.trials; })
      .def_prop_ro("resolved", [](const Suite& suite) { return suite.resolved.dump(); })
      .def_prop_ro("points",
                   [](const Suite& suite) {
                     std::vector<std::pair<std::string, std::string>> names;
                     for (const SuitePoint& point : suite.points) names.emplace_back(point.controller, point.label);
                     return names;
                   })
      .def("world", [](const Suite& suite, std::size_t point, std::uint64_t index) {
        const nb::gil_scoped_release release;
        return to_json(make_world(point_of(suite, point), index)).dump();
      });
  module.def("read_world", [](const std::string& json, const std::string& name) {
    return to_json(world_from_json(config::parse_json(json, name), name)).dump();
  });
  module.def("read_file", [](const std::string& file) { return config::node_to_json(config::load_yaml(file)).dump(); });
}

}  // namespace moma::python
