// What a continuous collision query costs, on the public query sets where they are present and on random
// pairs.
//   build/bin/bench_ccd
// all: detection as the simulation calls it · filter: the non-penetration filter alone · after_filter:
// detection of the queries that pass it · cubic: the roots of the coplanarity cubic and the penalty integral
// between them, without a filter. `passed` is the share of the queries that pass the filter; a time is that
// of one query.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/rng.h"
#include "contact/ccd.h"
#include "contact/penalty.h"
#include "contact/queries.h"

namespace argil::contact {
namespace {

enum class Set { public_sets, random };

const char* name_of(PairKind kind) {
  return kind == PairKind::vertex_face ? "vertex-face" : "edge-edge";
}

std::vector<PairPath> read_public_sets(PairKind kind) {
  std::vector<PairPath> paths;
  const std::filesystem::path folder = ARGIL_SHARED_DATA "/ccd";
  if (!std::filesystem::exists(folder)) return paths;
  for (const auto& set : std::filesystem::directory_iterator(folder)) {
    if (!std::filesystem::exists(set.path() / name_of(kind))) continue;
    for (const auto& file : std::filesystem::directory_iterator(set.path() / name_of(kind))) {
      const QueryFile queries = read_queries(file.path());
      paths.insert(paths.end(), queries.paths.begin(), queries.paths.end());
    }
  }
  return paths;
}

std::vector<PairPath> make_random_pairs() {
  Rng rng(1, "bench");
  std::vector<PairPath> paths(4096);
  for (PairPath& path : paths)
    for (std::size_t i = 0; i < 4; ++i) {
      for (Eigen::Index k = 0; k < 3; ++k) path.t0[i](k) = rng.uniform(-1.0, 1.0);
      for (Eigen::Index k = 0; k < 3; ++k) path.t1[i](k) = path.t0[i](k) + rng.uniform(-0.2, 0.2);
    }
  return paths;
}

template <class Query>
void run(benchmark::State& state, PairKind kind, Set set, bool only_passed, Query query) {
  std::vector<PairPath> paths = set == Set::random ? make_random_pairs() : read_public_sets(kind);
  if (paths.empty()) {
    state.SkipWithError("the public query sets are not beside the project");
    return;
  }
  const auto all = static_cast<double>(paths.size());
  std::vector<PairPath> passed;
  for (const PairPath& path : paths)
    if (filter_pair(kind, path).can_meet) passed.push_back(path);
  state.counters["passed"] = static_cast<double>(passed.size()) / all;
  if (only_passed) paths = passed;
  std::size_t i = 0;
  for (auto _ : state) {
    query(paths[i]);
    if (++i == paths.size()) i = 0;
  }
}

void all(benchmark::State& state, PairKind kind, Set set) {
  run(state, kind, set, false,
      [kind](const PairPath& path) { benchmark::DoNotOptimize(find_time_of_impact(kind, path)); });
}

void filter(benchmark::State& state, PairKind kind, Set set) {
  run(state, kind, set, false,
      [kind](const PairPath& path) { benchmark::DoNotOptimize(filter_pair(kind, path).can_meet); });
}

void after_filter(benchmark::State& state, PairKind kind, Set set) {
  run(state, kind, set, true,
      [kind](const PairPath& path) { benchmark::DoNotOptimize(find_time_of_impact(kind, path)); });
}

void cubic(benchmark::State& state, PairKind kind, Set set) {
  run(state, kind, set, false, [kind](const PairPath& path) {
    benchmark::DoNotOptimize(kind == PairKind::vertex_face ? compute_vertex_face_penalty(path, false)
                                                           : compute_edge_edge_penalty(path, false, 0.0));
  });
}

#define ARGIL_BENCH_QUERY(what)                                                    \
  BENCHMARK_CAPTURE(what, vertex_face, PairKind::vertex_face, Set::public_sets);   \
  BENCHMARK_CAPTURE(what, edge_edge, PairKind::edge_edge, Set::public_sets);       \
  BENCHMARK_CAPTURE(what, random_vertex_face, PairKind::vertex_face, Set::random); \
  BENCHMARK_CAPTURE(what, random_edge_edge, PairKind::edge_edge, Set::random)
ARGIL_BENCH_QUERY(all);
ARGIL_BENCH_QUERY(filter);
ARGIL_BENCH_QUERY(after_filter);
ARGIL_BENCH_QUERY(cubic);

}  // namespace
}  // namespace argil::contact

BENCHMARK_MAIN();
