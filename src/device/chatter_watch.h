#pragma once

#include <array>

#include "base/archive.h"
#include "base/types.h"

namespace argil::device {

/// Sees the force at the hand tremble: what no hand moves by itself, held for so long that no poke does it.
///
/// The force goes through a high-pass filter [Butterworth1930, fourth order, bilinear] at 50 Hz. A stretch of
/// 0.06 s trembles when the rms of what is left is more than kLeastFelt and more than `limit` of the rms of
/// the force in it, which is not small beside the hardest touch so far; the hand chatters when five stretches
/// in a row do.
class ChatterWatch {
 public:
  static constexpr double kFrequency = 50.0;  ///< [Hz]
  static constexpr double kHeld = 0.3;        ///< [s]
  /// Least rms above kFrequency [N] that counts: about the faintest sine that a hand feels, which is some
  /// millinewton. Of the order of the displacement that a hand with a stylus detects (tenths of a µm at
  /// 250 Hz, some µm at 50 Hz) times its impedance at that frequency [Israr2006].
  static constexpr double kLeastFelt = 2e-3;

  /// `limit`: share of the rms, in (0, 1]; 1 sees nothing, nor does a `period` [s] of 10 ms or more, which
  /// has no such frequencies.
  ChatterWatch(double limit, double period);

  /// Takes the force [N] of the next tick.
  void add(const Vec3& force);
  /// Does the hand chatter, by what was seen so far?
  bool is_chattering() const;
  /// Rms above 50 Hz over rms of the stretches that tremble now, in a row.
  double share() const;

  void serialize(Archive& archive);

 private:
  /// Two poles of the filter, in the transposed direct form II.
  struct Section {
    double gain = 0.0;  // of the input, −2 of the last one, 1 of that before
    double a1 = 0.0;
    double a2 = 0.0;
    Eigen::Matrix<double, 3, 2> memory = Eigen::Matrix<double, 3, 2>::Zero();
    Vec3 pass(const Vec3& in);
  };
  /// Sums of squares over some ticks [N²].
  struct Power {
    double above = 0.0;
    double all = 0.0;
  };
  static Section make_section(double quality, double period);
  bool trembles(const Power& stretch) const;

  double m_limit;
  int m_stretch_ticks;  // 0: never looks
  std::array<Section, 2> m_filter;
  Power m_stretch;  // the one under way
  int m_ticks = 0;  // of it
  Power m_row;      // of stretches that tremble, one after the other
  int m_in_row = 0;
  double m_hardest = 0.0;  // Σ|F|² of a stretch so far [N²]
};

}  // namespace argil::device
