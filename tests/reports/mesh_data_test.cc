// Robots' looks in the page: what clustering keeps, and that what is packed reads back.
#include "reports/render/mesh_data.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <tuple>

#include "reports/render/report.h"
#include "tests/reports/packed_text.h"
#include "tests/reports/store_files.h"

namespace moma::reports {
namespace {

/// A ball of radius 0.5 about (1, 2, 3), as an STL has it: each triangle with corners of its own.
Surface ball(int rings) {
  Surface out;
  const auto at = [&](int i, int j) -> Point3 {
    const double a = M_PI * i / rings;
    const double b = M_PI * (j % (2 * rings)) / rings;  // the same bits where the round closes
    const double r = i == 0 || i == rings ? 0.0 : 0.5 * std::sin(a);
    return {1 + r * std::cos(b), 2 + r * std::sin(b), 3 + 0.5 * std::cos(a)};
  };
  const auto add = [&](const Point3& a, const Point3& b, const Point3& c) {
    const int n = static_cast<int>(out.vertices.size());
    out.vertices.insert(out.vertices.end(), {a, b, c});
    out.triangles.push_back({n, n + 1, n + 2});
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < 2 * rings; ++j) {
      if (i > 0) add(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i + 1 < rings) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return out;
}

/// Volume that a closed surface encloses, by the divergence theorem: wrong turns and holes show in it.
double volume(const Surface& s) {
  double sum = 0.0;
  for (const auto& t : s.triangles) {
    const auto& [a, b, c] =
        std::tuple{s.vertices[static_cast<std::size_t>(t[0])], s.vertices[static_cast<std::size_t>(t[1])],
                   s.vertices[static_cast<std::size_t>(t[2])]};
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6.0;
}

TEST(Clustering, JoinsCornersAndKeepsTheForm) {
  const Surface fine = ball(40);
  const Surface joined = clustered(fine, 1e-6);
  EXPECT_EQ(joined.triangles.size(), fine.triangles.size()) << "so fine a grid only joins equal corners";
  EXPECT_EQ(joined.vertices.size(), 39u * 80u + 2u);
  EXPECT_NEAR(volume(joined), volume(fine), 1e-9);

  const double cell = 0.05;
  const Surface coarse = clustered(fine, cell);
  EXPECT_LT(coarse.triangles.size(), fine.triangles.size() / 2);
  EXPECT_GT(coarse.triangles.size(), 200u);
  for (const Point3& p : coarse.vertices)
    EXPECT_NEAR(std::hypot(p[0] - 1, p[1] - 2, p[2] - 3), 0.5, std::sqrt(3.0) * cell)
        << "no further than a cell's diagonal";
  EXPECT_NEAR(volume(coarse), volume(fine), 0.06 * volume(fine));
  std::set<std::array<int, 3>> seen;
  for (const auto& t : coarse.triangles) {
    EXPECT_TRUE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    EXPECT_TRUE(seen.insert(t).second);
  }
  EXPECT_EQ(clustered(fine, cell).vertices, coarse.vertices) << "the same every time";
  EXPECT_TRUE(clustered(fine, 100.0).triangles.empty()) << "all in one cube";
}

std::vector<std::uint16_t> values_of(const std::string& text, std::size_t most) {
  const std::vector<unsigned char> bytes = unpacked(text, most);
  std::vector<std::uint16_t> out(bytes.size() / 2);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<std::uint16_t>(bytes[i] | bytes[out.size() + i] << 8);
  return out;
}

TEST(MeshData, ReadsBackWithinItsSteps) {
  VisualPart part;
  part.link = "arm";
  part.position = {0.1, 0.2, 0.3};
  part.rotation = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  part.colour = Point3{1, 0.5, 0};
  part.surface = ball(60);
  VisualPart box;
  box.link = "base";
  box.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  box.shape = {{"shape", "box"}, {"size", {0.1, 0.2, 0.3}}};
  const nlohmann::json data = mesh_data({part, box}, 3000);
  ASSERT_EQ(data.size(), 2u);
  EXPECT_EQ(data[1].at("shape"), "box");
  EXPECT_FALSE(data[1].contains("colour"));
  EXPECT_EQ(data[0].at("link"), "arm");
  EXPECT_EQ(data[0].at("rotation").get<std::vector<double>>()[1], -1.0);
  EXPECT_EQ(data[0].at("colour").get<std::vector<double>>()[1], 0.5);

  const auto places = values_of(data[0].at("vertices"), 1 << 20);
  const auto changes = values_of(data[0].at("triangles"), 1 << 20);
  ASSERT_EQ(places.size(), 3 * data[0].at("n").get<std::size_t>());
  ASSERT_EQ(changes.size() % 3, 0u);
  EXPECT_LE(changes.size() / 3, 3000u);
  EXPECT_GT(changes.size() / 3, 1500u) << "no coarser than it has to be";
  Surface back;
  const auto low = data[0].at("low").get<Point3>();
  const double step = data[0].at("step");
  for (std::size_t i = 0; i < places.size(); i += 3)
    back.vertices.push_back({low[0] + step * places[i], low[1] + step * places[i + 1], low[2] + step * places[i + 2]});
  std::uint16_t last = 0;
  for (std::size_t i = 0; i < changes.size(); i += 3) {
    std::array<int, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) t[k] = last = static_cast<std::uint16_t>(last + changes[i + k]);
    back.triangles.push_back(t);
    for (const int index : t) ASSERT_LT(static_cast<std::size_t>(index), back.vertices.size());
  }
  EXPECT_NEAR(volume(back), volume(part.surface), 0.06 * volume(part.surface));
}

TEST(MeshData, IsInThePageOnceForEachRobot) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 6);
  ReportOptions options;
  int asked = 0;
  options.look = [&](const nlohmann::ordered_json& robot) {
    ++asked;
    EXPECT_EQ(robot.at("name"), "courier");
    VisualPart part;
    part.link = "link2";
    part.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    part.surface = ball(8);
    return std::vector{part};
  };
  const nlohmann::json page = page_of({folder / "a.db"}, options);
  EXPECT_EQ(asked, 1);
  ASSERT_EQ(page.at("looks").size(), 1u);
  EXPECT_EQ(page.at("looks").begin().key(), page.at("replays").at(0).at("robot"));
  options.look = [](const nlohmann::ordered_json&) { return std::vector<VisualPart>(); };
  EXPECT_TRUE(page_of({folder / "a.db"}, options).at("looks").empty());
}

}  // namespace
}  // namespace moma::reports
