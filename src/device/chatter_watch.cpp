#include "device/chatter_watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace argil::device {
namespace {

constexpr int kStretchesInRow = 5;
constexpr double kStretch = ChatterWatch::kHeld / kStretchesInRow;  // [s]
constexpr double kTouchShare = 0.05;  // of the hardest touch: a lighter one says nothing

}  // namespace

ChatterWatch::ChatterWatch(double limit, double period)
    : m_limit(limit), m_stretch_ticks(static_cast<int>(std::lround(kStretch / period))) {
  if (!(limit < 1.0) || !(2.0 * kFrequency * period < 1.0)) m_stretch_ticks = 0;
  if (m_stretch_ticks == 0) return;
  // Qualities of the pole pairs of a Butterworth filter of fourth order.
  m_filter = {make_section(0.5 / std::cos(std::numbers::pi / 8.0), period),
              make_section(0.5 / std::cos(3.0 * std::numbers::pi / 8.0), period)};
}

ChatterWatch::Section ChatterWatch::make_section(double quality, double period) {
  const double k = std::tan(std::numbers::pi * kFrequency * period);  // the pole's place, warped
  const double scale = 1.0 / (1.0 + k / quality + k * k);
  Section section;
  section.gain = scale;
  section.a1 = 2.0 * (k * k - 1.0) * scale;
  section.a2 = (1.0 - k / quality + k * k) * scale;
  return section;
}

Vec3 ChatterWatch::Section::pass(const Vec3& in) {
  const Vec3 out = gain * in + memory.col(0);
  memory.col(0) = -2.0 * gain * in - a1 * out + memory.col(1);
  memory.col(1) = gain * in - a2 * out;
  return out;
}

bool ChatterWatch::trembles(const Power& stretch) const {
  const double touch = kTouchShare * kTouchShare * m_hardest;
  const double felt = kLeastFelt * kLeastFelt * m_stretch_ticks;
  return stretch.above > felt && stretch.above > m_limit * m_limit * stretch.all && stretch.all > touch;
}

void ChatterWatch::add(const Vec3& force) {
  if (m_stretch_ticks == 0) return;
  m_stretch.above += m_filter[1].pass(m_filter[0].pass(force)).squaredNorm();
  m_stretch.all += force.squaredNorm();
  if (++m_ticks < m_stretch_ticks) return;
  m_hardest = std::max(m_hardest, m_stretch.all);
  if (trembles(m_stretch)) {
    m_row.above += m_stretch.above;
    m_row.all += m_stretch.all;
    ++m_in_row;
  } else {
    m_row = {};
    m_in_row = 0;
  }
  m_stretch = {};
  m_ticks = 0;
}

bool ChatterWatch::is_chattering() const {
  return m_in_row >= kStretchesInRow;
}

double ChatterWatch::share() const {
  return m_row.all > 0.0 ? std::sqrt(m_row.above / m_row.all) : 0.0;
}

void ChatterWatch::serialize(Archive& archive) {
  archive.array("hand/chatter_filter_first", m_filter[0].memory);
  archive.array("hand/chatter_filter_second", m_filter[1].memory);
  archive.number("hand/chatter_above", m_stretch.above);
  archive.number("hand/chatter_all", m_stretch.all);
  archive.number("hand/chatter_ticks", m_ticks);
  archive.number("hand/chatter_row_above", m_row.above);
  archive.number("hand/chatter_row_all", m_row.all);
  archive.number("hand/chatter_in_row", m_in_row);
  archive.number("hand/chatter_hardest", m_hardest);
}

}  // namespace argil::device
