// What is written is read back to the bit, also after a run was continued. The written records are the
// reference.
#include "output/result_reader.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

#include "base/error.h"
#include "records.h"
#include "support/temp_folder.h"

namespace argil::output {
namespace {

using argil::test::TempFolder;

template <class Array>
bool same_bits(const Array& a, const Array& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  return a.size() == 0 ||  // memcmp wants memory even for nothing
         std::memcmp(a.data(), b.data(),
                     static_cast<std::size_t>(a.size()) * sizeof(typename Array::Scalar)) == 0;
}

TEST(ResultReader, GivesBackTheHeader) {
  const TempFolder folder;
  test::write_run(folder / "r.h5", 1);
  const ResultHeader header = ResultReader(folder / "r.h5").read_header();
  const ResultHeader wanted = test::make_header();
  EXPECT_TRUE(same_bits(header.rest_position, wanted.rest_position));
  EXPECT_TRUE(same_bits(header.tets, wanted.tets));
  EXPECT_TRUE(same_bits(header.surface_triangles, wanted.surface_triangles));
  EXPECT_TRUE(same_bits(header.skin_triangles, wanted.skin_triangles));
  EXPECT_TRUE(same_bits(header.tool.vertices, wanted.tool.vertices));
  EXPECT_TRUE(same_bits(header.tool.triangles, wanted.tool.triangles));
  EXPECT_EQ(header.haptic_period, 0.001);
  EXPECT_EQ(ResultReader(folder / "r.h5").find_provenance("scenario"), "{\"about\": \"ε\"}");
  EXPECT_EQ(ResultReader(folder / "r.h5").find_provenance("numerics_tag"), "");
  EXPECT_EQ(ResultReader(folder / "r.h5").find_provenance("absent"), std::nullopt);
}

TEST(ResultReader, GivesBackEveryHapticRecordToTheBit) {
  const TempFolder folder;
  test::write_run(folder / "r.h5", 1100);
  const std::vector<sim::HapticRecord> records = ResultReader(folder / "r.h5").read_haptic();
  ASSERT_EQ(records.size(), 1100U);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const sim::HapticRecord wanted = test::make_haptic(static_cast<Tick>(i));
    ASSERT_EQ(records[i].tick, wanted.tick);
    ASSERT_EQ(records[i].time, wanted.time);
    ASSERT_TRUE(same_bits(records[i].tool_position, wanted.tool_position));
    ASSERT_TRUE(same_bits(records[i].tool_orientation.coeffs(), wanted.tool_orientation.coeffs()));
    ASSERT_TRUE(same_bits(records[i].force, wanted.force));
    ASSERT_TRUE(same_bits(records[i].torque, wanted.torque));
    ASSERT_TRUE(same_bits(records[i].device_force, wanted.device_force));  // has −0
    ASSERT_EQ(records[i].mode, wanted.mode);
    ASSERT_EQ(records[i].force_age, wanted.force_age);
    ASSERT_EQ(records[i].num_contacts, wanted.num_contacts);
    ASSERT_EQ(records[i].gate_events, wanted.gate_events);
    ASSERT_EQ(records[i].port_energy, wanted.port_energy);
    ASSERT_EQ(records[i].passivity_energy, wanted.passivity_energy);
    ASSERT_EQ(records[i].error.mesh, wanted.error.mesh);
    ASSERT_EQ(records[i].error.contact, wanted.error.contact);
    ASSERT_EQ(records[i].error.total(), wanted.error.total());
  }
}

TEST(ResultReader, RefusesASessionThatWentBeyondAKilometre) {
  const TempFolder folder;
  const auto write = [&](double start, double third) {
    ResultFile file(folder / "r.h5", test::make_header());
    SessionHead head;
    head.start.position = Vec3(start, 0.0, 0.0);
    file.begin_session(head, false);
    for (Tick tick = 0; tick < 4; ++tick) {
      sim::HapticRecord record = test::make_haptic(tick);
      if (tick == 2) record.tool_position = Vec3(0.0, third, 0.0);
      file.append(SessionTick{});
      file.append(record);
    }
    file.finish(std::nullopt);
  };
  write(-1000.0, 1000.0);
  const auto session = ResultReader(folder / "r.h5").find_session();
  ASSERT_TRUE(session);
  EXPECT_EQ(session->samples[2].position.y(), 1000.0);
  for (const double far : {1000.1, -1e155, std::nan("")}) {
    write(0.0, far);
    ARGIL_EXPECT_THROW_WITH(ResultReader(folder / "r.h5").find_session(), InputError,
                            "/haptic/tool_position, row 2");
    write(far, 0.0);
    ARGIL_EXPECT_THROW_WITH(ResultReader(folder / "r.h5").find_session(), InputError,
                            "/session/start_position");
  }
}

TEST(ResultReader, GivesBackEveryPhysicsRecord) {
  const TempFolder folder;
  test::write_run(folder / "r.h5", 600);
  const std::vector<sim::PhysicsRecord> records = ResultReader(folder / "r.h5").read_physics();
  ASSERT_EQ(records.size(), 300U);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const sim::PhysicsRecord wanted = test::make_physics(2 * static_cast<Tick>(i));
    ASSERT_EQ(records[i].tick, wanted.tick);
    ASSERT_EQ(records[i].time, wanted.time);
    ASSERT_EQ(records[i].kinetic_energy, wanted.kinetic_energy);
    ASSERT_EQ(records[i].elastic_energy, wanted.elastic_energy);
    ASSERT_EQ(records[i].plastic_dissipation, wanted.plastic_dissipation);
    ASSERT_EQ(records[i].contact_work, wanted.contact_work);
    ASSERT_EQ(records[i].water_mass, wanted.water_mass);
    ASSERT_EQ(records[i].water_added, wanted.water_added);
    ASSERT_EQ(records[i].water_removed, wanted.water_removed);
    ASSERT_EQ(records[i].newton_iterations, wanted.newton_iterations);
    ASSERT_EQ(records[i].iterations, wanted.iterations);
    ASSERT_EQ(records[i].factorisations, wanted.factorisations);
    ASSERT_EQ(records[i].residual, wanted.residual);
    ASSERT_EQ(records[i].active_nodes, wanted.active_nodes);
    ASSERT_EQ(records[i].min_volume_ratio, wanted.min_volume_ratio);
    ASSERT_EQ(records[i].max_plastic_strain, wanted.max_plastic_strain);
    ASSERT_EQ(records[i].limited_tets, wanted.limited_tets);
    ASSERT_EQ(records[i].limited_tet, wanted.limited_tet);
    ASSERT_EQ(records[i].epoch, wanted.epoch);
  }
}

TEST(ResultReader, GivesBackFramesWithAndWithoutASkin) {
  const TempFolder folder;
  for (const bool with_skin : {true, false}) {
    test::write_run(folder / "r.h5", 25, with_skin);
    const ResultReader reader(folder / "r.h5");
    const std::vector<FrameInfo> list = reader.read_frame_list();
    ASSERT_EQ(list.size(), 3U);
    EXPECT_EQ(list[2].tick, 20);
    const sim::Frame frame = reader.read_frame(list[2]);
    const sim::Frame wanted = test::make_frame(20, with_skin);
    EXPECT_EQ(frame.time, wanted.time);
    EXPECT_EQ(frame.state_hash, wanted.state_hash);
    EXPECT_TRUE(same_bits(frame.position, wanted.position));
    EXPECT_TRUE(same_bits(frame.saturation, wanted.saturation));
    EXPECT_TRUE(same_bits(frame.plastic_strain, wanted.plastic_strain));
    EXPECT_TRUE(same_bits(frame.skin_position, wanted.skin_position));
    EXPECT_TRUE(same_bits(frame.skin_saturation, wanted.skin_saturation));
    EXPECT_TRUE(same_bits(frame.skin_influence, wanted.skin_influence));
  }
}

TEST(ResultReader, GivesBackFieldsThatAreLargeEnoughToBeCompressed) {
  const TempFolder folder;
  constexpr Eigen::Index kTets = 60000;  // several chunks of the tensor field
  sim::Frame frame = test::make_frame(0);
  frame.saturation = Field::LinSpaced(kTets, 0.0, 1.0);
  frame.plastic_strain = TensorField::Zero(6, kTets);
  for (Eigen::Index i = 0; i < kTets; i += 7)
    frame.plastic_strain(i % 6, i) = 1.0 / static_cast<double>(i + 1);
  {
    ResultHeader header = test::make_header();
    header.tets.setZero(4, kTets);
    ResultFile file(folder / "r.h5", header);
    file.append(frame);
    file.finish(std::nullopt);
  }
  EXPECT_LT(std::filesystem::file_size(folder / "r.h5"), 8U * 7U * kTets / 2U);
  const ResultReader reader(folder / "r.h5");
  const sim::Frame read = reader.read_frame(reader.read_frame_list()[0]);
  EXPECT_TRUE(same_bits(read.saturation, frame.saturation));
  EXPECT_TRUE(same_bits(read.plastic_strain, frame.plastic_strain));
}

TEST(ResultReader, GivesBackTheLastTimingOfEveryStage) {
  const TempFolder folder;
  {
    ResultFile file(folder / "r.h5", test::make_header());
    file.append_timing({{"solid_s", 1.0}, {"rate_Hz", 900.0}});
    file.append_timing({{"solid_s", 2.5}, {"rate_Hz", 950.0}});
    file.finish(std::nullopt);
  }
  EXPECT_EQ(ResultReader(folder / "r.h5").read_timing(),
            (std::vector<std::pair<std::string, double>>{{"rate_Hz", 950.0}, {"solid_s", 2.5}}));
}

TEST(ResultFile, ContinuedFromATickHoldsTheSameAsOneThatNeverStopped) {
  const TempFolder folder;
  test::write_run(folder / "whole.h5", 1800);
  {
    ResultFile file(folder / "cut.h5", test::make_header());
    test::append_run(file, 0, 1500);
    file.finish(Failure{1500, "solid", 0, "x", 0.0, 0.0});
  }
  {
    ResultFile file(folder / "cut.h5", Tick{1234}, 124,
                    FramePrecision::whole);  // frames of ticks 0, 10 … 1230
    test::append_run(file, 1235, 1800);
    file.finish(std::nullopt);
  }
  const ResultReader whole(folder / "whole.h5");
  const ResultReader cut(folder / "cut.h5");
  EXPECT_EQ(cut.outcome(), Outcome::done);
  EXPECT_FALSE(cut.read_failure().has_value());
  for (const std::string name : {"haptic/tick", "haptic/force", "physics/tick", "physics/contact_work"})
    EXPECT_EQ(cut.root().open_dataset(name).read<double>(), whole.root().open_dataset(name).read<double>())
        << name;
  const std::vector<FrameInfo> frames = cut.read_frame_list();
  ASSERT_EQ(frames.size(), 180U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].tick, static_cast<Tick>(10 * i));
    EXPECT_EQ(frames[i].name, whole.read_frame_list()[i].name);
  }
}

TEST(ResultFile, IsNotContinuedPastItsRecords) {
  const TempFolder folder;
  test::write_run(folder / "r.h5", 10);
  ARGIL_EXPECT_THROW_WITH(ResultFile(folder / "r.h5", Tick{10}, 1, FramePrecision::whole), IoError,
                          "no records up to tick 10");
  ARGIL_EXPECT_THROW_WITH(ResultFile(folder / "r.h5", Tick{9}, 2, FramePrecision::whole), IoError,
                          "lost frames up to tick 9");
  EXPECT_EQ(ResultReader(folder / "r.h5").read_haptic().size(), 10U);
}

TEST(ResultFile, KeepsTheLastCheckpointWithAllRecordsUpToIt) {
  const TempFolder folder;
  const std::string name = folder / "r.h5";
  const auto make_state = [](int tick) {
    return Snapshot{{"tick", Eigen::MatrixXd::Constant(1, 1, tick)},
                    {"solid/x", Eigen::MatrixXd::Constant(3, 4 + tick % 2, 0.1 * tick)},
                    {"solid/x_before", Eigen::MatrixXd(3, 0)}};
  };
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ResultFile file(name, test::make_header());
    for (int tick = 1; tick <= 7; ++tick) {
      test::append_run(file, tick, tick + 1);
      file.write_checkpoint(make_state(tick));
    }
    test::append_run(file, 8, 20);
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  const ResultReader reader(name);
  EXPECT_EQ(reader.find_checkpoint(), make_state(7));
  EXPECT_EQ(reader.read_haptic().back().tick, 7);
}

TEST(ResultFile, ARunThatReachedItsEndKeepsNoCheckpoint) {
  const TempFolder folder;
  const std::string name = folder / "r.h5";
  for (const bool is_done : {true, false}) {
    ResultFile file(name, test::make_header());
    file.write_checkpoint({{"tick", Eigen::MatrixXd::Zero(1, 1)}});
    file.finish(std::nullopt, !is_done);
    EXPECT_EQ(ResultReader(name).find_checkpoint().has_value(), !is_done);
  }
}

TEST(ResultReader, RefusesWhatIsNoResultFile) {
  const TempFolder folder;
  ARGIL_EXPECT_THROW_WITH(ResultReader(folder / "absent.h5"), IoError, "cannot be read: No such file");
  ARGIL_EXPECT_THROW_WITH(ResultReader(folder.write("text.h5", "not HDF5 at all")), IoError,
                          "is no HDF5 file");
  hdf5::File::create(folder / "other.h5").close();
  ARGIL_EXPECT_THROW_WITH(ResultReader(folder / "other.h5"), InputError, "not a result file");
  {
    hdf5::File file = hdf5::File::create(folder / "new.h5");
    hdf5::Group root = file.root();
    root.write_attribute("format", "argil-result");
    root.write_attribute("format_version", std::int64_t{2});
  }
  ARGIL_EXPECT_THROW_WITH(ResultReader(folder / "new.h5"), InputError, "format_version: 2");
}

}  // namespace
}  // namespace argil::output
