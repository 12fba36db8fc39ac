#include "output/info.h"

#include <algorithm>
#include <array>
#include <sstream>

#include "output/result_reader.h"

namespace argil::output {
namespace {

void describe_outcome(std::ostream& out, const ResultReader& reader) {
  out << "outcome     ";
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
      out << "failed: " << (failure ? to_string(*failure) : "no reason recorded") << '\n';
      break;
    }
  }
}

void describe_body(std::ostream& out, const ResultHeader& header) {
  out << "body        " << header.rest_position.cols() << " vertices, " << header.tets.cols() << " tets, "
      << header.surface_triangles.cols() << " surface triangles";
  if (header.skin_triangles.cols() > 0) out << ", skin of " << header.skin_triangles.cols() << " triangles";
  if (header.rest_position.cols() > 0) {
    const Vec3 size = header.rest_position.rowwise().maxCoeff() - header.rest_position.rowwise().minCoeff();
    out << "; " << size.x() << " × " << size.y() << " × " << size.z() << " m";
  }
  out << "\ntool        " << header.tool.num_vertices() << " vertices, " << header.tool.num_triangles()
      << " triangles\n";
}

void describe_haptic(std::ostream& out, const std::vector<sim::HapticRecord>& records, double period) {
  out << "haptic      " << records.size() << " ticks of " << period << " s";
  if (records.empty()) {
    out << '\n';
    return;
  }
  out << ", " << records.back().time << " s\n";
  // The first of equal maxima, so that the answer does not depend on anything else.
  const auto peak = std::max_element(records.begin(), records.end(), [](const auto& a, const auto& b) {
    return a.force.stableNorm() < b.force.stableNorm();
  });
  out << "peak force  " << peak->force.stableNorm() << " N at " << peak->time << " s (device "
      << peak->device_force.stableNorm() << " N), torque " << peak->torque.stableNorm() << " N m\n";
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
  out << "contact     " << touching << " ticks; modes";
  for (std::size_t mode = 0; mode < in_mode.size(); ++mode)
    if (in_mode[mode] > 0)
      out << ' ' << to_string(static_cast<device::ToolMode>(mode)) << ' ' << in_mode[mode];
  out << "; oldest force " << oldest << " ticks; output gate acted in " << gated << '\n';
}

void describe_physics(std::ostream& out, const std::vector<sim::PhysicsRecord>& records) {
  out << "physics     " << records.size() << " steps";
  if (records.empty()) {
    out << '\n';
    return;
  }
  double smallest_volume = records.front().min_volume_ratio;
  double largest_plastic = 0.0;
  double largest_residual = 0.0;
  int most_active = 0;
  for (const sim::PhysicsRecord& record : records) {
    smallest_volume = std::min(smallest_volume, record.min_volume_ratio);
    largest_plastic = std::max(largest_plastic, record.max_plastic_strain);
    largest_residual = std::max(largest_residual, record.residual);
    most_active = std::max(most_active, record.active_nodes);
  }
  const sim::PhysicsRecord& first = records.front();
  const sim::PhysicsRecord& last = records.back();
  out << ", at most " << most_active << " active vertices, " << last.factorisations
      << " factorisations, largest residual " << largest_residual << '\n';
  out << "body state  smallest volume ratio " << smallest_volume << ", largest plastic strain "
      << largest_plastic << '\n';
  out << "energy      kinetic " << last.kinetic_energy << " J, elastic " << last.elastic_energy
      << " J, dissipated " << last.plastic_dissipation << " J, contact work " << last.contact_work
      << " J at the end\n";
  out << "water       " << first.water_mass << " kg after the first step, " << last.water_mass
      << " kg at the end; added " << last.water_added << " kg, removed " << last.water_removed << " kg\n";
}

}  // namespace

std::string describe_result(const std::string& file) {
  const ResultReader reader(file);
  const ResultHeader header = reader.read_header();
  const std::vector<FrameInfo> frames = reader.read_frame_list();
  std::ostringstream out;
  out.precision(6);
  out << "file        " << file << '\n';
  describe_outcome(out, reader);
  describe_body(out, header);
  describe_haptic(out, reader.read_haptic(), header.haptic_period);
  describe_physics(out, reader.read_physics());
  out << "frames      " << frames.size();
  if (!frames.empty())
    out << ", last at tick " << frames.back().tick << ", state " << frames.back().state_hash;
  out << '\n';
  for (const auto& [name, text] : header.provenance) {
    constexpr std::size_t kShort = 100;  // scenarios have pages of their own (argil show)
    if (text.size() <= kShort && text.find('\n') == std::string::npos)
      out << "made from   " << name << ": " << text << '\n';
  }
  for (const auto& [name, value] : reader.read_timing())
    out << "timing      " << name << ": " << value << (name.ends_with("_Hz") ? " Hz\n" : " s\n");
  return out.str();
}

}  // namespace argil::output
