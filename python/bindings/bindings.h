#pragma once

#include <nanobind/eigen/dense.h>
#include <nanobind/nanobind.h>

#include <string>

#include "controller/config/node.h"
#include "controller/describe/numbers.h"
#include "controller/step_described.h"
#include "eval/suite/suite.h"

namespace moma::python {

namespace nb = nanobind;

/// An array of two dimensions, row by row; Python reshapes what has more of them, a row for each configuration.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Rows = Eigen::Ref<const Matrix>;

/// The numbers of a described value (describe/numbers.h).
template <class T>
VectorX packed(const T& value) {
  VectorX out(static_cast<Eigen::Index>(count_numbers(value)));
  pack(value, out.data());
  return out;
}

/// Throws std::invalid_argument unless there are `wanted` of them.
void check_size(Eigen::Index found, Eigen::Index wanted, const char* what);

/// A value of a file's format, from JSON; `name` stands for the file in messages, paths are relative to the working
/// folder.
config::Node node_of(const std::string& json, const std::string& name);

/// Throws std::invalid_argument where the suite has no point of that number.
const SuitePoint& point_of(const Suite& suite, std::size_t i);

/// World `index` of a point. Throws GenerationError.
World make_world(const SuitePoint& point, std::uint64_t index);

void bind_robot(nb::module_& module);
void bind_controller(nb::module_& module);
void bind_case(nb::module_& module);
void bind_suite(nb::module_& module);
void bind_trials(nb::module_& module);

}  // namespace moma::python
