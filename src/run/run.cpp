#include "run/run.h"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include "base/error.h"
#include "output/info.h"
#include "output/result_file.h"
#include "output/result_reader.h"
#include "run/accuracy.h"
#include "run/files.h"
#include "run/identity.h"
#include "run/interrupt.h"
#include "run/loop.h"
#include "run/ready_run.h"
#include "run/replay.h"
#include "run/resume.h"
#include "run/start.h"
#include "scenario/build.h"
#include "scenario/patch.h"
#include "scenario/renew_cells.h"
#include "scenario/scenario_text.h"
#include "scenario/scene_faults.h"
#include "sim/simulation.h"

namespace argil::run {
namespace {

RunEnd print_ready(const scenario::Scenario& s, const sim::Simulation& simulation, Tick num_ticks) {
  std::printf("%s: %d vertices, %d tets, %d skin triangles, %lld ticks: ready to run\n", s.file.c_str(),
              simulation.body().mesh.num_vertices(), simulation.body().mesh.num_tets(),
              simulation.body().skin.num_triangles(), static_cast<long long>(num_ticks));
  return {};
}

RunEnd end_done_before(const std::string& result, const RunOptions& options) {
  if (options.writes_xdmf && !output::has_whole_xdmf(name_xdmf(result)))  // killed before its end, or removed
    output::write_xdmf(result, name_xdmf(result));
  if (!options.quiet) std::printf("%s: complete already\n", result.c_str());
  return {};
}

RunEnd make_failed(const Failure& failure) {
  return {kRunFailed, "run failed: " + output::describe_failure(failure), failure};
}

RunEnd print_end(const std::string& result, const LoopEnd& end, Tick first, Tick last,
                 const RunOptions& options) {
  if (end.failure) return make_failed(*end.failure);
  if (end.is_interrupted)
    return {kInterrupted,
            "interrupted after tick " + std::to_string(last) + "; " + result + " is readable up to there; " +
                options.remedy,
            std::nullopt};
  if (options.quiet) return {};
  std::printf("%s: %lld ticks in %.1f s (%.0f/s)", result.c_str(), static_cast<long long>(last - first),
              end.seconds, static_cast<double>(last - first) / end.seconds);
  if (first > 0) std::printf(", resumed after tick %lld", static_cast<long long>(first));
  std::printf("\n");
  return {};
}

/// Says so where the tool has touched nothing since the start. `miss`: what was known of it before.
void print_miss(const std::string& result, const LoopEnd& end, Tick first, const std::string& miss,
                const RunOptions& options) {
  if (end.has_touched || options.quiet) return;
  if (first > 0)
    for (const sim::HapticRecord& record : output::ResultReader(result).read_haptic())
      if (record.num_contacts > 0) return;
  std::fprintf(stderr, "argil: note: no tick had contact%s%s\n", miss.empty() ? "" : ": ", miss.c_str());
}

/// Says what the run could not compute.
void print_limits(const std::string& result, const LoopEnd& end, int num_tets, const RunOptions& options) {
  if (!end.is_limited || options.quiet) return;
  const output::ResultReader reader(result);
  std::fprintf(stderr, "argil: note: %s\n",
               output::describe_limits(reader.read_physics(), reader.read_haptic(), num_tets).c_str());
}

/// One equilibrium: a physics record and a frame, at the time 0 of an empty motion.
RunEnd run_static(const scenario::Scenario& s, const RunOptions& options) {
  scenario::Scene scene = scenario::build_scene(s);
  const mesh::TriangleMesh tool = scene.tool;
  sim::Simulation simulation(std::move(scene.body), tool, s.params, {});
  print_notes(scene, options);
  if (options.dry_run) return print_ready(s, simulation, 0);
  const std::string result = name_result(s, options);
  output::ResultFile file(result, make_header(s, simulation, scene, tool, find_identity(s)));
  const auto start = std::chrono::steady_clock::now();
  const StepStatus status = simulation.find_equilibrium();
  const std::optional<Failure> failure =
      status.is_ok() ? std::nullopt : std::optional<Failure>(status.failure());
  file.append(simulation.physics_record());
  file.append(simulation.make_frame());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  file.append_timing({{"solve", seconds}, {"total", seconds}});
  file.finish(failure);
  if (options.writes_xdmf) output::write_xdmf(result, name_xdmf(result));
  if (failure) return make_failed(*failure);
  if (!options.quiet) {
    const Points moved = simulation.body_state().solid.x - simulation.solid().model.elements.rest;
    std::printf("%s: equilibrium in %.2f s, largest displacement %.6g m\n", result.c_str(), seconds,
                moved.colwise().norm().maxCoeff());
  }
  return {};
}

/// A live session once more, in one thread. It ends as the session did.
RunEnd run_replay(const scenario::Scenario& s, const output::Session& session, const std::string& note,
                  const RunOptions& options) {
  if (options.resume)
    throw InputError(options.trace, "", "is a live session, whose replay has no checkpoints",
                     "leave --resume out");
  scenario::Scene scene = scenario::build_scene(s, &session.touched_places);
  if (!note.empty()) std::fprintf(stderr, "argil: note: %s\n", note.c_str());
  const mesh::TriangleMesh tool = scene.tool;
  sim::Simulation simulation(std::move(scene.body), tool, session_params(session.head, s.params),
                             session.head.start);
  print_notes(scene, options);
  scene.contact_cells.clear();  // its session did not know the motion
  const auto num_ticks = static_cast<Tick>(session.ticks.size());
  if (options.dry_run) return print_ready(s, simulation, num_ticks);
  const std::string result = name_result(s, options);
  output::ResultFile file(result, make_header(s, simulation, scene, tool, find_identity(s)));
  const auto start = std::chrono::steady_clock::now();
  LoopEnd end;
  end.failure = replay(session, simulation, file);
  end.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  file.append_timing({{"total", end.seconds}});
  file.finish(end.failure, session.is_interrupted);
  if (options.writes_xdmf) output::write_xdmf(result, name_xdmf(result));
  if (session.end_hash.empty())
    std::fprintf(stderr, "argil: note: %s was killed: replayed up to its last tick\n", options.trace.c_str());
  else if (session.end_hash != simulation.state_hash())
    return {kDifferent, "the replay ended in another state than " + options.trace, std::nullopt};
  return print_end(result, end, 0, num_ticks, options);
}

}  // namespace

scenario::Scenario load(const RunOptions& options) {
  std::vector<scenario::Setting> settings;
  for (const std::string& patch : options.patches) {
    require_input_file(patch);
    for (scenario::Setting& setting : scenario::read_patch(patch)) settings.push_back(std::move(setting));
  }
  if (options.strict) settings.push_back({"/dynamics/strict", "true"});
  for (const std::string& text : options.settings) settings.push_back(scenario::parse_setting(text));
  if (!options.trace.empty())
    settings.push_back({"/trace/file", "\"" + std::filesystem::absolute(options.trace).string() + "\""});
  const bool is_text = !options.text.empty();
  if (!is_text) require_input_file(options.scenario);
  if (!options.trace.empty()) require_input_file(options.trace);
  const auto motion = options.has_own_hand ? scenario::MotionSource::device : scenario::MotionSource::trace;
  scenario::Scenario s =
      is_text
          ? scenario::load_text(options.text, options.scenario, settings, motion, scenario::find_scene_faults)
          : scenario::load_scenario(options.scenario, settings, motion, scenario::find_scene_faults);
  s.params.threads = options.threads;
  for (const scenario::InputFile& input : scenario::list_input_files(s))
    if (!is_text || !input.pointer.empty()) require_input_file(input.file, input.pointer);
  return s;
}

void require_motion(const scenario::Scenario& s, const std::string& remedy) {
  if (s.mode == scenario::Mode::dynamic && s.trace.file.empty())
    throw InputError(s.file, "/trace/file", "is missing", remedy);
}

std::string quote_word(const std::string& word) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=./,:@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string repeat_words(const RunOptions& options) {
  std::string words = quote_word(options.scenario);
  for (const std::string& patch : options.patches) words += " --patch " + quote_word(patch);
  for (const std::string& setting : options.settings) words += " --set " + quote_word(setting);
  if (!options.trace.empty()) words += " --trace " + quote_word(options.trace);
  return words;
}

std::string name_result(const scenario::Scenario& s, const RunOptions& options) {
  return options.output.empty() ? std::filesystem::path(s.file).stem().string() + ".h5" : options.output;
}

void print_notes(const scenario::Scene& scene, const RunOptions& options) {
  if (options.quiet) return;
  for (const std::string& note : scene.notes) std::fprintf(stderr, "argil: note: %s\n", note.c_str());
  if (!scene.contact_cells.empty()) std::fprintf(stderr, "argil: note: %s\n", scene.contact_cells.c_str());
}

RunEnd run_loaded(const scenario::Scenario& s, const RunOptions& options) {
  if (s.accuracy > 0.0 && !options.is_planned) return run_to_accuracy(s, options);
  const std::string result = name_result(s, options);
  check_result_name(s, result);
  for (const std::string& patch : options.patches) require_other_file(result, patch, "the patch", "-o");
  if (s.mode == scenario::Mode::equilibrium && options.resume)
    throw InputError(s.file, "/dynamics/mode", "\"static\" has no ticks to resume", "leave --resume out");
  std::string note;
  if (const auto session = find_session(options.trace, s, note))
    return run_replay(without_trace(s), *session, note, options);
  if (s.mode == scenario::Mode::equilibrium) return run_static(s, options);
  ReadyRun run(s, options.trace, note);
  sim::Simulation& simulation = run.simulation;
  FullModel* const full = run.full.get();
  run.scene.notes.insert(run.scene.notes.end(), options.notes.begin(), options.notes.end());
  print_notes(run.scene, options);
  if (options.dry_run) return print_ready(s, simulation, count_ticks(s, run.scene.trace));
  Identity identity = find_identity(s);
  identity.asked_id = options.asked_run_id;
  ResumePoint from;
  Tick no_cells_until = -1;
  if (options.resume) from = find_resume_point(result, identity);
  if (from.kind == ResumePoint::Kind::done) return end_done_before(result, options);
  if (from.kind == ResumePoint::Kind::checkpoint) {
    if (from.cells) simulation.restore_cells(scenario::complete_cells(s, std::move(*from.cells)));
    simulation.restore(from.state, result);
    if (full) full->restore(from.state, result);
    Archive archive = Archive::make_restoring(from.state, result);
    run.hand.serialize(archive);
    no_cells_until = find_no_cells_until(from.state);
    from.state.clear();
  }
  const Tick first = simulation.clock().tick;
  watch_signals();  // before there is a file that is half made
  std::optional<output::ResultFile> file;
  if (from.kind == ResumePoint::Kind::checkpoint)
    file.emplace(result, first, count_frames(s, first), s.frame_precision);
  else
    file.emplace(result, run.make_header(identity));
  LoopEnd end;
  try {
    end = run_loop(s, count_ticks(s, run.scene.trace), run.hand, simulation, full, *file, !options.quiet,
                   no_cells_until);
    file->finish(end.failure, end.is_interrupted);
  } catch (const IoError&) {
    std::fprintf(stderr, "argil: note: %s is readable up to its last flush; make room and %s\n",
                 result.c_str(), options.remedy.c_str());
    throw;
  }
  if (options.writes_xdmf) output::write_xdmf(result, name_xdmf(result));
  print_miss(result, end, first, run.miss, options);
  print_limits(result, end, simulation.body().mesh.num_tets(), options);
  return print_end(result, end, first, simulation.clock().tick, options);
}

int run(const RunOptions& options) {
  const RunEnd end = run_loaded(load(options), options);
  if (!end.message.empty()) std::fprintf(stderr, "argil: %s\n", end.message.c_str());
  return end.code;
}

}  // namespace argil::run
