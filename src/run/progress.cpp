#include "run/progress.h"

#include <unistd.h>

#include <cstdio>

namespace argil::run {

Progress::Progress(Tick num_ticks, bool enabled)
    : m_num_ticks(num_ticks),
      m_enabled(enabled && isatty(STDERR_FILENO) == 1),
      m_start(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
  if (m_enabled && m_last_drawn >= 0.0) std::fputc('\n', stderr);
}

void Progress::update(Tick tick) {
  if (!m_enabled) return;
  constexpr double kRedraw = 0.2;  // s
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - m_start).count();
  if (tick < m_num_ticks && elapsed - m_last_drawn < kRedraw) return;
  draw(tick, elapsed);
  m_last_drawn = elapsed;
}

void Progress::draw(Tick tick, double elapsed) {
  constexpr int kWidth = 30;
  const double share = static_cast<double>(tick) / static_cast<double>(m_num_ticks);
  const double rate = elapsed > 0.0 ? static_cast<double>(tick) / elapsed : 0.0;
  const double left = rate > 0.0 ? static_cast<double>(m_num_ticks - tick) / rate : 0.0;
  char bar[kWidth + 1];
  for (int i = 0; i < kWidth; ++i) bar[i] = i < share * kWidth ? '#' : '.';
  bar[kWidth] = '\0';
  std::fprintf(stderr, "\r[%s] %5.1f %%  %.0f ticks/s  %.0f s left   ", bar, 100.0 * share, rate, left);
  std::fflush(stderr);
}

}  // namespace argil::run
