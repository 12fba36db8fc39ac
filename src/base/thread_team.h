#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace argil {

/// Threads that help the one that made them with its loops. A loop is cut into chunks which any of them
/// takes; the maker takes those that no other has, so that a helper that the system has put aside keeps it
/// waiting for one chunk at most. One that finds nothing to do looks for a tenth of a millisecond and then
/// sleeps.
class ThreadTeam {
 public:
  /// `threads` in all, with the calling one. Throws IoError when the system gives no more.
  explicit ThreadTeam(int threads);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  int size() const { return static_cast<int>(m_threads.size()) + 1; }
  std::ptrdiff_t num_chunks() const { return static_cast<std::ptrdiff_t>(m_takers.size()); }

  /// Calls body(c) once for each chunk c and returns when all are done. Only by the thread that made this; a
  /// body may not throw.
  template <class Body>
  void run(Body& body) {
    run_job([](void* it, std::ptrdiff_t chunk) noexcept { (*static_cast<Body*>(it))(chunk); }, &body);
  }

  /// The calling thread's own, made when it asks for another number of threads than before.
  static ThreadTeam& of_this_thread(int threads);

 private:
  using Job = void (*)(void* body, std::ptrdiff_t chunk) noexcept;
  struct alignas(64) Taker {  // apart from the next, which another thread may be about to take
    std::atomic<unsigned> job = 0;
  };

  void run_job(Job job, void* body);
  void help(int index);
  void take_chunks(unsigned number, int index);
  void stop();

  // What to do. A helper may read the next job's in the place of its own, but then its own is done, and it
  // takes no chunk of it.
  std::atomic<Job> m_job = nullptr;
  std::atomic<void*> m_body = nullptr;
  alignas(64) std::atomic<unsigned> m_number = 0;    // of the job, counted
  alignas(64) std::atomic<unsigned> m_num_done = 0;  // chunks of all jobs, counted
  std::vector<Taker> m_takers;                       // number of the last job of which each chunk was taken
  std::vector<std::thread> m_threads;
};

}  // namespace argil
