#include "study/sweep_figures.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace argil::study {
namespace {

void add_force(const output::ResultReader& result, SweepFigures& figures) {
  const std::vector<sim::HapticRecord> records = result.read_haptic();
  if (records.empty()) return;  // an equilibrium without a hand
  figures.peak_force = 0.0;
  double sum = 0.0;
  double whole = 0.0;
  std::size_t touching = 0;
  for (const sim::HapticRecord& record : records) {
    const double force = record.force.norm();
    figures.peak_force = std::max(figures.peak_force, force);
    whole += force;
    if (record.num_contacts == 0) continue;
    sum += force;
    ++touching;
  }
  figures.impulse = whole * result.read_header().haptic_period;
  figures.mean_force = touching > 0 ? sum / static_cast<double>(touching) : 0.0;
}

void add_books(const output::ResultReader& result, SweepFigures& figures) {
  const std::vector<sim::PhysicsRecord> records = result.read_physics();
  if (records.empty()) return;
  const sim::PhysicsRecord& first = records.front();
  const sim::PhysicsRecord& last = records.back();
  const double initial = first.water_mass - first.water_added + first.water_removed;
  figures.work = last.contact_work;
  figures.dissipation = last.plastic_dissipation;
  figures.final_water = last.water_mass;
  figures.water_added = last.water_added;
  figures.water_removed = last.water_removed;
  figures.water_error = last.water_mass - initial - last.water_added + last.water_removed;
  figures.steps = static_cast<double>(records.size());
  figures.iterations = 0.0;
  for (const sim::PhysicsRecord& record : records) figures.iterations += record.iterations;
  figures.factorisations = last.factorisations;
}

double compute_volume(const Points& x, const Tets& tets, Eigen::Index t) {
  Mat3 edges;
  for (Eigen::Index k = 0; k < 3; ++k) edges.col(k) = x.col(tets(k + 1, t)) - x.col(tets(0, t));
  return edges.determinant() / 6.0;
}

/// Displacements: of the cells at the start, as long as the body has them.
void add_frames(const output::ResultReader& result, SweepFigures& figures) {
  const output::CellMesh start = result.read_cells(0);
  figures.indentation = 0.0;
  sim::Frame frame;
  int epoch = 0;
  for (const output::FrameInfo& info : result.read_frame_list()) {
    frame = result.read_frame(info);
    epoch = info.epoch;
    if (epoch == 0 && frame.position.cols() > 0)
      figures.indentation =
          std::max(figures.indentation, (frame.position - start.rest_position).colwise().norm().maxCoeff());
  }
  if (frame.saturation.size() == 0) return;
  const output::CellMesh cells = result.read_cells(epoch);
  double wet = 0.0, whole = 0.0;
  for (Eigen::Index t = 0; t < cells.tets.cols(); ++t) {
    const double volume = compute_volume(cells.rest_position, cells.tets, t);
    wet += frame.saturation(t) * volume;
    whole += volume;
  }
  figures.final_saturation = wet / whole;
}

/// HDF5 takes / for a folder.
std::string name_column(const std::string& pointer) {
  std::string name = pointer.substr(1);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

}  // namespace

SweepFigures compute_sweep_figures(const output::ResultReader& result) {
  SweepFigures figures;
  add_force(result, figures);
  add_books(result, figures);
  add_frames(result, figures);
  return figures;
}

void SweepTable::add(const scenario::SweepPoint& point, const std::string& outcome, const std::string& reason,
                     const SweepFigures& figures) {
  m_rows.push_back({point, outcome, reason, figures});
}

output::StudyTable SweepTable::take() {
  output::StudyTable table;
  std::vector<std::string> pointers;
  for (const Row& row : m_rows)
    for (const scenario::Setting& setting : row.point.settings)
      if (std::find(pointers.begin(), pointers.end(), setting.pointer) == pointers.end())
        pointers.push_back(setting.pointer);
  table.columns.push_back({"index", "1", "place in the sweep, from 0"});
  table.columns.push_back({"id", "-", "hash of scenario, inputs and build"});
  for (const std::string& pointer : pointers)
    table.columns.push_back({name_column(pointer), "-", "setting of the scenario's key " + pointer, true});
  const std::vector<std::pair<output::StudyTable::Column, double SweepFigures::*>> figures = {
      {{"peak_force_N", "N", "largest force at the hand"}, &SweepFigures::peak_force},
      {{"mean_force_N", "N", "mean force at the hand over the ticks in touch"}, &SweepFigures::mean_force},
      {{"work_J", "J", "work of the contact forces on the body"}, &SweepFigures::work},
      {{"dissipation_J", "J", "energy dissipated by plastic flow"}, &SweepFigures::dissipation},
      {{"indentation_m", "m", "largest displacement of a vertex from rest over the frames"},
       &SweepFigures::indentation},
      {{"final_saturation", "1", "mean saturation of the last frame by volume"},
       &SweepFigures::final_saturation},
      {{"water_added_kg", "kg", "water given by the tool"}, &SweepFigures::water_added},
      {{"water_removed_kg", "kg", "water taken by the tool"}, &SweepFigures::water_removed},
      {{"water_error_kg", "kg", "water gained less what was added and taken"}, &SweepFigures::water_error},
      {{"steps", "1", "physics steps"}, &SweepFigures::steps},
      {{"iterations", "1", "iterations of the linear solver"}, &SweepFigures::iterations},
      {{"factorisations", "1", "factorisations of the system matrix"}, &SweepFigures::factorisations}};
  for (const auto& [column, member] : figures) table.columns.push_back(column);
  table.columns.push_back({"outcome", "-", "done, failed or missing"});
  table.columns.push_back({"reason", "-", "why there are no figures"});
  for (const Row& row : m_rows) {
    std::vector<output::StudyTable::Cell> cells = {static_cast<double>(row.point.index), row.point.id};
    for (const std::string& pointer : pointers) {
      const auto found = std::find_if(row.point.settings.begin(), row.point.settings.end(),
                                      [&](const scenario::Setting& s) { return s.pointer == pointer; });
      cells.push_back(found == row.point.settings.end() ? output::StudyTable::Cell(SweepFigures::kNone)
                                                        : scenario::parse_value(*found));
    }
    for (const auto& [column, member] : figures) cells.emplace_back(row.figures.*member);
    cells.emplace_back(row.outcome);
    cells.emplace_back(row.reason);
    table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace argil::study
