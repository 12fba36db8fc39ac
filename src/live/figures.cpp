#include "live/figures.h"

#include <cstdarg>
#include <cstdio>

namespace argil::live {
namespace {

[[gnu::format(printf, 1, 2)]] std::string format(const char* text, ...) {
  char line[256];
  std::va_list arguments;
  va_start(arguments, text);
  std::vsnprintf(line, sizeof line, text, arguments);
  va_end(arguments);
  return line;
}

constexpr double kQuantiles[] = {0.5, 0.99, 0.999};
constexpr const char* kQuantileNames[] = {"p50", "p99", "p999"};

}  // namespace

void Figures::add(const HandTick& tick) {
  m_wake_late.add(std::max(0.0, tick.timing.wake_late));
  m_work.add(tick.timing.work);
  m_missed += tick.timing.missed;
  m_sample_age.add(tick.timing.sample_age);
  if (tick.session.sample == m_last.session.sample) ++m_repeated;
  if (tick.session.seen_step != m_seen_step) m_seen_begun_at = m_begun_at;
  m_seen_step = tick.session.seen_step;
  if (tick.session.begun_step != 0) m_begun_at = tick.record.tick;
  m_surface_age.add(static_cast<double>(tick.record.tick - m_seen_begun_at));
  m_force_age.add(tick.record.force_age);
  if (tick.record.gate_events != 0) ++m_gated;
  m_last = tick;
}

void Figures::add(const BodyStep& step) {
  m_step_work.add(step.timing.work);
  if (step.timing.late > 0) ++m_late_steps;
  m_late_ticks += step.timing.late;
  if (step.record.limited_tets > 0) ++m_limited;
  m_water = step.record.water_mass;
}

std::vector<std::pair<std::string, double>> Figures::list() const {
  std::vector<std::pair<std::string, double>> list;
  const auto add_quantiles = [&](const std::string& name, const Distribution& of) {
    for (std::size_t i = 0; i < std::size(kQuantiles); ++i)
      list.emplace_back(name + "_" + kQuantileNames[i], of.quantile(kQuantiles[i]));
    list.emplace_back(name + "_max", of.largest());
  };
  add_quantiles("wake_late", m_wake_late);
  add_quantiles("tick_work", m_work);
  add_quantiles("step_work", m_step_work);
  add_quantiles("picture_delay", m_picture_delay);
  add_quantiles("sample_age", m_sample_age);
  add_quantiles("num_force_age_ticks", m_force_age);
  add_quantiles("num_surface_age_ticks", m_surface_age);
  list.emplace_back("num_ticks", static_cast<double>(m_wake_late.total()));
  list.emplace_back("num_missed_ticks", static_cast<double>(m_missed));
  list.emplace_back("num_repeated_samples", static_cast<double>(m_repeated));
  list.emplace_back("num_steps", static_cast<double>(m_step_work.total()));
  list.emplace_back("num_late_steps", static_cast<double>(m_late_steps));
  list.emplace_back("num_late_ticks", static_cast<double>(m_late_ticks));
  list.emplace_back("num_limited_steps", static_cast<double>(m_limited));
  list.emplace_back("num_gated_ticks", static_cast<double>(m_gated));
  return list;
}

std::string Figures::print() const {
  const auto row = [](const char* name, const Distribution& of, double unit, const char* unit_name) {
    return format("  %-22s %9.3g %9.3g %9.3g %9.3g %s\n", name, of.quantile(0.5) / unit,
                  of.quantile(0.99) / unit, of.quantile(0.999) / unit, of.largest() / unit, unit_name);
  };
  std::string text = format("  %-22s %9s %9s %9s %9s\n", "", "p50", "p99", "p99.9", "max");
  text += row("woken late", m_wake_late, 1e-6, "us");
  text += row("a tick's work", m_work, 1e-6, "us");
  text += row("a step's work", m_step_work, 1e-3, "ms");
  text += row("age of the sample", m_sample_age, 1e-3, "ms");
  text += row("age of the force", m_force_age, 1.0, "ticks");
  text += row("age of the surface", m_surface_age, 1.0, "ticks");
  if (m_picture_delay.total() > 0) text += row("from force to picture", m_picture_delay, 1e-3, "ms");
  text += format(
      "  %lld ticks, %lld missed, %lld without a new sample; %lld steps, %lld late by %lld ticks in all, "
      "%lld of limited motion; %lld ticks gated\n",
      static_cast<long long>(m_wake_late.total()), static_cast<long long>(m_missed),
      static_cast<long long>(m_repeated), static_cast<long long>(m_step_work.total()),
      static_cast<long long>(m_late_steps), static_cast<long long>(m_late_ticks),
      static_cast<long long>(m_limited), static_cast<long long>(m_gated));
  return text;
}

std::string Figures::print_now(double seconds, double water_capacity) const {
  const double rate = seconds > 0.0 ? static_cast<double>(m_wake_late.total()) / seconds : 0.0;
  return format(
      "%7.1f s  %5.0f ticks/s  force %6.3f N  S %5.1f %%  late %4.0f us p99  missed %lld  late steps %lld",
      seconds, rate, m_last.record.device_force.norm(), 100.0 * m_water / water_capacity,
      1e6 * m_wake_late.quantile(0.99), static_cast<long long>(m_missed),
      static_cast<long long>(m_late_steps));
}

}  // namespace argil::live
