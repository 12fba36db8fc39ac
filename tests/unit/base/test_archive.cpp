// One list of fields serves both ways: what was saved comes back to the bit, and a snapshot that is not of
// this state is refused by the field's name.
#include "base/archive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

enum class Mode { push, pull, wet };

struct State {
  std::int64_t tick = 0;
  Mode mode = Mode::push;
  bool is_pressed = false;
  double energy = 0.0;
  Quat orientation = Quat::Identity();
  Points x = Points::Zero(3, 2);
  Field before;
  std::vector<int> faces;
  std::vector<Vec3> forces;
  struct Record {
    int vertex = -1;
    Vec3 force = Vec3::Zero();
  };
  std::vector<Record> records;

  void exchange(Archive& archive) {
    archive.number("tick", tick);
    archive.number("mode", mode);
    archive.number("is_pressed", is_pressed);
    archive.number("energy", energy);
    archive.quaternion("orientation", orientation);
    archive.array("x", x);
    archive.any_size("before", before);
    archive.list("faces", faces);
    archive.list("forces", forces);
    archive.records("records", records, [](Record& record, auto field) {
      field(record.vertex);
      for (double& value : record.force) field(value);
    });
  }
};

Snapshot save(State state) {
  Snapshot snapshot;
  Archive archive = Archive::make_saving(snapshot);
  state.exchange(archive);
  return snapshot;
}

State restore(const Snapshot& snapshot) {
  State state;
  Archive archive = Archive::make_restoring(snapshot, "run.h5");
  state.exchange(archive);
  return state;
}

State make_state() {
  State state;
  state.tick = (std::int64_t{1} << 53) - 1;
  state.mode = Mode::wet;
  state.is_pressed = true;
  state.energy = std::nextafter(0.1, 1.0);
  state.orientation.coeffs() << 0.5, -0.5, 0.5, -0.5;
  state.x << 1, 2, -0.0, 1e-310, 5, 6;
  state.before = Field::LinSpaced(7, 0.0, 1.0);
  state.faces = {3, -1, 2147483647};
  state.forces = {Vec3(1, 2, 3), Vec3(-4, 5e-300, 6)};
  state.records = {{7, Vec3(-1, 2, 3)}, {-1, Vec3(4, 5e-300, -6)}};
  return state;
}

TEST(Archive, GivesBackEveryKindOfFieldToTheBit) {
  const State was = make_state();
  const State is = restore(save(was));
  EXPECT_EQ(is.tick, was.tick);
  EXPECT_EQ(is.mode, was.mode);
  EXPECT_EQ(is.is_pressed, was.is_pressed);
  EXPECT_EQ(is.energy, was.energy);
  EXPECT_EQ(is.orientation.coeffs(), was.orientation.coeffs());
  EXPECT_EQ(is.x, was.x);
  EXPECT_TRUE(std::signbit(is.x(1, 0)));
  EXPECT_EQ(is.before, was.before);
  EXPECT_EQ(is.faces, was.faces);
  EXPECT_EQ(is.forces, was.forces);
  ASSERT_EQ(is.records.size(), was.records.size());
  for (std::size_t i = 0; i < is.records.size(); ++i) {
    EXPECT_EQ(is.records[i].vertex, was.records[i].vertex);
    EXPECT_EQ(is.records[i].force, was.records[i].force);
  }
}

TEST(Archive, LeavesHistoryAsItIsWhereItIsDropped) {
  Snapshot snapshot;
  const auto serialize = [](Archive& archive, double& motion, Field& last) {
    archive.number("motion", motion);
    const Archive::History history(archive);
    archive.any_size("last", last);
  };
  double motion = 3.0;
  Field last = Field::Constant(2, 5.0);
  Archive saving = Archive::make_saving(snapshot);
  serialize(saving, motion, last);
  motion = 0.0;
  last = Field::Constant(1, 7.0);
  Archive dropping = Archive::make_restoring_without_history(snapshot, "run.h5");
  serialize(dropping, motion, last);
  EXPECT_EQ(motion, 3.0);
  EXPECT_EQ(last, Field::Constant(1, 7.0));
  Archive restoring = Archive::make_restoring(snapshot, "run.h5");
  serialize(restoring, motion, last);
  EXPECT_EQ(last, Field::Constant(2, 5.0));
}

TEST(Archive, EmptyListsComeBackEmptyAlsoWhereThereWereSome) {
  State state = make_state();
  Archive archive = Archive::make_restoring(save(State()), "run.h5");
  state.exchange(archive);
  EXPECT_EQ(state.before.size(), 0);
  EXPECT_TRUE(state.faces.empty());
  EXPECT_TRUE(state.forces.empty());
}

std::string hash(State state) {
  Sha256 digest;
  Archive archive = Archive::make_hashing(digest);
  state.exchange(archive);
  return digest.hex_digest();
}

TEST(Archive, HashChangesWithEveryFieldOfASnapshotAndWithNothingElse) {
  const Snapshot whole = save(make_state());
  const std::string of_whole = hash(make_state());
  EXPECT_EQ(hash(restore(whole)), of_whole);
  for (const auto& [name, value] : whole) {
    if (value.size() == 0) continue;
    Snapshot other = whole;
    other[name](0) = name == "is_pressed" ? 0.0 : 0.75 - other[name](0);
    EXPECT_NE(hash(restore(other)), of_whole) << name;
  }
  State longer = make_state();
  longer.faces.push_back(0);
  EXPECT_NE(hash(longer), of_whole);
}

TEST(Archive, RefusesASnapshotOfAnotherStateByTheFieldsName) {
  const Snapshot whole = save(make_state());
  for (const auto& [name, value] : whole) {
    Snapshot without = whole;
    without.erase(name);
    ARGIL_EXPECT_THROW_WITH(restore(without), IoError, "run.h5: the checkpoint has no " + name);
  }
  Snapshot other = whole;
  other["x"] = Eigen::MatrixXd::Zero(3, 5);
  ARGIL_EXPECT_THROW_WITH(restore(other), IoError, "the checkpoint's x has 3 by 5 numbers");
  other = whole;
  other["forces"] = Eigen::MatrixXd::Zero(2, 2);
  ARGIL_EXPECT_THROW_WITH(restore(other), IoError, "the checkpoint's forces has 2 by 2 numbers");
  other = whole;
  other["tick"] = Eigen::MatrixXd::Zero(1, 2);
  ARGIL_EXPECT_THROW_WITH(restore(other), IoError, "the checkpoint's tick has 1 by 2 numbers");
}

}  // namespace
}  // namespace argil
