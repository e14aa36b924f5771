#pragma once

#include <string>
#include <utility>
#include <vector>

#include "controller/config/node.h"
#include "controller/describe/keys.h"

namespace moma {

/// Values for some of a suite's keys: one point of a sweep, in the order of the axes.
using Assignment = std::vector<std::pair<std::string, config::Node>>;

/// Reads `sweep`:
///   {design: grid, axes: {KEY: AXIS, ...}}                            every combination, the last axis fastest
///   {design: latin_hypercube, axes: ..., n: N, seed: S}               N points, one in each N-th of every axis
///   {design: sobol, axes: ..., n: N}                                  the first N points of the Sobol sequence
///   {points: [{KEY: VALUE, ...}, ...]}                                as listed (`design: list` is optional)
/// AXIS is a list of values, or {linear: [a, b], n: k} or {log: [a, b], n: k}; `n` belongs to grids only. KEY is any
/// dotted key of the suite; `controller.X` means X of all controllers. Computed numbers are rounded to six significant
/// digits, or to as many as keep neighbours distinct, and the ends of an axis stay as written, so that a label shows
/// the whole value. In latin_hypercube and sobol an axis with a list takes each of its values for an equal share of the
/// points (within one for latin_hypercube). Throws config::ConfigError.
std::vector<Assignment> read_sweep(const config::Node& node, const std::string& key);

std::vector<Key> sweep_keys(const std::string& prefix = "sweep");

/// Returns "lambda_q" for "controller.lambda_q", other keys in full.
std::string short_key(const std::string& key);

inline constexpr std::size_t kMaxSweepPoints = 100000;

/// Returns n points in the unit cube of `dimensions`, one in each n-th of every axis (McKay, Beckman & Conover 1979); a
/// pure function of its arguments. Rows are points.
std::vector<std::vector<double>> latin_hypercube(std::uint64_t seed, std::size_t n, std::size_t dimensions);
/// Returns the first n points of the Sobol sequence (Joe & Kuo's direction numbers, by Boost.Random), without the
/// origin.
std::vector<std::vector<double>> sobol(std::size_t n, std::size_t dimensions);

}  // namespace moma
