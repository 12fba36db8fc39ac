#include "study/run.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/print.h"
#include "embed/triangle_tree.h"
#include "output/result_file.h"
#include "scenario/build.h"
#include "sim/simulation.h"
#include "study/files.h"
#include "study/identity.h"
#include "study/loop.h"
#include "study/resume.h"

namespace argil::study {
namespace {

output::ResultHeader make_header(const scenario::Scenario& s, const sim::Simulation& simulation,
                                 const scenario::Scene& scene, const mesh::TriangleMesh& tool,
                                 const Identity& identity) {
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
                       {"trace_sha256", scene.trace.sha256},
                       {"effective_medium", scene.medium_status},
                       {"notes", notes}};
  for (const auto& [name, text] : identity.provenance()) header.provenance.emplace_back(name, text);
  return header;
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

int print_done_before(const std::string& result, const RunOptions& options) {
  if (!options.quiet) std::printf("%s: complete already\n", result.c_str());
  return kDone;
}

int print_failure(const Failure& failure) {
  std::fprintf(stderr, "argil: run failed: %s\n", to_string(failure).c_str());
  return kRunFailed;
}

int print_end(const std::string& result, const LoopEnd& end, Tick first, Tick last,
              const RunOptions& options) {
  if (end.failure) return print_failure(*end.failure);
  if (end.is_interrupted) {
    std::fprintf(stderr,
                 "argil: interrupted after tick %lld; %s is readable up to there; go on with --resume\n",
                 static_cast<long long>(last), result.c_str());
    return kInterrupted;
  }
  if (options.quiet) return kDone;
  std::printf("%s: %lld ticks in %.1f s (%.0f/s)", result.c_str(), static_cast<long long>(last - first),
              end.seconds, static_cast<double>(last - first) / end.seconds);
  if (first > 0) std::printf(", resumed after tick %lld", static_cast<long long>(first));
  std::printf("\n");
  return kDone;
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
  output::ResultFile file(result, make_header(s, simulation, scene, tool, find_identity(s)));
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
  const std::string result = name_result(s, options);
  check_result_name(s, result);
  if (s.mode == scenario::Mode::equilibrium && options.resume)
    throw InputError(s.file, "/dynamics/mode", "\"static\" has no ticks to resume", "leave --resume out");
  scenario::Scene scene = scenario::build_scene(s);
  if (s.mode == scenario::Mode::equilibrium) return run_static(s, scene, options);
  const mesh::TriangleMesh tool = scene.tool;
  sim::Simulation simulation(std::move(scene.body), tool, s.params, sample_at(s, scene.trace, 0));
  if (simulation.tool_overlaps_body()) refuse_start(s, options, simulation, tool);
  print_notes(scene, options);
  if (options.dry_run) return print_ready(s, simulation, count_ticks(s, scene.trace));
  const Identity identity = find_identity(s);
  ResumePoint from;
  if (options.resume) from = find_resume_point(result, identity);
  if (from.kind == ResumePoint::Kind::done) return print_done_before(result, options);
  if (from.kind == ResumePoint::Kind::checkpoint) {
    simulation.restore(from.state, result);
    from.state.clear();
  }
  const Tick first = simulation.clock().tick;
  std::optional<output::ResultFile> file;
  if (from.kind == ResumePoint::Kind::checkpoint)
    file.emplace(result, first, count_frames(s, first));
  else
    file.emplace(result, make_header(s, simulation, scene, tool, identity));
  LoopEnd end;
  try {
    end = run_loop(s, scene.trace, simulation, *file, !options.quiet);
    file->finish(end.failure, end.is_interrupted);
  } catch (const IoError&) {
    std::fprintf(stderr,
                 "argil: note: %s is readable up to its last flush; make room and go on with --resume\n",
                 result.c_str());
    throw;
  }
  if (options.writes_xdmf) output::write_xdmf(result, name_xdmf(result));
  return print_end(result, end, first, simulation.clock().tick, options);
}

}  // namespace argil::study
