// Public continuous-collision queries with exact truth: nothing may be missed, and a false alarm
// must be of features that pass within rounding of each other. Sources: Sample-Queries (Wang et al. 2021) and
// Sample-Scalable-CCD-Data; see the data folder's README.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "contact/ccd.h"
#include "contact/nearest.h"
#include "contact/penalty.h"
#include "contact/queries.h"
#include "support/shared_data.h"

namespace argil::contact {
namespace {

struct Count {
  int queries = 0;
  int hits = 0;
  int missed = 0;
  int false_alarms = 0;
};

/// Smallest distance of the two features over time, by sampling and ternary search; independent of the search
/// that is under test.
double measure_closest(PairKind kind, const PairPath& path) {
  const auto distance = [&](double t) {
    const std::array<Vec3, 4> p = interpolate(path, t);
    if (kind == PairKind::vertex_face)
      return std::sqrt(compute_nearest_on_triangle(p[0], p[1], p[2], p[3]).squared_distance);
    // The closest points of two segments: of the lines when both lie within, else an end and a segment.
    const Eigen::Vector2d s = compute_line_parameters(p);
    double least = 1e300;
    if (s.minCoeff() >= 0.0 && s.maxCoeff() <= 1.0)
      least = (p[0] + s(0) * (p[1] - p[0]) - p[2] - s(1) * (p[3] - p[2])).norm();
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t other = i < 2 ? 2 : 0;
      least = std::min(
          least,
          std::sqrt(compute_nearest_on_triangle(p[i], p[other], p[other], p[other + 1]).squared_distance));
    }
    return least;
  };
  constexpr int kSamples = 1000;
  double best = 0.0;
  for (int i = 0; i <= kSamples; ++i)
    if (distance(double(i) / kSamples) < distance(best)) best = double(i) / kSamples;
  double low = std::max(0.0, best - 1.0 / kSamples);
  double high = std::min(1.0, best + 1.0 / kSamples);
  for (int i = 0; i < 100; ++i) {
    const double a = low + (high - low) / 3.0;
    const double b = high - (high - low) / 3.0;
    (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
  }
  return std::min(distance(best), distance(0.5 * (low + high)));
}

void judge(PairKind kind, const QueryFile& file, const std::vector<bool>& truth, Count& count) {
  ASSERT_EQ(file.paths.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool hit = find_time_of_impact(kind, file.paths[i]).has_value();
    ++count.queries;
    count.hits += truth[i] ? 1 : 0;
    count.missed += truth[i] && !hit ? 1 : 0;
    if (truth[i] || !hit) continue;
    ++count.false_alarms;
    // The sets' coordinates are of size 1; rounding of the distance above is far below the bound.
    EXPECT_LE(measure_closest(kind, file.paths[i]), 1e-12) << "query " << i;
  }
}

class PublicQueries : public ::testing::TestWithParam<const char*> {};

TEST_P(PublicQueries, NothingIsMissedAndFalseAlarmsPassWithinRounding) {
  ARGIL_NEED_SHARED_DATA("ccd");
  const std::filesystem::path folder = test::shared_data(std::string("ccd/") + GetParam());
  for (const auto& [name, kind] :
       {std::pair{"vertex-face", PairKind::vertex_face}, std::pair{"edge-edge", PairKind::edge_edge}}) {
    Count count;
    for (const auto& entry : std::filesystem::directory_iterator(folder / name)) {
      const QueryFile file = read_queries(entry.path());
      judge(kind, file, file.truth, count);
    }
    std::printf("%-26s %-12s %5d queries, %4d meet, %d missed, %d false alarms\n", GetParam(), name,
                count.queries, count.hits, count.missed, count.false_alarms);
    EXPECT_GT(count.queries, 0);
    EXPECT_EQ(count.missed, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Ccd, PublicQueries,
                         ::testing::Values("unit-tests", "erleben-cube-cliff-edges", "erleben-sliding-spike",
                                           "erleben-spike-hole", "erleben-spikes", "erleben-wedges"),
                         [](const ::testing::TestParamInfo<const char*>& set) {
                           std::string name = set.param;
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

std::vector<bool> read_booleans(const std::string& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  std::vector<bool> out;
  std::string word;
  for (const char c : text.str()) {
    if (std::isalnum(static_cast<unsigned char>(c))) {
      word += c;
      continue;
    }
    if (word == "true" || word == "1") out.push_back(true);
    if (word == "false" || word == "0") out.push_back(false);
    word.clear();
  }
  return out;
}

struct Exact {
  std::size_t query = 0;
  double earliest = 0.0;
};

std::vector<Exact> read_exact_times(const std::string& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);  // header
  std::vector<Exact> out;
  while (std::getline(stream, line)) {
    std::stringstream cells(line);
    std::string query, solutions, time;
    std::getline(cells, query, ',');
    std::getline(cells, solutions, ',');
    std::getline(cells, time, ',');
    out.push_back({std::stoul(query), std::stod(time)});
  }
  return out;
}

TEST(Ccd, ClothFunnelTimesAreExactAndNeverLate) {
  ARGIL_NEED_SHARED_DATA("ccd/cloth-funnel");
  const std::string folder = test::shared_data("ccd/cloth-funnel/");
  for (const auto& [name, kind] :
       {std::pair{"227vf", PairKind::vertex_face}, std::pair{"227ee", PairKind::edge_edge}}) {
    const QueryFile file = read_queries(folder + "queries/" + name + ".csv");
    EXPECT_TRUE(file.truth.empty());
    Count count;
    judge(kind, file, read_booleans(folder + "mma_bool/" + name + "_mma_bool.json"), count);
    double earliest_error = 0.0;
    for (const Exact& exact : read_exact_times(folder + "cloth-funnel_" + name + "_toi.csv")) {
      const auto found = find_time_of_impact(kind, file.paths[exact.query]);
      ASSERT_TRUE(found) << name << " query " << exact.query;
      EXPECT_LE(*found, exact.earliest) << name << " query " << exact.query;
      earliest_error = std::max(earliest_error, exact.earliest - *found);
    }
    std::printf("cloth-funnel %s: %d queries, %d meet, %d missed, %d false alarms, early by at most %.1e\n",
                name, count.queries, count.hits, count.missed, count.false_alarms, earliest_error);
    EXPECT_EQ(count.missed, 0);
    EXPECT_EQ(count.false_alarms, 0);
    // Early by the rounding of a coordinate over the closing speed, which is slow in a near-grazing pass.
    EXPECT_LE(earliest_error, 1e-4);
  }
}

}  // namespace
}  // namespace argil::contact
