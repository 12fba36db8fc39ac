// The estimate of the force's error: a uniform strain has none, finer cells less, the ball is within a factor
// of two of Hertz's force, κ is felt as it is told, and no bit depends on threads or on a return.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_body.h"

namespace argil::sim {
namespace {

constexpr double kRadius = 0.03;
constexpr double kEdge = 0.08;
constexpr double kModulus = 1e5;
constexpr double kPoisson = 0.3;

Params make_params() {
  Params p;
  p.elastic = {kModulus, kPoisson};
  p.plasticity.enabled = false;
  p.kernel.form = material::KernelForm::off;
  p.contact.law = contact::ContactLaw::pressure;
  p.contact.round_tool = contact::RoundTool{kRadius, 0.0, kRadius, false};
  p.solid.rayleigh_stiffness = 1e-3;
  p.solid.solver.tolerance = 1e-6;
  p.device.max_force = 1e3;
  p.device.max_force_rate = 1e9;
  p.estimates_error = true;
  return p;
}

device::DeviceSample hand_at(double depth) {
  device::DeviceSample sample;
  sample.position = {0.5 * kEdge + 1e-3, 0.5 * kEdge - 7e-4, kEdge + kRadius - depth};
  return sample;
}

Simulation make_simulation(const Params& params, int cells) {
  return {test::make_block_body(cells, cells, cells, Vec3(kEdge, kEdge, kEdge)),
          contact::make_sphere_tool(kRadius, 2), params, hand_at(-2e-4)};
}

/// Records of a press that goes so deep in so many ticks.
std::vector<HapticRecord> press(Simulation& simulation, double depth, int ticks, int begin = 0) {
  std::vector<HapticRecord> records;
  for (int k = begin + 1; k <= ticks; ++k) {
    EXPECT_TRUE(simulation.tick(hand_at(-2e-4 + (depth + 2e-4) * k / ticks)).is_ok()) << k;
    records.push_back(simulation.haptic_record());
  }
  return records;
}

constexpr double kDepth = 3e-3;
constexpr int kTicks = 60;

// Patch test: of a strain that is the same everywhere, with a turn that the recovery must not count.
TEST(RecoveredError, IsNothingOfAUniformStrain) {
  Simulation simulation = make_simulation(make_params(), 4);
  const solid::Body& body = simulation.solid();
  solid::RecoveredError recovered(body.model, false);
  Mat3 F = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  F *= Vec3(1.02, 0.97, 1.01).asDiagonal();
  solid::Kinematics kinematics = body.kinematics;
  std::vector<char> turned(static_cast<std::size_t>(body.model.elements.num_tets()), 0), moved = turned;
  const OrderedRuns all(1);
  kinematics.update(body.model.elements, body.materials.gradient(), F * body.model.elements.rest,
                    {all, false, 0.0, turned, moved});
  const TensorField none = TensorField::Zero(6, body.model.elements.num_points());
  const solid::MeshError found =
      recovered.find({body.model, body.materials, kinematics, none, body.forces.volume});
  EXPECT_GT(found.stress, 0.0);
  EXPECT_NEAR(found.work, 0.5 * found.stress, 1e-12 * found.stress);
  EXPECT_LT(found.error, 1e-20 * found.stress);
  recovered.set_reference(kinematics);
  EXPECT_LT(recovered.find({body.model, body.materials, kinematics, none, body.forces.volume}).stress,
            1e-24 * found.stress);
}

// A ball on a block eight times as wide as the patch is; its closed form is a little below Hertz's for a half
// space, and cells of 0.5 to 2.4 along the patch's radius are too stiff by far more than that.
TEST(ForceError, OfABallIsWithinAFactorOfTwoOfWhatHertzSays) {
  const double exact =
      4.0 / 3.0 * kModulus / (1.0 - kPoisson * kPoisson) * std::sqrt(kRadius) * std::pow(kDepth, 1.5);
  double coarser = 1.0;
  for (const int cells : {5, 10, 20}) {
    Simulation simulation = make_simulation(make_params(), cells);
    const HapticRecord last = press(simulation, kDepth, kTicks).back();
    const double error = last.force.norm() - exact;
    ASSERT_GT(error, 0.03 * exact) << cells;
    EXPECT_GT(last.error.total(), 0.5 * error) << cells;
    EXPECT_LT(last.error.total(), 2.0 * error) << cells;
    const double share = last.error.mesh / last.force.norm();
    EXPECT_LT(share, 0.75 * coarser) << cells;
    EXPECT_GT(last.error.mesh, 0.9 * last.error.total());
    coarser = share;
  }
}

TEST(ForceError, OfTheContactIsTwiceWhatTwiceItsStiffnessMoves) {
  Params params = make_params();
  params.contact.pressure_stiffness = 4e8;
  Simulation soft = make_simulation(params, 10);
  params.contact.pressure_stiffness *= 2.0;
  Simulation stiff = make_simulation(params, 10);
  const HapticRecord of_soft = press(soft, kDepth, kTicks).back();
  const HapticRecord of_stiff = press(stiff, kDepth, kTicks).back();
  const double moved = of_stiff.force.norm() - of_soft.force.norm();
  ASSERT_GT(moved, 0.003 * of_soft.force.norm());
  EXPECT_LT(of_soft.error.contact, 0.0);
  EXPECT_NEAR(-0.5 * of_soft.error.contact, moved, 0.5 * moved);
  // Between the nodes the tool sinks in as far as before, which is the cells' doing.
  EXPECT_LT(std::abs(of_stiff.error.contact), 0.8 * std::abs(of_soft.error.contact));
}

// A force that is held for n ticks is behind by up to n − 1 of them: what those add to it is its error.
TEST(ForceError, OfAForceThatIsHeldIsItsGrowthMeanwhile) {
  Params params = make_params();
  params.rates.physics_period_ticks = params.rates.water_period_ticks = 5;
  Simulation held = make_simulation(params, 10);
  params.rates.physics_period_ticks = params.rates.water_period_ticks = 1;
  Simulation each = make_simulation(params, 10);
  const std::vector<HapticRecord> of_held = press(held, kDepth, kTicks);
  const std::vector<HapticRecord> of_each = press(each, kDepth, kTicks);
  for (std::size_t i = 43; i < 50; i += 5) {  // the last tick before an answer
    const double behind = of_each[i].force.norm() - of_held[i].force.norm();
    EXPECT_NEAR(of_held[i].error.step, behind, 0.3 * behind) << i;
    EXPECT_LT(of_each[i].error.step, 0.1 * behind) << i;
  }
}

TEST(ForceError, OfTheSolverGrowsWithItsToleranceAndIsOfTheSizeOfWhatItDoes) {
  Params params = make_params();
  Simulation exact = make_simulation(params, 10);
  params.solid.solver.tolerance = 0.05;
  Simulation loose = make_simulation(params, 10);
  const std::vector<HapticRecord> of_exact = press(exact, kDepth, kTicks);
  const std::vector<HapticRecord> of_loose = press(loose, kDepth, kTicks);
  double squares = 0.0, estimated = 0.0, of_exact_estimated = 0.0;
  for (std::size_t i = 10; i < of_exact.size(); ++i) {
    squares += (of_exact[i].force - of_loose[i].force).squaredNorm();
    estimated += std::pow(of_loose[i].error.solver, 2);
    of_exact_estimated += std::pow(of_exact[i].error.solver, 2);
  }
  EXPECT_GT(estimated, squares / 9.0);
  EXPECT_LT(estimated, 9.0 * squares);
  EXPECT_LT(of_exact_estimated, 1e-4 * estimated);
}

TEST(ForceError, IsNothingWithoutAForceOrWhereItIsOff) {
  Params params = make_params();
  params.estimates_error = false;
  Simulation off = make_simulation(params, 6);
  EXPECT_EQ(press(off, kDepth, kTicks).back().error.total(), 0.0);
  Simulation on = make_simulation(make_params(), 6);
  const std::vector<HapticRecord> records = press(on, kDepth, kTicks);
  EXPECT_EQ(records.front().error.total(), 0.0);  // beside the body
  EXPECT_GT(records.back().error.total(), 0.0);
  EXPECT_EQ(records.back().force, off.haptic_record().force);  // the same bits, whether it is on or not
}

bool is_equal(const ForceErrorParts& a, const ForceErrorParts& b) {
  return a.mesh == b.mesh && a.step == b.step && a.contact == b.contact && a.solver == b.solver &&
         a.left_out == b.left_out;
}

TEST(ForceError, HasTheSameBitsOnTwoThreadsAndAfterAReturn) {
  Params params = make_params();
  Simulation one = make_simulation(params, 8);
  params.threads = 2;
  Simulation two = make_simulation(params, 8);
  const std::vector<HapticRecord> of_one = press(one, kDepth, kTicks);
  Simulation later = make_simulation(make_params(), 8);
  for (int k = 1; k <= kTicks; ++k) {
    ASSERT_TRUE(two.tick(hand_at(-2e-4 + (kDepth + 2e-4) * k / kTicks)).is_ok());
    ASSERT_TRUE(is_equal(two.haptic_record().error, of_one[static_cast<std::size_t>(k - 1)].error)) << k;
    if (k == 37) later.restore(two.take_snapshot(), "a test");
  }
  const std::vector<HapticRecord> of_later = press(later, kDepth, kTicks, 37);
  for (std::size_t i = 0; i < of_later.size(); ++i)
    ASSERT_TRUE(is_equal(of_later[i].error, of_one[37 + i].error)) << 38 + i;
  EXPECT_GT(of_later.back().error.mesh, 0.0);
}

}  // namespace
}  // namespace argil::sim
