#include "output/info.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "output/schema.h"
#include "output/text.h"

namespace argil::output {
namespace {

/// "name" in a column of its own; the lines of one list have it once.
std::string label(const std::string& name) {
  constexpr std::size_t kColumn = 12;
  return name + std::string(kColumn - std::min(kColumn - 1, name.size()), ' ');
}

std::string count(std::size_t number, const std::string& things) {
  return std::to_string(number) + ' ' + things + (number == 1 ? "" : "s");
}

void describe_outcome(std::ostream& out, const ResultReader& reader) {
  out << label("outcome");
  switch (reader.outcome()) {
    case Outcome::done:
      out << "done\n";
      break;
    case Outcome::interrupted:
      out << "interrupted by the user; whole up to its last record\n";
      break;
    case Outcome::running:
      out << "not finished: still running, or killed\n";
      break;
    case Outcome::failed: {
      const auto failure = reader.read_failure();
      out << "failed: " << (failure ? describe_failure(*failure) : "no reason recorded") << '\n';
      break;
    }
  }
}

void describe_body(std::ostream& out, const ResultHeader& header) {
  out << label("body") << header.rest_position.cols() << " vertices, " << header.tets.cols() << " tets, "
      << header.surface_triangles.cols() << " surface triangles";
  if (header.skin_triangles.cols() > 0) out << ", skin of " << header.skin_triangles.cols() << " triangles";
  if (header.rest_position.cols() > 0) {
    const Vec3 size = header.rest_position.rowwise().maxCoeff() - header.rest_position.rowwise().minCoeff();
    out << "; " << with_prefix(size.x(), "m") << " × " << with_prefix(size.y(), "m") << " × "
        << with_prefix(size.z(), "m");
  }
  out << '\n'
      << label("tool") << header.tool.num_vertices() << " vertices, " << header.tool.num_triangles()
      << " triangles\n";
}

/// The first of equal maxima, so that the answer does not depend on anything else.
void describe_peak(std::ostream& out, const std::vector<sim::HapticRecord>& records) {
  const auto peak = std::max_element(records.begin(), records.end(), [](const auto& a, const auto& b) {
    return a.force.stableNorm() < b.force.stableNorm();
  });
  out << label("peak force") << with_prefix(peak->force.stableNorm(), "N") << " on the hand at "
      << with_prefix(peak->time, "s") << " (" << to_string(peak->mode) << "), "
      << with_prefix(peak->device_force.stableNorm(), "N") << " as the device gives it, torque "
      << with_prefix(peak->torque.stableNorm(), "N m") << '\n';
}

void describe_force_error(std::ostream& out, const std::vector<sim::HapticRecord>& records) {
  const sim::HapticRecord* peak = nullptr;
  double squares = 0.0, error_squares = 0.0;
  for (const sim::HapticRecord& record : records) {
    if (!peak || record.force.stableNorm() > peak->force.stableNorm()) peak = &record;
    squares += record.force.squaredNorm();
    error_squares += record.error.total() * record.error.total();
  }
  if (!peak || !(squares > 0.0)) return;
  const sim::ForceErrorParts& parts = peak->error;
  out << label("force error") << "estimated " << with_prefix(parts.total(), "N") << " at the peak: mesh "
      << with_prefix(parts.mesh, "N") << ", step " << with_prefix(parts.step, "N") << ", contact "
      << with_prefix(parts.contact, "N") << ", solver " << with_prefix(parts.solver, "N") << ", left out "
      << with_prefix(parts.left_out, "N") << "; in all "
      << rounded(100.0 * std::sqrt(error_squares / squares)) << " % of the force (rms over rms)\n";
}

void describe_haptic(std::ostream& out, const std::vector<sim::HapticRecord>& records, double period) {
  out << label("motion");
  if (!records.empty()) out << with_prefix(records.back().time, "s") << ": ";
  out << count(records.size(), "tick") << " of " << with_prefix(period, "s");
  if (records.empty()) {
    out << '\n';
    return;
  }
  std::array<std::size_t, device::kNumToolModes> in_mode{};
  std::size_t touching = 0;
  std::size_t gated = 0;
  int oldest = 0;
  for (const sim::HapticRecord& record : records) {
    ++in_mode[static_cast<std::size_t>(record.mode)];
    touching += record.num_contacts > 0 ? 1 : 0;
    gated += record.gate_events != 0 ? 1 : 0;
    oldest = std::max(oldest, record.force_age);
  }
  for (std::size_t mode = 0; mode < in_mode.size(); ++mode)
    if (in_mode[mode] > 0)
      out << ", " << to_string(static_cast<device::ToolMode>(mode)) << ' ' << in_mode[mode];
  out << '\n'
      << label("contact") << "in " << count(touching, "tick") << "; the oldest force was "
      << count(static_cast<std::size_t>(std::max(0, oldest)), "tick") << " old; the device's limits acted in "
      << gated << '\n';
  describe_peak(out, records);
}

void describe_physics(std::ostream& out, const std::vector<sim::PhysicsRecord>& records) {
  out << label("physics") << count(records.size(), "step");
  if (records.empty()) {
    out << '\n';
    return;
  }
  sim::PhysicsRecord worst = records.front();
  for (const sim::PhysicsRecord& record : records) {
    worst.min_volume_ratio = std::min(worst.min_volume_ratio, record.min_volume_ratio);
    worst.max_plastic_strain = std::max(worst.max_plastic_strain, record.max_plastic_strain);
    worst.residual = std::max(worst.residual, record.residual);
    worst.active_nodes = std::max(worst.active_nodes, record.active_nodes);
  }
  const sim::PhysicsRecord& first = records.front();
  const sim::PhysicsRecord& last = records.back();
  out << "; at most " << worst.active_nodes << " vertices solved for, " << last.factorisations
      << " factorisations, largest residual " << rounded(worst.residual) << '\n';
  out << label("clay") << "a tet shrank to " << rounded(100.0 * worst.min_volume_ratio)
      << " % of its volume at worst; plastic strain up to " << rounded(100.0 * worst.max_plastic_strain)
      << " %\n";
  out << label("energy") << "at the end kinetic " << with_prefix(last.kinetic_energy, "J") << ", elastic "
      << with_prefix(last.elastic_energy, "J") << "; since the start dissipated by flow "
      << with_prefix(last.plastic_dissipation, "J") << ", given by contact "
      << with_prefix(last.contact_work, "J") << '\n';
  constexpr double kGrams = 1e3;
  out << label("water") << with_prefix(kGrams * first.water_mass, "g") << " after the first step, "
      << with_prefix(kGrams * last.water_mass, "g") << " at the end; the tool gave "
      << with_prefix(kGrams * last.water_added, "g") << " and took "
      << with_prefix(kGrams * last.water_removed, "g") << '\n';
}

/// What `/fidelity/mode` left out, the step whose error came nearest to its bound, and how far small strain
/// was left.
void describe_fidelity(std::ostream& out, const std::vector<sim::FidelityRecord>& steps) {
  const auto count_at = [&](sim::Rung rung) {
    return std::count_if(steps.begin(), steps.end(), [&](const auto& step) { return step.rung == rung; });
  };
  out << label("left out") << count_at(sim::Rung::asleep) << " of " << count(steps.size(), "step")
      << " asleep, " << count_at(sim::Rung::coasting) << " coasting";
  if (!steps.empty()) {
    const auto share = [](const sim::FidelityRecord& step) {
      return step.estimate > 0.0 ? step.estimate / step.bound : 0.0;
    };
    const auto nearest = std::max_element(steps.begin(), steps.end(),
                                          [&](const auto& a, const auto& b) { return share(a) < share(b); });
    const auto most = [&](double sim::FidelityRecord::*member) {
      return (*std::max_element(steps.begin(), steps.end(),
                                [&](const auto& a, const auto& b) { return a.*member < b.*member; })).*
             member;
    };
    out << "; estimate at most " << with_prefix(nearest->estimate, "N") << " of bound "
        << with_prefix(nearest->bound, "N");
    if (const double error = most(&sim::FidelityRecord::error); error > 0.0)
      out << ", error beside a full run at most " << with_prefix(error, "N");
    out << "; large strain " << rounded(100.0 * most(&sim::FidelityRecord::large_strain)) << " %";
  }
  out << '\n';
}

/// Wall clock: in all, beside the hand's time, and each stage, the longest first; then the processors' time.
void describe_timing(std::ostream& out, std::vector<std::pair<std::string, double>> timing, double moved) {
  std::stable_sort(timing.begin(), timing.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string stages;
  std::string processors;
  std::string of_passes;
  for (const auto& [name, value] : timing) {
    if (name == "total") {
      out << label("timing") << with_prefix(value, "s") << " of wall clock";
      if (moved > 0.0 && value > 0.0) out << ", " << rounded(value / moved) << " times as long as the motion";
      out << '\n';
    } else if (name == "tick_rate_Hz") {
      out << label("rate") << rounded(value) << " ticks in a second of wall clock\n";
    } else if (name == "cpu") {
      processors = label("cpu") + with_prefix(value, "s") + " of all processors together";
    } else if (name == schema::kCpuOfPasses) {
      of_passes = ", " + with_prefix(value, "s") + " in the passes before";
    } else if (name != "instructions" && !name.starts_with("num_")) {
      stages += (stages.empty() ? "" : ", ") + name + ' ' + with_prefix(value, "s");
    }
  }
  if (!stages.empty()) out << label("of it") << stages << '\n';
  if (!processors.empty()) out << processors << of_passes << '\n';
}

/// What the run was made from: notes of its start, build, hashes, a line each. The scenario has a page of its
/// own.
void describe_provenance(std::ostream& out, const ResultHeader& header) {
  for (const auto& [name, text] : header.provenance) {
    if (name == "about" || name == "scenario") continue;
    if (name == "contact" || name == "contact_cells") {
      out << label(name == "contact" ? "contact law" : "note") << text << '\n';
      continue;
    }
    std::istringstream lines(text);
    std::string joined;
    for (std::string line; std::getline(lines, line);) {
      if (name == "notes")
        out << label("note") << line << '\n';
      else
        joined += (joined.empty() ? "" : ", ") + line;
    }
    if (!joined.empty()) out << label("made from") << name << ": " << joined << '\n';
  }
}

}  // namespace

std::string describe_failure(const Failure& failure) {
  const auto says = [&](const char* words) { return failure.quantity.find(words) != std::string::npos; };
  const char* remedy = "";
  if (says("volume ratio"))
    remedy =
        "; the clay would turn inside out there, pressed further than cell, step or law bear: smaller cells "
        "(/body/cells/near_tool_m), shorter steps (/haptics/physics_period_ticks), a "
        "/dynamics/model of large strain, or /dynamics/strict false, which limits the motion";
  else if (says("trembles"))
    remedy =
        "; hand and contact shake each other: a lower /contact/stiffness_Pa_per_m, shorter steps "
        "(/haptics/physics_period_ticks), or /haptics/passivity";
  else if (says("kinetic energy"))
    remedy =
        "; the step is longer than this integrator bears: shorter steps (/haptics/period_s), or "
        "/dynamics/integrator backward_euler";
  else if (says("Newton") || says("line search"))
    remedy =
        "; the step is too long for its iterations: shorter steps (/haptics/physics_period_ticks), or "
        "more of /dynamics/newton/max_iterations";
  else if (says("residual") || says("positive definite") || says("balance"))
    remedy =
        "; the system is too stiff for its solver: /dynamics/solver/kind cholesky, shorter steps, or a "
        "mesh without flat tets";
  return to_string(failure) + remedy;
}

std::string describe_limits(const std::vector<sim::PhysicsRecord>& steps,
                            const std::vector<sim::HapticRecord>& ticks, int num_tets) {
  std::size_t limited = 0;
  std::size_t held = 0;
  int most = 0;
  const sim::PhysicsRecord* first = nullptr;
  for (const sim::PhysicsRecord& step : steps) {
    if (step.limited_tets == 0) continue;
    if (!first) first = &step;
    const bool is_held = step.limited_tets == num_tets;
    ++(is_held ? held : limited);
    if (!is_held) most = std::max(most, step.limited_tets);
  }
  const auto let_go = static_cast<std::size_t>(std::count_if(ticks.begin(), ticks.end(), [](const auto& t) {
    return (t.gate_events & device::kGateWatchdog) != 0;
  }));
  std::ostringstream out;
  if (limited > 0)
    out << "the motion of up to " << count(static_cast<std::size_t>(most), "tet") << " was limited in "
        << count(limited, "step") << ", or they would have turned inside out";
  if (held > 0) out << (limited > 0 ? "; " : "") << "the whole body was held back in " << count(held, "step");
  if (first) {
    out << ", first in tick " << first->tick;
    if (first->limited_tet >= 0) out << " (tet " << first->limited_tet << ')';
    out << "; force and shape are a bound there, not the clay's: a finer mesh or shorter steps help";
  }
  if (let_go > 0) out << (first ? "; " : "") << "the hand was let go in " << count(let_go, "tick");
  return out.str();
}

std::string describe_result(const ResultReader& reader) {
  const ResultHeader header = reader.read_header();
  const std::vector<FrameInfo> frames = reader.read_frame_list();
  const std::vector<sim::HapticRecord> haptic = reader.read_haptic();
  std::ostringstream out;
  out << label("file") << reader.file() << '\n';
  if (const auto about = reader.find_provenance("about")) out << label("about") << *about << '\n';
  describe_outcome(out, reader);
  describe_body(out, header);
  if (const int epochs = reader.num_epochs(); epochs > 0)
    out << label("cells") << "made anew " << count(static_cast<std::size_t>(epochs), "time")
        << ", the last time " << reader.read_cells(epochs).tets.cols() << " tets\n";
  describe_haptic(out, haptic, header.haptic_period);
  if (reader.has_force_error()) describe_force_error(out, haptic);
  const std::vector<sim::PhysicsRecord> steps = reader.read_physics();
  describe_physics(out, steps);
  if (const std::string limits = describe_limits(steps, haptic, static_cast<int>(header.tets.cols()));
      !limits.empty())
    out << label("limits") << limits << '\n';
  if (const auto fidelity = reader.find_fidelity()) describe_fidelity(out, *fidelity);
  if (const auto accuracy = reader.find_accuracy())
    out << label("accuracy") << "of the force at the hand about " << rounded(100.0 * (*accuracy)[1])
        << " %, wanted " << rounded(100.0 * (*accuracy)[0]) << " %\n";
  out << label("frames") << frames.size();
  if (!frames.empty())
    out << ", last at tick " << frames.back().tick << ", state " << frames.back().state_hash;
  out << '\n';
  describe_timing(out, reader.read_timing(), haptic.empty() ? 0.0 : haptic.back().time);
  describe_provenance(out, header);
  return out.str();
}

}  // namespace argil::output
