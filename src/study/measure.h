#pragma once

#include <limits>

#include "output/result_reader.h"
#include "scenario/scenario.h"
#include "solid/parameters.h"

namespace argil::study {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();  ///< not comparable, or no such thing

/// How far a run is from one that counts as the truth, on the same motion. Relative unless said otherwise.
struct RunErrors {
  double force = kUnknown;             ///< ‖F − F₀‖₂/‖F₀‖₂ over the haptic ticks
  double peak_force = kUnknown;        ///< of max |F|
  double above_7_percent = kUnknown;   ///< share of the ticks in touch where |F − F₀| > 7 % of |F₀| …
  double above_10_percent = kUnknown;  ///< … 10 %: the range of the just noticeable difference of force
  double displacement = kUnknown;      ///< L² over the truth's body and all frames that both have, by the
                                       ///< centroids of its tets, each with its volume (DisplacementField)
  double skin = kUnknown;              ///< the same over skin vertices; both must have the same skin
  double saturation = kUnknown;        ///< L² over the truth's tets and all common frames
  double true_chatter =
      kUnknown;  ///< the truth's own RunFigures::chatter: a hand that pokes does what trembles
  double dissipation = kUnknown;  ///< of the plastic dissipation at the end
};

/// Of what elements the bodies of two results are.
struct ComparedElements {
  solid::ElementKind run = solid::ElementKind::p1;
  solid::ElementKind truth = solid::ElementKind::p1;
};

/// Compares two results at the times of the run's ticks and frames. Displacement and saturation stay unknown
/// where less than nine tenths of the truth's body lie in the run's mesh, and every error of what the truth
/// has none of. Throws InputError when the truth lacks a tick.
RunErrors compute_errors(const output::ResultReader& run, const output::ResultReader& truth,
                         const ComparedElements& elements = {});

/// What a run's own records say about it.
struct RunFigures {
  double simulated_seconds = 0.0;
  double steps = 0.0;       ///< of physics
  double solves = 0.0;      ///< linearisations, one a step without Newton
  double iterations = 0.0;  ///< of the linear solver
  double factorisations = 0.0;
  double peak_force = 0.0;  ///< [N]
  double energy_gain =
      0.0;  ///< largest K + W + D − contact work since the start, over the largest |contact
            ///< work| or K + W at the start; no number where more than the hand works on the body
  double chatter = 0.0;  ///< rms of the hand force above 50 Hz over its rms
};

/// `s` is what was run.
RunFigures compute_figures(const output::ResultReader& run, const scenario::Scenario& s);

/// Largest |F| at the hand [N].
double compute_peak_force(const std::vector<sim::HapticRecord>& haptic);

/// Rms of a series of forces (3×n) above `frequency` [Hz] over its rms, Hann windowed; `period` [s] apart.
double compute_share_above(const Points& force, double period, double frequency);

}  // namespace argil::study
