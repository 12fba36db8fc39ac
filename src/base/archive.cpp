#include "base/archive.h"

#include "base/error.h"

namespace argil {

Archive Archive::make_saving(Snapshot& snapshot) {
  Archive archive;
  archive.m_saved = &snapshot;
  return archive;
}

Archive Archive::make_restoring(const Snapshot& snapshot, const std::string& origin) {
  Archive archive;
  archive.m_restored = &snapshot;
  archive.m_origin = origin;
  return archive;
}

Archive Archive::make_restoring_without_history(const Snapshot& snapshot, const std::string& origin) {
  Archive archive = make_restoring(snapshot, origin);
  archive.m_drops_history = true;
  return archive;
}

Archive Archive::make_hashing(Sha256& hash) {
  Archive archive;
  archive.m_hash = &hash;
  return archive;
}

void Archive::add_to_hash(const std::string& name, Eigen::Index rows, Eigen::Index columns,
                          const double* values) {
  m_hash->add(name + " " + std::to_string(rows) + " " + std::to_string(columns) + "\n");
  m_hash->add(values, static_cast<std::size_t>(rows * columns));
}

const Eigen::MatrixXd& Archive::find(const std::string& name, Eigen::Index rows, Eigen::Index columns) const {
  const auto found = m_restored->find(name);
  if (found == m_restored->end()) throw IoError(*m_origin, "the checkpoint has no " + name);
  const Eigen::MatrixXd& value = found->second;
  const auto fits = [](Eigen::Index wanted, Eigen::Index given) {
    return wanted == Eigen::Dynamic || wanted == given;
  };
  if (!fits(rows, value.rows()) || !fits(columns, value.cols()))
    throw IoError(*m_origin, "the checkpoint's " + name + " has " + std::to_string(value.rows()) + " by " +
                                 std::to_string(value.cols()) +
                                 " numbers, which is not what the scene needs");
  return value;
}

double Archive::pass(const std::string& name, double value) {
  if (is_left_out()) return value;
  if (is_restoring()) return find(name, 1, 1)(0, 0);
  save(name, Eigen::Matrix<double, 1, 1>(value));
  return value;
}

void Archive::list(const std::string& name, std::vector<Vec3>& values) {
  Points stored(3, static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) stored.col(static_cast<Eigen::Index>(i)) = values[i];
  any_size(name, stored);
  values.resize(static_cast<std::size_t>(stored.cols()));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = stored.col(static_cast<Eigen::Index>(i));
}

}  // namespace argil
