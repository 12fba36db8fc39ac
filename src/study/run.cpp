#include "study/run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/hash.h"
#include "base/print.h"
#include "embed/triangle_tree.h"
#include "output/result_file.h"
#include "scenario/build.h"
#include "sim/simulation.h"
#include "study/build_info.h"
#include "study/cost_meter.h"
#include "study/files.h"
#include "study/progress.h"

namespace argil::study {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;  // the one thing a signal handler may touch

void on_signal(int) {
  g_interrupted = 1;
}

/// Adds up wall-clock time per stage of the loop.
class StageClock final : public sim::StageObserver {
 public:
  void begin(sim::Stage) override { m_begin = std::chrono::steady_clock::now(); }
  void end(sim::Stage stage) override {
    m_seconds[static_cast<std::size_t>(stage)] +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - m_begin).count();
  }
  std::vector<std::pair<std::string, double>> seconds(double total, Tick ticks) const {
    constexpr std::array<const char*, static_cast<std::size_t>(sim::Stage::count)> kNames = {
        "contact", "water", "assemble", "solve", "kinematics", "plasticity"};
    std::vector<std::pair<std::string, double>> list;
    for (std::size_t i = 0; i < kNames.size(); ++i) list.emplace_back(kNames[i], m_seconds[i]);
    list.emplace_back("total", total);
    list.emplace_back("tick_rate_Hz", total > 0.0 ? static_cast<double>(ticks) / total : 0.0);
    return list;
  }

 private:
  std::chrono::steady_clock::time_point m_begin;
  std::array<double, static_cast<std::size_t>(sim::Stage::count)> m_seconds = {};
};

output::ResultHeader make_header(const scenario::Scenario& s, const sim::Simulation& simulation,
                                 const scenario::Scene& scene, const mesh::TriangleMesh& tool) {
  output::ResultHeader header;
  header.rest_position = simulation.body().mesh.vertices;
  header.tets = simulation.body().mesh.tets;
  header.surface_triangles = simulation.body().topology.boundary;
  header.skin_triangles = simulation.body().skin.triangles;
  header.tool = tool;
  header.haptic_period = s.params.rates.haptic_period;
  std::string notes;
  for (const std::string& note : scene.notes) notes += note + "\n";
  header.provenance = {{"about", s.about},
                       {"scenario", scenario::print_portable(s)},
                       {"scenario_sha256", Sha256().add(scenario::print_portable(s)).hex_digest()},
                       {"trace_sha256", scene.trace.sha256},
                       {"build", describe_build()},
                       {"effective_medium", scene.medium_status},
                       {"notes", notes}};
  if (s.body.kind != scenario::BodyKind::shape)
    header.provenance.emplace_back("body_sha256", hash_file(s.body.file));
  return header;
}

/// The hand at the end of tick k, with the scenario's mode unless the trace decides.
device::DeviceSample sample_at(const scenario::Scenario& s, const device::Trace& trace, Tick ticks) {
  device::DeviceSample sample =
      device::interpolate(trace, s.trace.start + static_cast<double>(ticks) * s.params.rates.haptic_period);
  switch (s.tool.mode) {
    case scenario::ModeChoice::push:
      sample.mode = device::ToolMode::push;
      break;
    case scenario::ModeChoice::pull:
      sample.mode = device::ToolMode::pull;
      break;
    case scenario::ModeChoice::wet:
      sample.mode = device::ToolMode::wet;
      break;
    case scenario::ModeChoice::dry:
      sample.mode = device::ToolMode::dry;
      break;
    case scenario::ModeChoice::trace:
      break;
  }
  return sample;
}

Tick count_ticks(const scenario::Scenario& s, const device::Trace& trace) {
  const double duration = s.trace.duration > 0.0 ? s.trace.duration : trace.duration() - s.trace.start;
  const double ticks = duration / s.params.rates.haptic_period;
  constexpr double kRounding =
      1e-6;  // a duration that is a whole number of ticks up to rounding is that number
  return static_cast<Tick>(std::floor(ticks + kRounding));
}

/// The loop over the ticks. Appends records as they come; returns the failure, if any.
std::optional<Failure> run_ticks(const scenario::Scenario& s, const device::Trace& trace, Tick num_ticks,
                                 sim::Simulation& simulation, output::ResultFile& file, CostMeter& cost,
                                 bool quiet) {
  Progress progress(num_ticks, !quiet);
  file.append(simulation.make_frame());
  Tick last_frame = 0;
  for (Tick k = 1; k <= num_ticks && !g_interrupted; ++k) {
    const device::DeviceSample sample = sample_at(s, trace, k);
    cost.begin();
    const StepStatus status = simulation.tick(sample);
    cost.end();
    if (!status.is_ok()) {
      if (last_frame != simulation.clock().tick) file.append(simulation.make_frame());  // the last good state
      return status.failure();
    }
    file.append(simulation.haptic_record());
    if (simulation.physics_due_last_tick()) file.append(simulation.physics_record());
    if (simulation.frame_due_last_tick()) {
      file.append(simulation.make_frame());
      last_frame = k;
    }
    progress.update(k);
  }
  if (last_frame != simulation.clock().tick) file.append(simulation.make_frame());
  return {};
}

/// Deepest place of a surface's vertices in a closed surface [m]; 0 when all are outside.
double find_depth(const Points& vertices, const mesh::TriangleMesh& surface) {
  const embed::TriangleTree tree(surface);
  double depth = 0.0;
  for (Eigen::Index v = 0; v < vertices.cols(); ++v)
    if (tree.compute_winding_number(vertices.col(v)) > 0.5)
      depth = std::max(depth, tree.compute_distance(vertices.col(v), std::numeric_limits<double>::max()));
  return depth;
}

/// The motion begins in the body: says where and how deep, in the file that the motion came from.
[[noreturn]] void refuse_start(const scenario::Scenario& s, const RunOptions& options,
                               const sim::Simulation& simulation, mesh::TriangleMesh tool) {
  const contact::Pose& pose = simulation.state().tool;
  tool.vertices = (pose.orientation.toRotationMatrix() * tool.vertices).colwise() + pose.position;
  const mesh::TriangleMesh body{simulation.body().mesh.vertices, simulation.body().topology.boundary};
  const double depth = std::max(find_depth(tool.vertices, body), find_depth(body.vertices, tool));
  std::ostringstream text;
  text << "the tool starts in or across the body, " << std::setprecision(3) << 1e3 * depth
       << " mm deep, with the hand at " << print_place(pose.position) << " m";
  const bool is_given = !options.trace.empty();
  throw InputError(is_given ? options.trace : s.file, is_given ? "" : "/trace", text.str(),
                   "start the motion outside it");
}

void print_notes(const scenario::Scene& scene, const RunOptions& options) {
  if (options.quiet) return;
  for (const std::string& note : scene.notes) std::fprintf(stderr, "argil: note: %s\n", note.c_str());
}

int print_ready(const scenario::Scenario& s, const sim::Simulation& simulation, Tick num_ticks) {
  std::printf("%s: %d vertices, %d tets, %d skin triangles, %lld ticks: ready to run\n", s.file.c_str(),
              simulation.body().mesh.num_vertices(), simulation.body().mesh.num_tets(),
              simulation.body().skin.num_triangles(), static_cast<long long>(num_ticks));
  return kDone;
}

int print_failure(const Failure& failure) {
  std::fprintf(stderr, "argil: run failed: %s\n", to_string(failure).c_str());
  return kRunFailed;
}

std::string name_result(const scenario::Scenario& s, const RunOptions& options) {
  return options.output.empty() ? std::filesystem::path(s.file).stem().string() + ".h5" : options.output;
}

/// One equilibrium: a physics record and a frame, at the time 0 of an empty motion.
int run_static(const scenario::Scenario& s, scenario::Scene& scene, const RunOptions& options) {
  const mesh::TriangleMesh tool = scene.tool;
  sim::Simulation simulation(std::move(scene.body), tool, s.params, {});
  print_notes(scene, options);
  if (options.dry_run) return print_ready(s, simulation, 0);
  const std::string result = name_result(s, options);
  output::ResultFile file(result, make_header(s, simulation, scene, tool));
  const auto start = std::chrono::steady_clock::now();
  const StepStatus status = simulation.settle();
  const std::optional<Failure> failure =
      status.is_ok() ? std::nullopt : std::optional<Failure>(status.failure());
  file.append(simulation.physics_record());
  file.append(simulation.make_frame());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  file.append_timing({{"solve", seconds}, {"total", seconds}});
  file.finish(failure);
  output::write_xdmf(result, name_xdmf(result));
  if (failure) return print_failure(*failure);
  if (!options.quiet) {
    const Points moved = simulation.state().solid.x - simulation.solid().elements().rest;
    std::printf("%s: equilibrium in %.2f s, largest displacement %.6g m\n", result.c_str(), seconds,
                moved.colwise().norm().maxCoeff());
  }
  return kDone;
}

}  // namespace

scenario::Scenario load(const RunOptions& options) {
  std::vector<scenario::Setting> settings;
  for (const std::string& text : options.settings) settings.push_back(scenario::parse_setting(text));
  if (!options.trace.empty())
    settings.push_back({"/trace/file", "\"" + std::filesystem::absolute(options.trace).string() + "\""});
  require_input_file(options.scenario);
  if (!options.trace.empty()) require_input_file(options.trace);
  scenario::Scenario s = scenario::load_scenario(options.scenario, settings);
  s.params.threads = options.threads;
  for (const scenario::InputFile& input : scenario::list_input_files(s))
    require_input_file(input.file, input.pointer);
  return s;
}

int run(const RunOptions& options) {
  const scenario::Scenario s = load(options);
  check_result_name(s, name_result(s, options));
  scenario::Scene scene = scenario::build_scene(s);
  if (s.mode == scenario::Mode::equilibrium) return run_static(s, scene, options);
  const mesh::TriangleMesh tool = scene.tool;
  const Tick num_ticks = count_ticks(s, scene.trace);
  sim::Simulation simulation(std::move(scene.body), tool, s.params, sample_at(s, scene.trace, 0));
  if (simulation.tool_overlaps_body()) refuse_start(s, options, simulation, tool);
  print_notes(scene, options);
  if (options.dry_run) return print_ready(s, simulation, num_ticks);
  const std::string result = name_result(s, options);
  output::ResultFile file(result, make_header(s, simulation, scene, tool));
  g_interrupted = 0;
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  StageClock clock;
  simulation.observe_stages(&clock);
  const auto start = std::chrono::steady_clock::now();
  CostMeter cost;
  const std::optional<Failure> failure =
      run_ticks(s, scene.trace, num_ticks, simulation, file, cost, options.quiet);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  auto timing = clock.seconds(seconds, simulation.clock().tick);
  timing.emplace_back("cpu", cost.cpu_seconds());
  if (const auto instructions = cost.instructions()) timing.emplace_back("instructions", *instructions);
  file.append_timing(timing);
  file.finish(failure, g_interrupted != 0 && !failure);
  output::write_xdmf(result, name_xdmf(result));
  if (failure) return print_failure(*failure);
  if (g_interrupted) {
    std::fprintf(stderr, "argil: interrupted after tick %lld; %s is readable up to there\n",
                 static_cast<long long>(simulation.clock().tick), result.c_str());
    return kInterrupted;
  }
  if (!options.quiet)
    std::printf("%s: %lld ticks in %.1f s (%.0f/s)\n", result.c_str(), static_cast<long long>(num_ticks),
                seconds, static_cast<double>(num_ticks) / seconds);
  return kDone;
}

std::string describe_build() {
  std::ostringstream text;
  text << "argil " << kVersion << "\ncommit " << kCommit << "\ncompiler " << kCompiler << "\nbuild "
       << kBuildType << "\nflags " << kFlags << "\neigen " << EIGEN_WORLD_VERSION << '.'
       << EIGEN_MAJOR_VERSION << '.' << EIGEN_MINOR_VERSION
       << "\ncholesky CHOLMOD simplicial LDL'\nthreads do not change results\n";
  return text.str();
}

}  // namespace argil::study
