#include "run/accuracy.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <optional>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "output/result_file.h"
#include "output/result_reader.h"
#include "run/files.h"
#include "run/identity.h"
#include "scenario/build.h"
#include "scenario/cell_sizes.h"
#include "scenario/scenario_text.h"
#include "sim/usual_error.h"

namespace argil::run {
namespace {

constexpr double kRefinement = 1.6;    // from the first pass to the second
constexpr double kFloor = 0.01;        // [N] of the error that never counts
constexpr int kMostRuns = 4;           // three passes and the run
constexpr double kMostTets = 400'000;  // of a pass

double find_contact_radius(const scenario::Scenario& s) {
  const scenario::Scene scene = scenario::build_scene(s);
  return scenario::find_contact_radius(s, scene.trace, scene.tool, scene.body);
}

/// What is round must be so with them: a ball of 300 tets is pressed 5 % more easily than one of 1500.
int count_fewest(const scenario::BodySpec& body) {
  constexpr int kRound = 1500;
  const bool is_flat = body.kind == scenario::BodyKind::shape && body.shape.kind == shapes::ShapeKind::box;
  return is_flat ? scenario::count_fewest_tets(body) : kRound;
}

std::string print(double number) {
  std::ostringstream text;
  text.precision(17);
  text << number;
  return text.str();
}

std::string print_short(double number) {
  std::ostringstream text;
  text.precision(2);
  text << number;
  return text.str();
}

/// What the ticks of a result took of all processors [s].
double find_cpu(const output::ResultReader& reader) {
  for (const auto& [name, seconds] : reader.read_timing())
    if (name == "cpu") return seconds;
  return 0.0;
}

/// The run of a plan: settings over those that were given.
class Planner {
 public:
  Planner(const scenario::Scenario& s, const RunOptions& options)
      : m_options(options), m_wanted(s.accuracy), m_result(name_result(s, options)) {
    m_options.is_planned = true;
    m_options.asked_run_id = find_identity(s).id();
    m_options.resume = false;
    m_options.output = m_result;
    m_options.settings.insert(m_options.settings.end(), {"/dynamics/element=p2", "/body/cells/kind=graded"});
    m_fewest = count_fewest(s.body);
    m_step_lengths = find_step_lengths(s);
    m_target = find_target_pointer(s.body);
  }

  RunEnd run() {
    const double radius = find_contact_radius(load(with_cells(0.0, 1.0)));
    if (!(radius > 0.0)) return run_where_nothing_is_touched();
    if (m_step_lengths.size() > 1 && !m_options.dry_run) {
      const RunEnd end = try_steps(radius);
      if (end.code != kDone) return end;
    }
    for (;;) {
      const double cells = choose_cells(m_passes, find_share_of_cells());
      const double near = radius / cells;
      const bool goes_on = m_near_of_result == near;
      const bool is_probe = !m_options.dry_run && (m_passes.empty() || (m_near_of_result && !goes_on));
      RunOptions options = with_cells(near, cells);
      options.resume = goes_on;
      if (is_probe)
        make_probe(options);
      else
        options.notes.push_back(describe_plan(cells));
      const RunEnd end = run_loaded(load(options), options);
      if (goes_on) m_near_of_result.reset();
      if (end.code == kDone && !options.dry_run) add_pass(read_pass(options.output, cells));
      if (is_probe) std::filesystem::remove(options.output);
      if (end.code != kDone || options.dry_run || is_enough()) return end;
    }
  }

  /// The passes once more, up to the one whose result is there already, in part or to its end.
  RunEnd resume() {
    std::optional<std::string> text;
    bool is_complete = false;
    {
      const output::ResultReader reader(m_result);
      text = reader.find_provenance("scenario");
      is_complete = reader.find_accuracy().has_value();
    }
    if (!text) throw InputError(m_result, "/provenance/scenario", "is not there", "leave --resume out");
    const scenario::Scenario of_result = scenario::load_text(*text, m_options.scenario, {});
    const double near = of_result.body.cells.near_tool;
    if (is_complete) {
      m_step_ticks = of_result.params.rates.physics_period_ticks;
      RunOptions options = with_tets(near, of_result.body.target_tets);
      options.resume = true;
      return run_loaded(load(options), options);
    }
    if (near > 0.0) m_near_of_result = near;
    return run();
  }

 private:
  RunOptions with_tets(double near, double tets) const {
    RunOptions options = m_options;
    if (near > 0.0) options.settings.push_back("/body/cells/near_tool_m=" + print(near));
    if (m_step_ticks > 0)
      options.settings.push_back("/haptics/physics_period_ticks=" + std::to_string(m_step_ticks));
    if (!m_target.empty())
      options.settings.push_back(m_target + "=" +
                                 std::to_string(static_cast<int>(std::min(tets, kMostTets))));
    return options;
  }
  /// What is far from the tool is made finer with the rest.
  RunOptions with_cells(double near, double cells) const {
    constexpr double kEnough = 1.66;  // cells along the radius of contact, for as few tets as there can be
    return with_tets(near, std::max(1.0, std::pow(cells / kEnough, sim::kContactOrder)) * m_fewest);
  }
  RunEnd run_where_nothing_is_touched() {
    RunOptions options = with_cells(0.0, 1.0);
    options.notes.emplace_back("accuracy: the tool touches nothing at rest, so no cells follow from it");
    return run_loaded(load(options), options);
  }
  void make_probe(RunOptions& options) const {
    options.output = m_result + ".pass.h5";
    options.writes_xdmf = false;
    options.quiet = true;
  }
  /// The first pass with steps of two lengths.
  RunEnd try_steps(double radius) {
    const double cells = choose_cells({}, m_wanted);
    StepPasses passes;
    passes.short_ticks = m_step_lengths[m_step_lengths.size() > 2 ? 1 : 0];
    passes.long_ticks = *std::find_if(m_step_lengths.begin(), m_step_lengths.end() - 1,
                                      [&](int ticks) { return ticks >= 2 * passes.short_ticks; });
    for (auto [ticks, pass] : {std::pair{passes.short_ticks, &passes.with_short},
                               std::pair{passes.long_ticks, &passes.with_long}}) {
      m_step_ticks = ticks;
      RunOptions options = with_cells(radius / cells, cells);
      make_probe(options);
      const RunEnd end = run_loaded(load(options), options);
      if (end.code == kDone) *pass = read_pass(options.output, cells);
      std::filesystem::remove(options.output);
      if (end.code != kDone) return end;
    }
    const double error = passes.find_error_of_a_tick(kFloor / m_wanted);
    m_step_ticks = choose_step(m_step_lengths, passes.long_ticks, error, m_wanted);
    m_step_error = error * m_step_ticks;
    say(describe_step() + ": the force is about " + print_short(100.0 * m_step_error) + " % off for it");
    add_pass(passes.at(m_step_ticks));
    return {};
  }
  std::string describe_step() const {
    return "accuracy: steps of " + std::to_string(m_step_ticks) + (m_step_ticks == 1 ? " tick" : " ticks");
  }
  AccuracyPass read_pass(const std::string& result, double cells) {
    const output::ResultReader reader(result);
    m_cpu_before += std::exchange(m_cpu_of_last, find_cpu(reader));
    return {cells, static_cast<int>(reader.read_cells(0).tets.cols()), reader.read_haptic()};
  }
  void add_pass(AccuracyPass pass) {
    m_passes.push_back(std::move(pass));
    if (m_passes.size() == 1) return say(describe_pass(m_passes.back()) + ": to compare with");
    AccuracyPass& fine = m_passes.back();
    const AccuracyPass& coarse = m_passes[m_passes.size() - 2];
    fine.error = estimate_error(coarse, fine, kFloor / m_wanted);
    say(describe_pass(fine) + ": the force is about " + print_short(100.0 * find_error(fine)) + " % off");
  }
  /// A step's error goes with how fast the force changes, that of cells with the force: over a press and its
  /// release their product has no mean.
  double find_error(const AccuracyPass& pass) const { return std::hypot(pass.error, m_step_error); }
  double find_share_of_cells() const {
    constexpr double kLeast = 0.5;  // where steps alone are off by more than was asked
    const double left = 1.0 - std::pow(m_step_error / m_wanted, 2);
    return m_wanted * std::sqrt(std::max(left, kLeast * kLeast));
  }
  bool is_enough() {
    if (m_passes.size() < 2) return false;
    const std::string of_others = "was written by another scenario or with other settings";
    const bool is_lost = m_near_of_result && m_passes.size() == kMostRuns;
    if (is_lost)
      throw InputError(m_result, "/provenance/scenario", of_others, "leave --resume out to begin anew");
    if (m_near_of_result) return false;
    const AccuracyPass& last = m_passes.back();
    const bool is_exact = find_error(last) <= m_wanted;
    const bool is_end = static_cast<int>(m_passes.size()) == kMostRuns || last.num_tets > kMostTets / 3.0;
    if (!is_exact && is_end)
      say("accuracy: " + print_short(100.0 * m_wanted) +
          " % were asked: give /body/cells/near_tool_m and "
          "/dynamics/element by hand, or ask for less");
    if (is_exact || is_end) output::write_accuracy(m_result, m_wanted, find_error(last), m_cpu_before);
    return is_exact || is_end;
  }
  std::string describe_pass(const AccuracyPass& pass) const {
    return "accuracy: " + std::to_string(pass.num_tets) + " ten-node tets, " + print_short(pass.cells) +
           " cells along the radius of contact";
  }
  /// Of the run that comes.
  std::string describe_plan(double cells) const {
    std::string text = m_step_ticks > 0 ? describe_step() + ", " : "accuracy: ";
    text += print_short(cells) + " cells along the radius of contact";
    for (const AccuracyPass& pass : m_passes)
      text += "; a pass had " + print_short(pass.cells) + " and " + std::to_string(pass.num_tets) + " tets";
    return text;
  }
  void say(const std::string& text) const {
    if (!m_options.quiet) std::fprintf(stderr, "argil: note: %s\n", text.c_str());
  }

  RunOptions m_options;
  double m_wanted;
  std::string m_result;
  std::string m_target;  // key of the number of tets
  int m_fewest = 0;
  std::vector<int> m_step_lengths;  // in ticks, that may be tried
  int m_step_ticks = 0;             // 0: as given
  double m_step_error = 0.0;
  std::optional<double> m_near_of_result;  // size of its cells [m], until the pass that made it comes
  std::vector<AccuracyPass> m_passes;
  double m_cpu_before = 0.0;   // of the passes before the last, in their ticks, of all processors [s]
  double m_cpu_of_last = 0.0;  // of the last
};

}  // namespace

double compare_forces(const std::vector<sim::HapticRecord>& a, const std::vector<sim::HapticRecord>& b,
                      double floor) {
  double difference = 0.0, size = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (a[i].num_contacts == 0 && b[i].num_contacts == 0) continue;
    difference += (a[i].force - b[i].force).squaredNorm();
    size += b[i].force.squaredNorm();
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(difference / count) / std::max(floor, std::sqrt(size / count));
}

double estimate_error(const AccuracyPass& coarse, const AccuracyPass& fine, double floor) {
  return compare_forces(coarse.haptic, fine.haptic, floor) /
         std::pow(fine.cells / coarse.cells, sim::kContactOrder);
}

double choose_cells(const std::vector<AccuracyPass>& passes, double wanted) {
  constexpr double kMargin = 0.9;
  constexpr double kFewest = 0.75;             // on fewer, the error says nothing of that on more
  constexpr double kLeast = 1.3, kMost = 2.0;  // times those of the pass before
  const double by_experience = std::max(
      kFewest * kRefinement,
      std::pow(sim::find_usual_error(solid::ElementKind::p2, 1.0) / wanted, 1.0 / sim::kContactOrder));
  if (passes.empty()) return by_experience / kRefinement;
  if (passes.size() == 1) return by_experience;
  const AccuracyPass& last = passes.back();
  const double more = std::pow(last.error / (kMargin * wanted), 1.0 / sim::kContactOrder);
  return last.cells * std::clamp(more, kLeast, kMost);
}

std::string find_target_pointer(const scenario::BodySpec& body) {
  if (body.kind == scenario::BodyKind::shape) return "/body/shape/target_tets";
  const bool is_made = body.kind == scenario::BodyKind::surface && body.cage_file.empty();
  return is_made ? "/body/surface/target_tets" : "";
}

std::vector<int> find_step_lengths(const scenario::Scenario& s) {
  constexpr int kLongest = 10;
  if (s.params.solid.integrator == solid::Integrator::symplectic_euler) return {};
  const sim::RateParams& rates = s.params.rates;
  const int of_all = std::gcd(rates.water_period_ticks, rates.frame_period_ticks);
  std::vector<int> lengths;
  for (int ticks = 1; ticks <= kLongest; ++ticks)
    if (of_all % ticks == 0) lengths.push_back(ticks);
  return lengths;
}

double StepPasses::find_error_of_a_tick(double floor) const {
  return compare_forces(with_long.haptic, with_short.haptic, floor) / (long_ticks - short_ticks);
}

AccuracyPass StepPasses::at(int ticks) const {
  AccuracyPass pass = with_short;
  const double share = static_cast<double>(ticks - short_ticks) / (long_ticks - short_ticks);
  for (std::size_t i = 0; i < std::min(pass.haptic.size(), with_long.haptic.size()); ++i)
    pass.haptic[i].force += share * (with_long.haptic[i].force - with_short.haptic[i].force);
  return pass;
}

int choose_step(const std::vector<int>& lengths, int longest, double error_of_a_tick, double wanted) {
  constexpr double kShare = 0.65;  // of the wanted error, at which cells and steps cost the least
  int chosen = lengths.front();
  for (const int ticks : lengths)
    if (ticks <= longest && error_of_a_tick * ticks <= kShare * wanted) chosen = ticks;
  return chosen;
}

RunEnd run_to_accuracy(const scenario::Scenario& s, const RunOptions& options) {
  const std::string result = name_result(s, options);
  check_result_name(s, result);
  Planner planner(s, options);
  return options.resume && std::filesystem::exists(result) ? planner.resume() : planner.run();
}

}  // namespace argil::run
