#include "solid/momentum.h"

#include <Eigen/LU>

#include "solid/body.h"
#include "solid/matrix.h"

namespace argil::solid {
namespace {

/// Per axis: 1 where no node is held along it, else 0.
Vec3 find_free_axes(const Model& model) {
  Vec3 free;
  for (int k = 0; k < 3; ++k) free(k) = (model.constraints.support.row(k).array() < 0).all() ? 1.0 : 0.0;
  return free;
}

/// Of all that acts, the resistance against a speed of the whole body [kg] and the force that δ meets there
/// [N s].
struct OfContacts {
  Mat3 resistance = Mat3::Zero();
  Vec3 force = Vec3::Zero();
};

OfContacts add_up(const Body& body, std::span<const PointStiffness> list) {
  OfContacts sum;
  if (!body.model.params.implicit_contact) return sum;
  const double scale = find_contact_scale(body);
  const StepContacts contacts = body.step_contacts(list);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!body.contacts.is_acting(list[i].group)) continue;
    const Mat3 resistance = scale * contacts.stiffness(i, body.contacts);
    Vec3 speed = Vec3::Zero();
    double weights = 0.0;
    for (std::size_t k = 0; k < list[i].count(); ++k) {
      const int row = body.model.row_of_node[static_cast<std::size_t>(list[i].vertex[k])];
      speed += list[i].weight[k] * body.system.delta.col(row);
      weights += list[i].weight[k];
    }
    sum.resistance += weights * weights * resistance;
    sum.force += weights * resistance * speed;
  }
  return sum;
}

}  // namespace

void balance_momentum(Body& body, const Part& part, std::span<const PointStiffness> contacts) {
  const Model& model = body.model;
  const Vec3 free = find_free_axes(model);
  if (free.isZero(0.0) || model.num_free() == 0) return;
  const double of_mass = compute_shares(body).mass;
  const Field& mass = body.materials.mass();
  Points& delta = body.system.delta;
  const auto sum = [&](auto of_row) {
    return part.rows.sum(model.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      double of_run = 0.0;
      for (std::ptrdiff_t row = begin; row < end; ++row)
        of_run += of_row(row, of_mass * mass(model.node_of_row[static_cast<std::size_t>(row)]));
      return of_run;
    });
  };
  const OfContacts met = add_up(body, contacts);
  Mat3 resistance = met.resistance;
  resistance.diagonal().array() += sum([](std::ptrdiff_t, double m) { return m; });
  Vec3 left = -met.force;
  for (int k = 0; k < 3; ++k) {
    left(k) += sum([&](std::ptrdiff_t row, double m) { return body.system.rhs(k, row) - m * delta(k, row); });
    if (free(k) != 0.0) continue;
    resistance.row(k).setZero();
    resistance.col(k).setZero();
    resistance(k, k) = 1.0;
    left(k) = 0.0;
  }
  const Vec3 speed = resistance.inverse() * left;
  part.rows.each(model.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    delta.middleCols(begin, end - begin).colwise() += speed;
  });
}

}  // namespace argil::solid
