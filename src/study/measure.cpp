#include "study/measure.h"

#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "device/chatter_watch.h"
#include "embed/tet_locator.h"
#include "study/displacement_field.h"

namespace argil::study {
namespace {

constexpr double kTouchShare = 0.05;   // of the peak force: below, relative errors say nothing
constexpr double kSameTime = 1e-9;     // [s]
constexpr double kLeastCovered = 0.9;  // of the truth's volume that a mesh must share with it

/// Σ|a − b|² and Σ|b|², weighted.
struct Squares {
  double difference = 0.0;
  double truth = 0.0;
  void add(double weight, double difference_squared, double truth_squared) {
    difference += weight * difference_squared;
    truth += weight * truth_squared;
  }
  double relative() const { return truth > 0.0 ? std::sqrt(difference / truth) : kUnknown; }
};

/// The truth's records at the times of a run's; none when one is missing.
std::vector<sim::HapticRecord> find_records(const std::vector<sim::HapticRecord>& run,
                                            const std::vector<sim::HapticRecord>& truth) {
  std::vector<sim::HapticRecord> found;
  std::size_t k = 0;
  for (const sim::HapticRecord& record : run) {
    while (k < truth.size() && truth[k].time < record.time - kSameTime) ++k;
    if (k == truth.size() || truth[k].time > record.time + kSameTime) return {};
    found.push_back(truth[k]);
  }
  return found;
}

void compare_forces(const std::vector<sim::HapticRecord>& run, const std::vector<sim::HapticRecord>& truth,
                    RunErrors& errors) {
  Squares all;
  for (std::size_t k = 0; k < truth.size(); ++k)
    all.add(1.0, (run[k].force - truth[k].force).squaredNorm(), truth[k].force.squaredNorm());
  const double true_peak = compute_peak_force(truth);
  if (!(true_peak > 0.0)) return;
  errors.force = all.relative();
  errors.peak_force = std::abs(compute_peak_force(run) - true_peak) / true_peak;
  double touched = 0.0;
  double above_7 = 0.0;
  double above_10 = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double force = truth[k].force.norm();
    if (!(force > kTouchShare * true_peak)) continue;
    const double error = (run[k].force - truth[k].force).norm() / force;
    touched += 1.0;
    above_7 += error > 0.07 ? 1.0 : 0.0;
    above_10 += error > 0.10 ? 1.0 : 0.0;
  }
  errors.above_7_percent = above_7 / touched;
  errors.above_10_percent = above_10 / touched;
}

/// The truth's tets, and where their centroids lie in a run's mesh.
class Samples {
 public:
  Samples(const output::ResultHeader& run, const output::ResultHeader& truth,
          const ComparedElements& elements)
      : m_run(run),
        m_truth(truth),
        m_run_field(run.rest_position, run.tets, elements.run),
        m_true_field(truth.rest_position, truth.tets, elements.truth),
        m_volume(truth.tets.cols()),
        m_place(static_cast<std::size_t>(truth.tets.cols())) {
    const embed::TetLocator locator({run.rest_position, run.tets, {}});
    double covered = 0.0;
    for (Eigen::Index t = 0; t < truth.tets.cols(); ++t) {
      const auto corner = [&](int i) -> Vec3 { return truth.rest_position.col(truth.tets(i, t)); };
      m_volume(t) = mesh::compute_tet_volume(corner(0), corner(1), corner(2), corner(3));
      m_place[static_cast<std::size_t>(t)] =
          locator.find(0.25 * (corner(0) + corner(1) + corner(2) + corner(3)));
      if (m_place[static_cast<std::size_t>(t)].tet >= 0) covered += m_volume(t);
    }
    m_is_comparable = covered >= kLeastCovered * m_volume.sum();
  }
  bool is_comparable() const { return m_is_comparable; }

  void compare(const sim::Frame& run, const sim::Frame& truth, Squares& displacement, Squares& saturation) {
    m_run_field.set(run.position - m_run.rest_position);
    m_true_field.set(truth.position - m_truth.rest_position);
    for (Eigen::Index t = 0; t < m_volume.size(); ++t) {
      const embed::TetLocator::Place& place = m_place[static_cast<std::size_t>(t)];
      if (place.tet < 0) continue;
      const Vec3 u = m_run_field.find(place.tet, place.weights);
      const Vec3 u_true = m_true_field.find(static_cast<int>(t), Vec4::Constant(0.25));
      displacement.add(m_volume(t), (u - u_true).squaredNorm(), u_true.squaredNorm());
      const double S = truth.saturation(t);
      saturation.add(m_volume(t), std::pow(run.saturation(place.tet) - S, 2), S * S);
    }
  }

 private:
  const output::ResultHeader& m_run;
  const output::ResultHeader& m_truth;
  DisplacementField m_run_field;
  DisplacementField m_true_field;
  Field m_volume;
  std::vector<embed::TetLocator::Place> m_place;
  bool m_is_comparable = false;
};

std::optional<output::FrameInfo> find_frame(const std::vector<output::FrameInfo>& list, double time) {
  for (const output::FrameInfo& info : list)
    if (std::abs(info.time - time) <= kSameTime) return info;
  return {};
}

bool is_same_skin(const Triangles& a, const Triangles& b) {
  return a.cols() == b.cols() && a.cols() > 0 && a == b;
}

void compare_frames(const output::ResultReader& run, const output::ResultReader& truth,
                    const ComparedElements& elements, RunErrors& errors) {
  const output::ResultHeader run_header = run.read_header();
  const output::ResultHeader true_header = truth.read_header();
  Samples samples(run_header, true_header, elements);
  const bool has_same_skin = is_same_skin(run_header.skin_triangles, true_header.skin_triangles);
  const std::vector<output::FrameInfo> frames = run.read_frame_list();
  Squares displacement, saturation, skin;
  std::optional<Points> rest_run, rest_true;
  for (const output::FrameInfo& info : truth.read_frame_list()) {
    const auto same = find_frame(frames, info.time);
    if (!same) continue;
    const sim::Frame a = run.read_frame(*same);
    const sim::Frame b = truth.read_frame(info);
    if (!rest_true) {
      rest_run = a.skin_position;
      rest_true = b.skin_position;
    }
    if (samples.is_comparable()) samples.compare(a, b, displacement, saturation);
    if (has_same_skin && a.skin_position.cols() == b.skin_position.cols())
      skin.add(1.0, (a.skin_position - *rest_run - b.skin_position + *rest_true).squaredNorm(),
               (b.skin_position - *rest_true).squaredNorm());
  }
  errors.displacement = displacement.relative();
  errors.saturation = saturation.relative();
  errors.skin = skin.relative();
}

double compute_chatter(const std::vector<sim::HapticRecord>& haptic) {
  if (haptic.empty()) return 0.0;
  Points force(3, static_cast<Eigen::Index>(haptic.size()));
  for (std::size_t k = 0; k < haptic.size(); ++k) force.col(static_cast<Eigen::Index>(k)) = haptic[k].force;
  return compute_share_above(force, haptic.back().time / static_cast<double>(haptic.size()),
                             device::ChatterWatch::kFrequency);
}

/// Does nothing but the hand work on the body: no gravity, load, support that moves, or clay that swells?
bool works_by_hand_alone(const scenario::Scenario& s) {
  const auto moves = [](const solid::Support& support) { return !support.displacement.isZero(0.0); };
  return s.params.solid.gravity.isZero(0.0) && s.body.loads.nodal.empty() && s.body.loads.pressure.empty() &&
         std::none_of(s.body.fixed.begin(), s.body.fixed.end(), moves) && s.params.water.swelling == 0.0;
}

}  // namespace

RunErrors compute_errors(const output::ResultReader& run, const output::ResultReader& truth,
                         const ComparedElements& elements) {
  RunErrors errors;
  const auto haptic = run.read_haptic();
  const auto records = find_records(haptic, truth.read_haptic());
  if (records.size() != haptic.size())
    throw InputError(run.file(), "/haptic", "has ticks that " + truth.file() + " has not",
                     "compare runs of one motion, the truth's period a whole part of the other's");
  compare_forces(haptic, records, errors);
  errors.true_chatter = compute_chatter(records);
  compare_frames(run, truth, elements, errors);
  const auto run_physics = run.read_physics();
  const auto true_physics = truth.read_physics();
  if (!run_physics.empty() && !true_physics.empty() && true_physics.back().plastic_dissipation > 0.0)
    errors.dissipation =
        std::abs(run_physics.back().plastic_dissipation / true_physics.back().plastic_dissipation - 1.0);
  return errors;
}

double compute_share_above(const Points& force, double period, double frequency) {
  const Eigen::Index n = force.cols();
  if (n < 2) return 0.0;
  Eigen::FFT<double> fft;
  double above = 0.0;
  double all = 0.0;
  std::vector<double> series(static_cast<std::size_t>(n));
  std::vector<std::complex<double>> spectrum;
  for (int k = 0; k < 3; ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const double window = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                                                 static_cast<double>(n));
      series[static_cast<std::size_t>(i)] = window * force(k, i);
    }
    fft.fwd(spectrum, series);
    for (std::size_t i = 0; i < spectrum.size(); ++i) {
      const double cycles = static_cast<double>(std::min(i, spectrum.size() - i));
      const double power = std::norm(spectrum[i]);
      all += power;
      above += cycles / (static_cast<double>(n) * period) > frequency ? power : 0.0;
    }
  }
  return all > 0.0 ? std::sqrt(above / all) : 0.0;
}

double compute_peak_force(const std::vector<sim::HapticRecord>& haptic) {
  double peak = 0.0;
  for (const sim::HapticRecord& record : haptic) peak = std::max(peak, record.force.norm());
  return peak;
}

RunFigures compute_figures(const output::ResultReader& run, const scenario::Scenario& s) {
  RunFigures figures;
  const auto haptic = run.read_haptic();
  figures.peak_force = compute_peak_force(haptic);
  figures.simulated_seconds = haptic.empty() ? 0.0 : haptic.back().time;
  figures.chatter = compute_chatter(haptic);
  if (!works_by_hand_alone(s)) figures.energy_gain = kUnknown;
  const auto physics = run.read_physics();
  if (physics.empty()) return figures;
  const auto energy = [](const sim::PhysicsRecord& r) {
    return r.kinetic_energy + r.elastic_energy + r.plastic_dissipation;
  };
  double scale = physics.front().kinetic_energy + physics.front().elastic_energy;
  double gain = 0.0;
  for (const sim::PhysicsRecord& r : physics) {
    figures.solves += std::max(1, r.newton_iterations);
    figures.iterations += r.iterations;
    scale = std::max(scale, std::abs(r.contact_work));
    gain =
        std::max(gain, energy(r) - energy(physics.front()) - (r.contact_work - physics.front().contact_work));
  }
  figures.steps = static_cast<double>(physics.size());
  figures.factorisations = physics.back().factorisations;
  if (!std::isnan(figures.energy_gain)) figures.energy_gain = scale > 0.0 ? gain / scale : 0.0;
  return figures;
}

}  // namespace argil::study
