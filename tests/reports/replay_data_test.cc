#include "reports/render/replay_data.h"

#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>
#include <zlib.h>
#include <zstd.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>

#include "reports/render/report.h"
#include "tests/reports/packed_text.h"
#include "tests/reports/store_files.h"

namespace moma::reports {
namespace {

using Table = std::map<std::string, std::vector<double>>;

/// What the page's script does, written again here: byte planes, float32 columns.
Table unpack(const nlohmann::json& replay) {
  const std::size_t n = replay.at("n").get<std::size_t>();
  const auto names = replay.at("columns").get<std::vector<std::string>>();
  const std::size_t count = n * names.size();
  const std::vector<unsigned char> planes = unpacked(replay.at("data"), 4 * count);
  EXPECT_EQ(planes.size(), 4 * count);
  Table table;
  for (std::size_t i = 0; i < count; ++i) {
    unsigned char bytes[4];
    for (std::size_t k = 0; k < 4; ++k) bytes[k] = planes[k * count + i];
    float value;
    std::memcpy(&value, bytes, 4);
    table[names[i / n]].push_back(value);
  }
  return table;
}

/// The same of numbers of 16 bits, of which `n` are expected.
std::vector<int> numbers16(const nlohmann::json& data, std::size_t n) {
  const std::vector<unsigned char> bytes = unpacked(data, 2 * n);
  std::vector<int> values;
  EXPECT_EQ(bytes.size(), 2 * n);
  for (std::size_t i = 0; 2 * i < bytes.size(); ++i)
    values.push_back(static_cast<std::int16_t>(static_cast<unsigned>(bytes[i]) |
                                               static_cast<unsigned>(bytes[bytes.size() / 2 + i]) << 8));
  return values;
}

/// Samples of `n` steps of 20 ms with recognizable numbers, and their zstd frame.
struct Made {
  std::vector<double> values;
  std::string frame;
  StoredSamples samples;

  explicit Made(int n) {
    samples.columns = {"t",      "base_x",   "base_y",     "base_phi", "q0", "q1", "manipulability", "least_distance",
                       "status", "fallback", "active_rows"};
    for (int i = 0; i < 6; ++i) samples.columns.push_back("error" + std::to_string(i));
    for (int i = 0; i < 6; ++i) samples.columns.push_back("slack" + std::to_string(i));
    samples.layout = 1;
    samples.n = n;
    for (std::size_t c = 0; c < samples.columns.size(); ++c) {
      for (int i = 0; i < n; ++i) values.push_back(c == 0 ? 0.02 * i : static_cast<double>(c) + 0.001 * i);
    }
    pack();
  }

  void pack() {
    frame.resize(ZSTD_compressBound(values.size() * 8));
    frame.resize(ZSTD_compress(frame.data(), frame.size(), values.data(), values.size() * 8, 3));
    samples.data = frame;
  }
};

TEST(ReplayData, KeepsTenSamplesASecondWithFirstAndLast) {
  const Made made(128);
  const Table table = unpack(replay_data(made.samples, 10.0));
  const std::vector<double>& t = table.at("t");
  ASSERT_EQ(t.size(), 27u);  // 0, 0.1 ... 2.5 and the last, 2.54
  for (std::size_t i = 0; i + 1 < t.size(); ++i) EXPECT_NEAR(t[i], 0.1 * static_cast<double>(i), 1e-6);
  EXPECT_NEAR(t.back(), 2.54, 1e-6);
}

TEST(ReplayData, ValuesAreTheStoredOnes) {
  const Made made(60);
  const Table table = unpack(replay_data(made.samples, 50.0));
  ASSERT_EQ(table.at("t").size(), 60u);
  for (std::size_t i = 0; i < 60; ++i) {
    const double x = 0.001 * static_cast<double>(i);
    EXPECT_EQ(table.at("base_phi")[i], static_cast<float>(3 + x));
    EXPECT_EQ(table.at("q1")[i], static_cast<float>(5 + x));
    EXPECT_EQ(table.at("active_rows")[i], static_cast<float>(10 + x));
    // error0 is column 11: rotation 11, 12, 13; position 14, 15, 16; slack 17 ... 22
    EXPECT_FLOAT_EQ(static_cast<float>(table.at("error_rotation")[i]),
                    static_cast<float>(std::hypot(11 + x, 12 + x, 13 + x)));
    EXPECT_FLOAT_EQ(static_cast<float>(table.at("error_position")[i]),
                    static_cast<float>(std::hypot(14 + x, 15 + x, 16 + x)));
    EXPECT_FLOAT_EQ(
        static_cast<float>(table.at("slack")[i]),
        static_cast<float>(std::hypot(std::hypot(17 + x, 18 + x, 19 + x), std::hypot(20 + x, 21 + x, 22 + x))));
  }
}

TEST(ReplayData, InfiniteDistancesStay) {
  Made made(3);
  for (std::size_t i = 0; i < 3; ++i) made.values[7 * 3 + i] = std::numeric_limits<double>::infinity();
  made.pack();
  EXPECT_TRUE(std::isinf(unpack(replay_data(made.samples, 10.0)).at("least_distance")[0]));
}

// What a controller was about goes along where it looks ahead, whatever the samples have of it.
TEST(ReplayData, PlansComeAlongWhereThereAreAny) {
  Made made(5);
  for (const char* name : {"plan_mode", "plan_reason", "plan_target_x", "detour", "detour_x"}) {
    made.samples.columns.push_back(name);
    for (int i = 0; i < 5; ++i) made.values.push_back(0.0);
  }
  made.pack();
  EXPECT_EQ(unpack(replay_data(made.samples, 50.0)).count("plan_mode"), 0u);
  made.values[made.values.size() - 16] = 4.0;  // the reason, in the last sample
  made.values[made.values.size() - 15] = 1.5;  // the target, in the first
  made.pack();
  const Table table = unpack(replay_data(made.samples, 50.0));
  EXPECT_EQ(table.at("plan_reason"), (std::vector<double>{0, 0, 0, 0, 4}));
  EXPECT_EQ(table.at("plan_target_x"), (std::vector<double>{1.5, 0, 0, 0, 0}));
  EXPECT_EQ(table.count("detour_x"), 1u);
  EXPECT_EQ(table.count("detour_y"), 0u) << "older samples have less";
}

// In tenths of a millimetre and millimetres, those of the samples that are kept.
TEST(ReplayData, RowsComeWithTheirSamples) {
  const Made made(11);  // 0, 0.02 ... 0.2 s
  using Kind = DistanceRows::Kind;
  const DistanceRows rows{{"hand", "sphere3"},
                          {{0.0, Kind::kObject, 0, 1, true, 0.25, {0.5, -1, 2}, {0.75, 0, 40}},
                           {0.0, Kind::kFloor, 0, 1, false, -0.01, {0.001, 0, 0}, {0, 0, 0}},
                           {0.02, Kind::kFloor, 0, 1, true, 0.1, {}, {}},
                           {0.1, Kind::kSelf, 1, 0, false, 0.0, {}, {}}}};
  const nlohmann::json packed = replay_data(made.samples, 10.0, &rows).at("rows");
  EXPECT_EQ(packed.at("names"), nlohmann::json({"hand", "sphere3"}));
  EXPECT_EQ(packed.at("n"), nlohmann::json({2, 1, 0}));
  EXPECT_EQ(numbers16(packed.at("data"), 30),
            (std::vector<int>{8,     1, 2, 0,    0, 1, 1,   1, 0, 2500, -100, 0, 500,   1, 0,
                              -1000, 0, 0, 2000, 0, 0, 750, 0, 0, 0,    0,    0, 32767, 0, 0}));
  EXPECT_FALSE(replay_data(made.samples, 10.0).contains("rows"));
}

// Boxes in cells, as 16-bit numbers column by column, and looks as float32.
TEST(ReplayData, AMapAndWhereSensorsLooked) {
  const Made made(11);
  const MapMotion map{0.05,
                      4.0,
                      {{0, 3, true, {-20, 1, 2}, {-18, 2, 12}}, {1, 2, false, {300, 0, 0}, {301, 16, 1}}},
                      {{2, 0.5, -1.25, 0.75}, {2, 0.625, 0.0, 0.5}}};
  const nlohmann::json packed = replay_data(made.samples, 10.0, nullptr, &map).at("map");
  EXPECT_EQ(packed.at("cell"), 0.05);
  EXPECT_EQ(packed.at("hz"), 4.0);
  EXPECT_EQ(numbers16(packed.at("data"), 18),
            (std::vector<int>{0, 1, 3, 2, 1, 0, -20, 300, 1, 0, 2, 0, 2, 1, 1, 16, 10, 1}));
  EXPECT_EQ(replay_data(made.samples, 10.0, nullptr, &map).count("rows"), 0u);
  nlohmann::json looks = packed.at("looks");
  looks["columns"] = {"sensor", "t", "pan", "tilt"};
  EXPECT_EQ(unpack(looks),
            (Table{{"sensor", {2, 2}}, {"t", {0.5, 0.625}}, {"pan", {-1.25, 0}}, {"tilt", {0.75, 0.5}}}));
  const MapMotion none;
  EXPECT_FALSE(replay_data(made.samples, 10.0, nullptr, &none).contains("map"));
}

TEST(ReplayData, OneSample) { EXPECT_EQ(unpack(replay_data(Made(1).samples, 10.0)).at("t").size(), 1u); }

TEST(ReplayData, RefusesWhatDoesNotFit) {
  Made made(10);
  made.samples.layout = 7;
  EXPECT_THROW(replay_data(made.samples, 10.0), std::runtime_error);
  made.samples.layout = 1;
  made.samples.n = 11;
  EXPECT_THROW(replay_data(made.samples, 10.0), std::runtime_error);
  made.samples.n = 10;
  made.samples.columns[4] = "x";
  EXPECT_NO_THROW(replay_data(made.samples, 10.0));  // a robot may have no q0
  made.samples.columns[0] = "x";
  EXPECT_THROW(replay_data(made.samples, 10.0), std::runtime_error);
}

TEST(Replays, TheWorstOfEachKindComeFirst) {
  const Folder folder;
  make_store(folder / "a.db", "failures", 60);
  SQLite::Database store((folder / "a.db").string());
  const int kinds = store
                        .execAndGet(
                            "SELECT count(DISTINCT p.controller || t.outcome || coalesce(t.link, '')) FROM "
                            "samples x JOIN trial t ON t.key = x.key JOIN point_trial m ON m.key = t.key "
                            "JOIN point p ON p.id = m.point_id")
                        .getInt();
  ReportOptions options;
  options.replays = kinds;
  const nlohmann::json data = page_of({folder / "a.db"}, options);
  ASSERT_EQ(data.at("replays").size(), static_cast<std::size_t>(kinds));
  EXPECT_EQ(data.at("robots").size(), 1u);
  std::set<std::string> seen;
  SQLite::Statement query(store,
                          "SELECT controller || outcome || coalesce(link, ''), (SELECT count(*) FROM v_trials b "
                          "JOIN trial u ON u.trial = b.trial JOIN samples x ON x.key = u.key WHERE "
                          "b.controller = a.controller AND b.outcome = a.outcome AND b.link IS a.link AND "
                          "iif(a.outcome = 'collision', b.collision_depth_m > a.collision_depth_m, "
                          "b.position_error_m + b.orientation_error_rad > a.position_error_m + "
                          "a.orientation_error_rad)) FROM v_trials a WHERE trial = ?");
  for (const nlohmann::json& replay : data.at("replays")) {
    query.reset();
    query.bind(1, replay.at("trial").get<std::string>());
    ASSERT_TRUE(query.executeStep());
    EXPECT_TRUE(seen.insert(query.getColumn(0).getString()).second) << "two of one kind before one of each";
    EXPECT_EQ(query.getColumn(1).getInt(), 0) << "a worse trial of this kind has samples";
    EXPECT_TRUE(replay.at("world").at("goal").contains("position"));
  }
}

TEST(Replays, NoneWhenNoneAreWanted) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 20);
  ReportOptions options;
  options.replays = 0;
  const nlohmann::json data = page_of({folder / "a.db"}, options);
  EXPECT_TRUE(data.at("replays").empty());
  EXPECT_GT(data.at("samples_stored"), 0);
}

}  // namespace
}  // namespace moma::reports
