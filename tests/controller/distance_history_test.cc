// A distance depends on its pair alone, not on what the process measured before. In a program of its own, since what is
// looked for is state that lives as long as the process: each history begins in a process without any.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <functional>
#include <random>
#include <vector>

#include "controller/model/proximity.h"
#include "tests/support/shapes.h"

namespace moma {
namespace {

using test::make_box;
using test::make_cylinder;
using test::placed;

constexpr ShapeKind kKinds[] = {ShapeKind::kBox, ShapeKind::kCylinder, ShapeKind::kCapsule, ShapeKind::kSphere,
                                ShapeKind::kConvex};
constexpr int kPairsOfKinds = 20;
constexpr std::size_t kNumbers = 10;  // of one Distance

std::vector<double> all_distances() {
  std::mt19937 engine(11);
  std::vector<double> numbers;
  for (const ShapeKind first : kKinds) {
    for (const ShapeKind second : kKinds) {
      for (int i = 0; i < kPairsOfKinds; ++i) {
        const Shape a = test::random_shape(first, engine), b = test::random_shape(second, engine);
        const Isometry X_a = test::random_pose(engine, 0.4), X_b = test::random_pose(engine, 0.4);
        const Distance found = shape_distance(a, X_a, b, X_b);
        numbers.push_back(found.d);
        for (const Vector3& v : {found.n_W, found.p_first_W, found.p_second_W})
          numbers.insert(numbers.end(), v.data(), v.data() + 3);
      }
    }
  }
  return numbers;
}

// What all_distances() gives in a new process that did `before` first; empty where something went wrong.
std::vector<double> after(const std::function<void()>& before) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    before();
    const std::vector<double> numbers = all_distances();
    std::size_t sent = 0;
    const std::size_t size = numbers.size() * sizeof(double);
    while (sent < size) {
      const ssize_t some = write(ends[1], reinterpret_cast<const char*>(numbers.data()) + sent, size - sent);
      if (some <= 0) _exit(1);
      sent += static_cast<std::size_t>(some);
    }
    _exit(0);
  }
  close(ends[1]);
  std::vector<char> bytes;
  char buffer[4096];
  for (ssize_t some = 0; (some = read(ends[0], buffer, sizeof buffer)) > 0;)
    bytes.insert(bytes.end(), buffer, buffer + some);
  close(ends[0]);
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0) return {};
  std::vector<double> numbers(bytes.size() / sizeof(double));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
  return numbers;
}

TEST(DistanceHistory, LeavesNoTrace) {
  const std::vector<double> none = after([] {});
  ASSERT_EQ(none.size(), std::size(kKinds) * std::size(kKinds) * kPairsOfKinds * kNumbers);
  // The first direction in which a box is asked for its support: along an axis, and along none.
  const std::vector<double> straight = after([] {
    shape_distance(make_box(1, 1, 1), placed({0, 0, 0}), make_box(1, 1, 1), placed({3, 0, 0}));
  });
  const std::vector<double> oblique = after([] {
    shape_distance(make_cylinder(0.1, 1), placed({0, 0, 0}), make_box(1, 1, 1), placed({3, 1, 2}, {0.3, 0.5, 0.7}));
  });
  ASSERT_EQ(straight.size(), none.size());
  ASSERT_EQ(oblique.size(), none.size());
  int differ = 0;
  for (std::size_t i = 0; i < none.size(); ++i) {
    const bool same = std::memcmp(&none[i], &straight[i], sizeof(double)) == 0 &&
                      std::memcmp(&none[i], &oblique[i], sizeof(double)) == 0;
    if (same || differ++ >= 5) continue;
    const std::size_t pair = i / kNumbers / kPairsOfKinds;
    ADD_FAILURE() << "kinds " << static_cast<int>(kKinds[pair / std::size(kKinds)]) << " and "
                  << static_cast<int>(kKinds[pair % std::size(kKinds)]) << ", number " << i % kNumbers << ": "
                  << none[i] << " in a new process, " << straight[i] - none[i] << " more after a straight pair, "
                  << oblique[i] - none[i] << " more after an oblique one";
  }
  EXPECT_EQ(differ, 0);
}

}  // namespace
}  // namespace moma
