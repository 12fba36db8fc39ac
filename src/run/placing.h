#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contact/approach.h"
#include "scenario/build.h"

namespace argil::run {

/// How a motion is to touch a body.
struct Touch {
  std::optional<Vec3> at;    ///< place that the tool is to touch [m]; none: where it is nearest
  std::optional<Vec3> from;  ///< with `at`: the direction that the tool comes from
  double depth = 0.0;        ///< of the tool in the body at rest [m]; 0: a quarter of the tool's radius
};

/// Along which the tool is brought to the body, and the poses by which it is asked how deep.
struct Way {
  std::vector<contact::Pose> asked;
  std::size_t first = 0;          ///< number of the first of them
  Vec3 begin = Vec3::Zero();      ///< translation before it starts [m]
  Vec3 direction = Vec3::Zero();  ///< unit
  double most = 0.0;              ///< length [m]
};

/// A scenario's scene at rest, the motion in it, and where the motion is brought so that it touches.
class Placing {
 public:
  /// Builds the scene. Throws InputError.
  Placing(const Touch& touch, scenario::Scenario scenario);

  /// Where body and motion are, and how near they come.
  void print_start() const;

  /// Where the motion would be deepest after another touch, in the body as it is built now; nothing where
  /// there is none or the motion would begin in the body.
  std::optional<contact::Approach> foresee(const Touch& touch);

  /// Moves the motion. The body is built with it where it is put, so that it is the one that the tool will
  /// meet. Throws InputError where that finds no touch.
  void find();

  /// How far it was moved and what it touches. Throws InputError where it then starts in the body.
  void print_end();

  /// The translation as a patch of the scenario.
  std::string patch() const;

  /// The tool where the scenario has it, and where it was nearest or deepest.
  const contact::Approach& nearest() const { return m_nearest; }
  /// The same where the motion is now.
  contact::Approach find_deepest() { return finder().find(m_poses, translation() - m_given); }
  std::string describe(const contact::Approach& a) const;
  /// Where the motion is now, its first pose: [m] from the body, negative in it.
  double start_distance();

  const Vec3& translation() const { return m_scenario.trace.options.device_to_world.translation; }
  const sim::Body& body() const { return m_placement->scene.body; }
  double tool_radius() const { return m_placement->finder.tool().thickness(); }  ///< [m]
  const mesh::Box& box() const { return m_placement->finder.box(); }             ///< of the body at rest
  mesh::Box path() const;  ///< of the hand's point, as given

 private:
  /// What is known of a scene.
  struct Placement {
    explicit Placement(const scenario::Scenario& s);
    scenario::Scene scene;
    contact::ApproachFinder finder;
  };
  Vec3 find_shift(const Touch& touch, double depth, Way& way);
  contact::ApproachFinder& finder() { return m_placement->finder; }

  Touch m_touch;
  scenario::Scenario m_scenario;
  Vec3 m_given;  // translation [m]
  std::unique_ptr<Placement> m_placement;
  std::vector<contact::Pose> m_poses;  // where the scenario has them
  contact::Approach m_nearest;         // there
  double m_depth = 0.0;                // wanted [m]
  Way m_way;
};

}  // namespace argil::run
