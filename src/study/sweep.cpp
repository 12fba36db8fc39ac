#include "study/sweep.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <vector>

#include "base/error.h"
#include "output/result_reader.h"
#include "output/study_table.h"
#include "output/text.h"
#include "run/files.h"
#include "run/identity.h"
#include "run/interrupt.h"
#include "run/run.h"
#include "scenario/scenario.h"
#include "scenario/sweep_file.h"
#include "study/point_lock.h"
#include "study/sweep_figures.h"

namespace argil::study {
namespace {

namespace fs = std::filesystem;
using scenario::SweepPoint;

/// A file's folder, the same whatever it is called and through whatever links.
fs::path find_folder(const std::string& file) {
  return fs::weakly_canonical(fs::absolute(file).parent_path());
}

void check_points_name(const std::string& points) {
  if (!fs::path(points).has_extension())
    throw InputError(points, "", "has no ending, and the results lie in a folder of its name without that",
                     "give a name such as points.jsonl");
}

/// Where a point's files are: FOLDER/000012 without suffix.
std::string name_point(const std::string& points, std::int64_t index) {
  char number[24];
  std::snprintf(number, sizeof number, "%06lld", static_cast<long long>(index));
  return (fs::path(points).replace_extension() / number).string();
}

/// Loads the points and sees that there is a place for their results.
std::vector<SweepPoint> load_points(const std::string& points) {
  check_points_name(points);
  return scenario::load_points(points);
}

run::RunOptions make_options(const SweepPoint& point, const std::string& points) {
  run::RunOptions options;
  options.scenario = (find_folder(points) / point.scenario).lexically_normal().string();
  options.settings.emplace_back("/dynamics/strict=true");  // a figure of a table is the model's, or none
  options.settings.emplace_back("/body/cells/remesh=\"never\"");  // displacements are those of its cells
  for (const scenario::Setting& setting : point.settings)
    options.settings.push_back(setting.pointer + "=" + setting.value);
  options.quiet = true;
  return options;
}

/// What of a point lies on the disk.
struct Found {
  bool has_ended = false;  ///< reads, has the point's id, and its run reached its end or failed
  bool is_done = false;    ///< the former
  std::string reason;      ///< why there is no figure
  SweepFigures figures;    ///< of what is done
};

/// Of the point that a result was made for: where /fidelity/accuracy has chosen its cells, its own id is that
/// of the scenario with these.
std::optional<std::string> find_point_id(const output::ResultReader& reader) {
  const std::optional<std::string> asked = reader.find_provenance("asked_run_id");
  return asked ? asked : reader.find_provenance("run_id");
}

Found look(const SweepPoint& point, const std::string& points) {
  const std::string name = name_point(points, point.index);
  if (fs::exists(name + ".refused")) {
    std::ifstream stream(name + ".refused");
    Found found{true, false, "", {}};
    std::string id;
    std::getline(stream, id);
    std::getline(stream, found.reason);
    if (id == point.id) return found;
  }
  if (!fs::exists(name + ".h5"))
    return {false, false, fs::exists(name + ".part.h5") ? "not finished" : "not run", {}};
  try {
    const output::ResultReader reader(name + ".h5");
    if (find_point_id(reader) != point.id) return {false, false, "its file is of another run", {}};
    if (reader.outcome() == output::Outcome::done) return {true, true, "", compute_sweep_figures(reader)};
    const std::optional<Failure> failure = reader.read_failure();
    if (reader.outcome() == output::Outcome::failed && failure) return {true, false, to_string(*failure), {}};
    return {false, false, "not finished", {}};
  } catch (const hdf5::BusyError&) {
    throw;
  } catch (const std::exception& error) {
    return {false, false, std::string("its file does not read: ") + error.what(), {}};
  }
}

/// The bytes are on the disk before the name is, also when the machine stops.
void publish(const std::string& part, const std::string& name) {
  const int descriptor = open(part.c_str(), O_RDONLY | O_CLOEXEC);
  const bool is_synced = descriptor >= 0 && fsync(descriptor) == 0;
  if (descriptor >= 0) ::close(descriptor);
  if (!is_synced || std::rename(part.c_str(), name.c_str()) != 0)
    throw IoError(name, std::string("cannot be given its name: ") + std::strerror(errno));
}

/// Another run's leftovers are not resumed, nor what the disk has damaged: the point is begun anew.
void remove_unusable(const std::string& part, const std::string& id) {
  if (!fs::exists(part)) return;
  try {
    const output::ResultReader reader(part);
    if (find_point_id(reader) == id) {
      const bool is_done = reader.outcome() == output::Outcome::done;  // and was not given its name any more
      if (is_done || reader.find_checkpoint()) compute_sweep_figures(reader);
      return;
    }
  } catch (const hdf5::BusyError&) {
    throw;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "argil: note: what was there of the point does not read, it is begun anew: %s\n",
                 error.what());
  }
  fs::remove(part);
}

/// Where a file is written before it gets its name.
std::string name_part(const std::string& file) {
  return file + ".part";
}

/// The whole file or none.
void write_published(const std::string& file, const std::string& text) {
  const std::string part = name_part(file);
  try {
    output::write_file(part, text);
    publish(part, file);
  } catch (const IoError&) {
    std::error_code ignored;
    fs::remove(part, ignored);
    throw;
  }
}

/// How the points of a block ended.
struct Tally {
  int made = 0;
  int before = 0;  // had ended well before
  int failed = 0;
  int refused = 0;
};

int run_point(const SweepPoint& point, const SweepRun& sweep, Tally& tally) {
  const std::string name = name_point(sweep.points, point.index);
  if (look(point, sweep.points).is_done) {
    ++tally.before;
    return run::kDone;
  }
  run::RunOptions options = make_options(point, sweep.points);
  options.output = name + ".part.h5";
  options.threads = sweep.threads;
  options.writes_xdmf = false;
  options.remedy = "run the point again, which goes on from its last checkpoint";
  const scenario::Scenario s = run::load(options);
  options.resume = s.mode != scenario::Mode::equilibrium;  // which has no ticks to resume
  if (run::find_identity(s).id() != point.id)
    throw InputError(sweep.points, "point " + std::to_string(point.index),
                     "was expanded from other inputs or by another build of argil",
                     "run argil sweep expand again");
  run::require_no_input(s, name + ".h5", "argil sweep expand -o");
  const fs::path folder = fs::path(name).parent_path();
  fs::create_directories(folder);
  const PointLock lock(folder.string(), point.index);
  if (look(point, sweep.points).is_done) {  // by another process, meanwhile
    ++tally.before;
    return run::kDone;
  }
  remove_unusable(options.output, point.id);
  fs::remove(name + ".refused");
  try {
    const int code = run::run(options);
    if (code == run::kDone || code == run::kRunFailed) {
      publish(options.output, name + ".h5");
      ++(code == run::kDone ? tally.made : tally.failed);
    }
    return code == run::kInterrupted ? run::kInterrupted : run::kDone;
  } catch (const InputError& error) {
    write_published(name + ".refused", point.id + "\n" + error.what() + "\n");
    std::fprintf(stderr, "argil: point %lld refused: %s\n", static_cast<long long>(point.index),
                 error.what());
    ++tally.refused;
    return run::kDone;
  }
}

/// Refuses a table under whose name the points, a result or what a run reads lies.
void check_table_name(const std::string& table, const std::vector<SweepPoint>& points,
                      const std::string& file) {
  if (!fs::exists(table)) return;
  run::require_other_file(table, file, "the list of points");
  for (const SweepPoint& point : points) {
    for (const char* ending : {".h5", ".part.h5"})
      run::require_other_file(table, name_point(file, point.index) + ending, "a result of the sweep");
    std::optional<scenario::Scenario> s;
    try {
      s = run::load(make_options(point, file));
    } catch (const InputError&) {  // moved or changed since its points ran: it reads nothing any more
      continue;
    }
    run::require_no_input(*s, table);
  }
}

std::int64_t find_index(const SweepRun& sweep) {
  if (sweep.index) return *sweep.index;
  const char* given = std::getenv("SLURM_ARRAY_TASK_ID");
  if (given == nullptr || *given == '\0' || std::strspn(given, "0123456789") != std::strlen(given) ||
      std::strlen(given) > 9)
    throw InputError("", "--index", "is not given, nor by SLURM_ARRAY_TASK_ID", "add --index N");
  return std::atoll(given);
}

}  // namespace

int expand_sweep(const std::string& file, const std::string& points) {
  check_points_name(points);
  for (const std::string& written : {points, name_part(points)})
    run::require_other_file(written, file, "the sweep");
  const scenario::Sweep sweep = scenario::load_sweep(file);
  const fs::path base = find_folder(sweep.scenario) / fs::path(sweep.scenario).filename();
  const std::string relative = base.lexically_relative(find_folder(points)).string();
  std::map<std::string, std::int64_t> index_of;
  std::string text;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    SweepPoint point{static_cast<std::int64_t>(i), "", relative, sweep.points[i]};
    const scenario::Scenario s = run::load(make_options(point, points));
    for (const std::string& written : {points, name_part(points)}) run::require_no_input(s, written);
    point.id = run::find_identity(s).id();
    const std::string line = print_point(point);
    const auto [same, is_new] = index_of.emplace(point.id, point.index);
    if (!is_new)
      throw InputError(file, "",
                       "points " + std::to_string(same->second) + " and " + std::to_string(i) +
                           " are one and the same run: " + line.substr(0, line.size() - 1),
                       "leave one of them out");
    if (line.size() > scenario::kLongestPoint)
      throw InputError(file, "", "point " + std::to_string(i) + " is longer than 1 MiB",
                       "put what is long into the scenario or a file that it reads");
    text += line;
  }
  write_published(points, text);
  std::printf("%s: %zu points\n", points.c_str(), sweep.points.size());
  return run::kDone;
}

int run_sweep(const SweepRun& sweep) {
  const std::vector<SweepPoint> points = load_points(sweep.points);
  const std::int64_t count = static_cast<std::int64_t>(points.size());
  const std::int64_t index = find_index(sweep);
  if (index < 0 || index > (count - 1) / sweep.block)
    throw InputError(sweep.points, "--index", std::to_string(index) + " is past the last block",
                     "give 0 to " + std::to_string((count - 1) / sweep.block));
  run::watch_signals();
  const std::int64_t end = std::min((index + 1) * sweep.block, count);
  Tally tally;
  for (std::int64_t i = index * sweep.block; i < end; ++i) {
    if (run::is_interrupted()) {
      std::fprintf(stderr,
                   "argil: interrupted before point %lld of %s; the same command goes on from there\n",
                   static_cast<long long>(i), sweep.points.c_str());
      return run::kInterrupted;
    }
    if (const int code = run_point(points[static_cast<std::size_t>(i)], sweep, tally); code != run::kDone)
      return code;
  }
  std::printf("%s: block %lld, points %lld to %lld: %d made, %d there before, %d failed, %d refused\n",
              sweep.points.c_str(), static_cast<long long>(index),
              static_cast<long long>(index * sweep.block), static_cast<long long>(end - 1), tally.made,
              tally.before, tally.failed, tally.refused);
  return run::kDone;
}

int print_missing(const std::string& file, std::int64_t block) {
  std::vector<std::int64_t> missing;
  for (const SweepPoint& point : load_points(file))
    if (!look(point, file).has_ended && (missing.empty() || missing.back() != point.index / block))
      missing.push_back(point.index / block);
  std::string text;
  for (std::size_t i = 0; i < missing.size();) {
    std::size_t last = i;
    while (last + 1 < missing.size() && missing[last + 1] == missing[last] + 1) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(missing[i]);
    if (last > i) text += "-" + std::to_string(missing[last]);
    i = last + 1;
  }
  if (!text.empty()) std::puts(text.c_str());
  return run::kDone;
}

int collect_sweep(const std::string& file, const std::string& table_name) {
  const std::vector<SweepPoint> points = load_points(file);
  for (const char* ending : {".csv", ".h5"}) check_table_name(table_name + ending, points, file);
  SweepTable table;
  std::size_t num_without = 0;
  for (const SweepPoint& point : points) {
    const Found found = look(point, file);
    table.add(point,
              found.is_done     ? "done"
              : found.has_ended ? "failed"
                                : "missing",
              found.reason, found.figures);
    num_without += !found.is_done;
  }
  const output::StudyTable written = table.take();
  output::write_csv(written, table_name + ".csv");
  output::write_hdf5(written, table_name + ".h5");
  std::printf("%s.csv: %zu points, %zu without figures\n", table_name.c_str(), points.size(), num_without);
  return run::kDone;
}

}  // namespace argil::study
