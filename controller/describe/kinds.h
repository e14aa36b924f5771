#pragma once

#include <Eigen/Core>
#include <array>
#include <concepts>
#include <optional>
#include <span>
#include <vector>

namespace moma {

/// Kinds of member types that visitors distinguish.

/// Whole numbers, without booleans.
template <class T>
concept WholeNumber = std::integral<T> && !std::same_as<T, bool>;

/// Sequences of numbers with a constant length: Eigen's fixed vectors, std::array<double, N>.
template <class T>
inline constexpr int fixed_length = 0;
template <int N>
inline constexpr int fixed_length<Eigen::Matrix<double, N, 1>> = N == Eigen::Dynamic ? 0 : N;
template <std::size_t N>
inline constexpr int fixed_length<std::array<double, N>> = static_cast<int>(N);

/// Sequences of numbers with any length: Eigen::VectorXd, std::vector<double>.
template <class T>
concept NumberList = std::same_as<T, Eigen::VectorXd> || std::same_as<T, std::vector<double>>;

template <class T>
concept Numbers = fixed_length<T> >
0 || NumberList<T>;

template <Numbers T>
std::span<const double> numbers_of(const T& list) {
  return {list.data(), static_cast<std::size_t>(list.size())};
}

template <class T>
inline constexpr bool is_std_optional = false;
template <class T>
inline constexpr bool is_std_optional<std::optional<T>> = true;

/// Lists of anything but numbers.
template <class T>
inline constexpr bool is_std_vector = false;
template <class T>
inline constexpr bool is_std_vector<std::vector<T>> = !std::same_as<T, double>;

}  // namespace moma
