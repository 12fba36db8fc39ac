// Ways to precondition the conjugate gradients on systems of a deformed body's steps (pressed_cube.h), solved
// from x = 0 until ‖b − A x‖ falls to a share of ‖b‖.
//   build/bin/bench_preconditioners [ROUNDS [TETS …]]
// Prints a row for each size and design: iterations and least wall time of a solve over the rounds, in each
// of which all designs have their turn. Every solution is checked with the matrix in double; what is not
// right ends the program with 1.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/check.h"
#include "linear/pcg.h"
#include "preconditioners/double_designs.h"
#include "preconditioners/pressed_cube.h"
#include "preconditioners/short_jacobi.h"
#include "preconditioners/short_ssor.h"

namespace argil::bench {
namespace {

constexpr int kMostIterations = 1000;
constexpr double kTolerances[] = {1e-1, 1e-2, 1e-3, 1e-8};

double seconds_of(const std::function<void()>& what) {
  const auto begin = std::chrono::steady_clock::now();
  what();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// What is compared. `solve` begins from any x and returns how many iterations it took, below 0 if it failed.
struct Design {
  std::string name;
  int threads = 1;
  bool is_short = false;  ///< in floats, not for the last tolerance
  double setup = 0.0;     ///< [s] once, or the least of `update`
  std::function<int(double tolerance, Points& x)> solve;
  std::function<void()> update = nullptr;  ///< of all that it keeps of the matrix
  int iterations[4] = {};
  double least[4] = {};  ///< [s]; 0: not solved to this tolerance
};

/// Designs over the project's own iteration in double.
template <class Made>
Design make_double(const StepSystem& system, const std::string& name, double setup,
                   std::shared_ptr<Made> made) {
  auto product = std::make_shared<linear::MatrixOperator>(system.matrix, 1);
  auto iteration = std::make_shared<linear::ConjugateGradients>(1);
  Design design{name, 1, false, setup, {}};
  design.solve = [&system, product, iteration, made](double tolerance, Points& x) {
    x.setZero(3, system.b.cols());
    const linear::SolveReport report =
        iteration->solve(*product, *made, system.b, tolerance, kMostIterations, x);
    return report.converged ? report.iterations : -1;
  };
  return design;
}

/// Designs with an iteration of their own, in floats.
template <class Made>
Design make_short(StepSystem& system, const std::string& name, int threads,
                  const std::shared_ptr<Made>& made) {
  Design design{name, threads, true, 0.0, {}};
  design.update = [&system, made] { made->update(system.matrix); };
  design.solve = [&system, made](double tolerance, Points& x) {
    const auto report = made->solve(system.b, tolerance, kMostIterations, x);
    return report.converged ? report.iterations : -1;
  };
  return design;
}

void add_jacobi(StepSystem& system, std::vector<Design>& designs) {
  auto jacobi = std::make_shared<linear::BlockJacobi>(1);
  linear::MatrixOperator product(system.matrix, 1);
  const double setup = seconds_of([&] { jacobi->update(system.matrix, product); });
  designs.push_back(make_double(system, "block_jacobi", setup, jacobi));
  for (const int threads : {1, 2})
    designs.push_back(
        make_short(system, "block_jacobi_floats", threads, std::make_shared<ShortJacobi>(threads)));
}

void add_eisenstat(StepSystem& system, std::vector<Design>& designs) {
  constexpr int kGroup = 256;
  const int num_rows = system.matrix.num_rows();
  const int num_small = std::max(1, (num_rows + kGroup / 2) / kGroup);
  const auto add = [&](const std::string& name, const SsorOrder& order, int most_threads) {
    for (int threads = 1; threads <= most_threads; ++threads)
      designs.push_back(make_short(system, "eisenstat_floats_" + name, threads,
                                   std::make_shared<ShortSsor>(system.matrix, order, threads)));
  };
  add("whole", make_groups(num_rows, 1), 1);
  for (const int groups : {2, 8}) add(std::to_string(groups) + "_groups", make_groups(num_rows, groups), 2);
  add("256_rows", make_groups(num_rows, num_small), 2);
  for (const int groups : {2, 4})
    add(std::to_string(groups) + "_separated", make_separated_groups(system.matrix, groups), 2);
}

/// Made and set up by `make`.
template <class Make>
void add_double(const StepSystem& system, const std::string& name, Make make, std::vector<Design>& designs) {
  decltype(make()) made;
  const double setup = seconds_of([&] { made = make(); });
  designs.push_back(make_double(system, name, setup, made));
}

/// A kept factor and what stands for it.
struct KeptFactor final : linear::Preconditioner {
  explicit KeptFactor(const linear::BlockMatrix& matrix) : factor(matrix) {
    ARGIL_ASSERT(factor.factorise(matrix));
  }
  double apply(const Points& r, Points& z) override { return stale.apply(r, z); }
  linear::CholeskyFactor factor;
  OrderedRuns rows{1};
  linear::StaleCholesky stale{factor, rows};
};

void add_others(const StepSystem& system, std::vector<Design>& designs) {
  using Kind = BlockFactor::Kind;
  add_double(
      system, "kept_factor", [&] { return std::make_shared<KeptFactor>(system.before); }, designs);
  add_double(
      system, "kept_scalar_factor", [&] { return std::make_shared<ScalarFactor>(system.before); }, designs);
  for (const int steps : {2, 3, 4})
    add_double(
        system, "chebyshev" + std::to_string(steps),
        [&] { return std::make_shared<Chebyshev>(system.matrix, steps); }, designs);
  add_double(
      system, "block_ssor", [&] { return std::make_shared<BlockFactor>(system.matrix, Kind::ssor); },
      designs);
  add_double(
      system, "block_ic0", [&] { return std::make_shared<BlockFactor>(system.matrix, Kind::incomplete); },
      designs);
  add_double(
      system, "two_level_additive", [&] { return std::make_shared<TwoLevel>(system.matrix, system.rest); },
      designs);
}

/// ‖b − A x‖ / ‖b‖ in double.
double compute_residual(const StepSystem& system, const Points& x) {
  Points product(3, x.cols());
  linear::MatrixOperator(system.matrix, 1).multiply(x, product);
  return (system.b - product).norm() / system.b.norm();
}

/// False, with a word on stderr, where a design's solution is none.
bool is_right(const StepSystem& system, const Design& design, double tolerance, int iterations,
              const Points& x) {
  constexpr double kSlack = 1.05;
  const double residual = compute_residual(system, x);
  if (iterations >= 0 && residual <= kSlack * tolerance) return true;
  std::fprintf(stderr, "%d tets, %s: residual %g, tolerance %g, iterations %d\n", system.num_tets,
               design.name.c_str(), residual, tolerance, iterations);
  return false;
}

bool measure(StepSystem& system, int rounds, std::vector<Design>& designs) {
  Points x;
  for (int round = 0; round < rounds; ++round)
    for (Design& design : designs) {
      if (design.update) {
        for (std::uint32_t& revision : system.matrix.revision) ++revision;
        const double seconds = seconds_of(design.update);
        design.setup = round == 0 ? seconds : std::min(design.setup, seconds);
      }
      (void)design.solve(kTolerances[0], x);  // brings its numbers into the cache
      for (std::size_t k = 0; k < (design.is_short ? 3 : 4); ++k) {
        int iterations = 0;
        const double seconds = seconds_of([&] { iterations = design.solve(kTolerances[k], x); });
        design.least[k] = round == 0 ? seconds : std::min(design.least[k], seconds);
        design.iterations[k] = iterations;
        if (round == 0 && !is_right(system, design, kTolerances[k], iterations, x)) return false;
      }
    }
  return true;
}

void print(const StepSystem& system, const std::vector<Design>& designs) {
  for (const Design& design : designs) {
    std::printf("%d,%s,%d,%d,%.3f", system.num_tets, design.name.c_str(), design.threads,
                system.matrix.num_rows(), 1e3 * design.setup);
    for (std::size_t k = 0; k < 4; ++k)
      if (design.least[k] > 0.0)
        std::printf(",%d,%.3f", design.iterations[k], 1e3 * design.least[k]);
      else
        std::printf(",,");
    std::printf("\n");
  }
  std::fflush(stdout);
}

bool run(int target_tets, int rounds) {
  constexpr double kRounding = 1e-6;  // of the solid's own step, solved to 1e-10
  StepSystem system = make_pressed_cube(target_tets);
  if (!(system.off <= kRounding)) {
    std::fprintf(stderr, "%d tets: the system is not the solid's, off by %g\n", system.num_tets, system.off);
    return false;
  }
  std::vector<Design> designs;
  add_jacobi(system, designs);
  add_others(system, designs);
  add_eisenstat(system, designs);
  const bool is_good = measure(system, rounds, designs);
  if (is_good) print(system, designs);
  return is_good;
}

std::string find_processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

std::string read_line(const char* command) {
  std::string line;
  if (FILE* pipe = popen(command, "r")) {
    char text[64] = {};
    if (std::fgets(text, sizeof text, pipe)) line = text;
    pclose(pipe);
  }
  while (!line.empty() && line.back() == '\n') line.pop_back();
  return line.empty() ? "unknown" : line;
}

}  // namespace
}  // namespace argil::bench

int main(int argc, char** argv) {
  using namespace argil::bench;
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 15;
  std::vector<int> sizes;
  for (int i = 2; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
  if (sizes.empty()) sizes = {2000, 10000, 40000};
  std::printf(
      "# an elastic cube of 6 cm, E = 140 kPa, h = 1 ms, pressed on a spot; commit %s, gcc %s, %s, least "
      "wall time of %d\n",
      read_line("git rev-parse --short HEAD 2>/dev/null").c_str(), __VERSION__, find_processor().c_str(),
      rounds);
  std::printf(
      "tets,design,threads,rows,setup_ms,iterations_1e-1,ms_1e-1,iterations_1e-2,ms_1e-2,iterations_1e-3,ms_"
      "1e-3,"
      "iterations_1e-8,ms_1e-8\n");
  for (const int tets : sizes)
    if (!run(tets, rounds)) return 1;
  return 0;
}
