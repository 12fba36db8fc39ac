#include "base/archive.h"

#include "base/error.h"

namespace argil {

Archive Archive::make_restoring(const Snapshot& snapshot, const std::string& origin) {
  Archive archive(const_cast<Snapshot&>(snapshot), true);  // is only read
  archive.m_origin = origin;
  return archive;
}

const Eigen::MatrixXd& Archive::find(const std::string& name, Eigen::Index rows, Eigen::Index columns) const {
  const auto found = m_snapshot->find(name);
  if (found == m_snapshot->end()) throw IoError(m_origin, "the checkpoint has no " + name);
  const Eigen::MatrixXd& value = found->second;
  const auto fits = [](Eigen::Index wanted, Eigen::Index given) {
    return wanted == Eigen::Dynamic || wanted == given;
  };
  if (!fits(rows, value.rows()) || !fits(columns, value.cols()))
    throw IoError(m_origin, "the checkpoint's " + name + " has " + std::to_string(value.rows()) + " by " +
                                std::to_string(value.cols()) + " numbers, which is not what the scene needs");
  return value;
}

double Archive::exchange(const std::string& name, double value) {
  if (m_is_restoring) return find(name, 1, 1)(0, 0);
  (*m_snapshot)[name] = Eigen::MatrixXd::Constant(1, 1, value);
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
