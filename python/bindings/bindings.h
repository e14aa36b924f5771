#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <initializer_list>
#include <string>

#include "controller/config/node.h"
#include "controller/describe/numbers.h"
#include "controller/step_described.h"

namespace moma::python {

namespace nb = nanobind;

/// Arrays as the Python side hands them over: whole, of doubles, row by row. It checks and reshapes; these only say
/// what came where a size is wrong.
using Rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Values = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Array = nb::ndarray<nb::numpy, double>;

/// A new array of this shape, and where its numbers are.
Array make_array(std::initializer_list<std::size_t> shape, double*& data);

/// The numbers of a described value (describe/numbers.h).
template <class T>
Array packed(const T& value) {
  double* data = nullptr;
  Array out = make_array({count_numbers(value)}, data);
  pack(value, data);
  return out;
}

/// Throws std::invalid_argument unless there are `wanted` of them.
void check_size(std::size_t found, std::size_t wanted, const char* what);

/// A value of a file's format, from JSON; `name` stands for the file in messages, paths are relative to the working
/// folder.
config::Node node_of(const std::string& json, const std::string& name);

void bind_robot(nb::module_& module);
void bind_controller(nb::module_& module);
void bind_case(nb::module_& module);
void bind_suite(nb::module_& module);
void bind_trials(nb::module_& module);

}  // namespace moma::python
