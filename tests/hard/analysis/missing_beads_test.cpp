// Undeterminable results are absent with a reason, never 0.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/observable/observable.hpp"
#include "analysis/observable/results.hpp"
#include "tests/support/rigid_bed.hpp"

namespace twincell::missing_beads_test {

using namespace analysis;

namespace {

/// The bed with bead identities, without the beads for which `lost(frame, slot)` is true.
template <class Lost>
MemoryTrajectory seen(const test::RigidBed& bed, const Lost& lost) {
  const MemoryTrajectory whole = test::rigid_bed(bed);
  TrajectoryInfo info = whole.info();
  info.columns.identity = true;
  MemoryTrajectory result(info);
  for (Frame frame : whole.frames()) {
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      frame.id.push_back(static_cast<std::int64_t>(i));
      if (!lost(frame, i)) continue;
      frame.id[i] = -1;
      frame.position[i] = Vec3::Constant(std::nan(""));
      if (!frame.velocity.empty()) frame.velocity[i] = Vec3::Constant(std::nan(""));
    }
    result.append(frame);
  }
  return result;
}

std::vector<std::uint8_t> mark(std::size_t n, std::initializer_list<std::size_t> tracers) {
  std::vector<std::uint8_t> flags(n, 0);
  for (const std::size_t i : tracers) flags[i] = 1;
  return flags;
}

}  // namespace

// Beads that all look alike are tracked with marks of which none is set: as if there were no marks.
TEST(MissingBeads, NoTracerOneTracer) {
  MemoryTrajectory bed = test::rigid_bed({.gamma = 1.5});
  bed.info().tracer.clear();
  const auto without_marks = analyze(bed);
  bed.info().tracer = mark(bed.info().n_beads, {});
  auto results = analyze(bed);
  EXPECT_EQ(find_result(results, "phase").text, "bouncing");
  for (const char* name : {"s_b", "s_c", "s_k", "s_j", "phase", "tracers"}) {
    EXPECT_TRUE(find_result(results, name).present()) << name;
    EXPECT_EQ(find_result(results, name).values, find_result(without_marks, name).values) << name;
  }
  bed.info().tracer = mark(bed.info().n_beads, {90});
  results = analyze(bed);
  EXPECT_TRUE(find_result(results, "s_b").present());
  EXPECT_FALSE(find_result(results, "s_c").present());
  EXPECT_FALSE(find_result(results, "phase").present());  // s_b is above its threshold: the phase needs s_c
}

TEST(MissingBeads, OnePhaseOneFrame) {
  const auto one_phase = analyze(test::rigid_bed({.gamma = 1.5, .phases = 1}));
  EXPECT_FALSE(find_result(one_phase, "s_b").present());
  EXPECT_TRUE(find_result(one_phase, "s_c").present());
  const auto one_frame = analyze(test::rigid_bed({.gamma = 1.5, .phases = 1, .cycles = 1}));
  EXPECT_FALSE(find_result(one_frame, "s_b").present());
  EXPECT_EQ(find_result(one_frame, "s_c").n, 1U);
  EXPECT_FALSE(find_result(one_frame, "s_c").interval.has_value());
}

TEST(MissingBeads, NoPhaseNoVelocityNoPlate) {
  MemoryTrajectory bed = test::rigid_bed({.gamma = 1.5, .velocities = false});
  EXPECT_NE(find_result(analyze(bed), "T_g").absent.find("no velocities"), std::string::npos);

  MemoryTrajectory no_plate(bed.info());
  no_plate.info().drive.reset();
  for (Frame frame : bed.frames()) {
    frame.plate_height = Frame::kNoHeight;
    no_plate.append(frame);
  }
  EXPECT_NE(find_result(analyze(no_plate), "s_b").absent.find("plate"), std::string::npos);
  EXPECT_TRUE(find_result(analyze(no_plate), "s_c").present());

  bed.info().phases_per_cycle = 0;
  EXPECT_NE(find_result(analyze(bed), "s_b").absent.find("phase"), std::string::npos);
}

TEST(MissingBeads, ACellThatIsPeriodicAlongZHasNoPlateAndNoPhase) {
  MemoryTrajectory bed = test::rigid_bed({.gamma = 2.5});
  bed.info().box.boundary[2] = Boundary::periodic;
  for (const char* name : {"s_b", "s_c", "drift", "phase", "h_cm", "delta_h_cm", "p_s"})
    EXPECT_NE(find_result(analyze(bed), name).absent.find("periodic along z"), std::string::npos) << name;
}

TEST(MissingBeads, ATracerLostNowAndThenDoesNotShiftTheVerdict) {
  const test::RigidBed bed{.gamma = 1.10, .cycles = 20};
  const double whole = find_result(analyze(test::rigid_bed(bed)), "s_b").value();
  const MemoryTrajectory holes = seen(bed, [](const Frame& f, std::size_t i) {
    return (i * 7 + static_cast<std::size_t>(f.step) * 3) % 11 == 0;
  });
  const auto results = analyze(holes);
  EXPECT_NEAR(find_result(results, "s_b").value(), whole, 1e-12);
  EXPECT_NE(find_result(results, "s_j").convention.find("missing in"), std::string::npos);
  EXPECT_NEAR(find_result(results, "s_c").value(), 0, 1e-12);
}

TEST(MissingBeads, NoResultBelow80PercentOfTracers) {
  const auto results =
      analyze(seen({.gamma = 1.5}, [](const Frame& f, std::size_t i) { return f.cycle >= 4 && i % 3 == 0; }));
  EXPECT_EQ(find_result(results, "s_k").n, 4U);
  EXPECT_EQ(find_result(results, "s_c").n, 4U);
  EXPECT_NE(find_result(results, "s_k").convention.find("6 incomplete cycles"), std::string::npos);
  EXPECT_TRUE(std::isnan(find_result(results, "s_j").values.back()));
}

TEST(MissingBeads, ATracerSwappedWithAnotherIsFlagged) {
  MemoryTrajectory whole = test::rigid_bed({.gamma = 1.1});
  MemoryTrajectory swapped(whole.info());
  swapped.info().tracer = mark(whole.info().n_beads, {90, 91, 92, 93, 94, 95});
  for (Frame frame : whole.frames()) {
    if (frame.cycle >= 5) std::swap(frame.position[92], frame.position[20]);
    swapped.append(frame);
  }
  EXPECT_NE(find_result(analyze(swapped), "s_j").convention.find("1 jumps"), std::string::npos);
}

TEST(MissingBeads, EmptyFramesGiveNothing) {
  const auto results = analyze(seen({.gamma = 1.5}, [](const Frame&, std::size_t) { return true; }));
  for (const Result& r : results) EXPECT_FALSE(r.present()) << r.name << " = " << r.value();
  EXPECT_EQ(results_text(results).find("nan"), std::string::npos);
}

TEST(BadQuestions, AreRefusedWithASentence) {
  const MemoryTrajectory bed = test::rigid_bed({.gamma = 1.5});
  AnalysisOptions unknown, negative, all_gone, cutoff;
  unknown.only = {"s_d"};
  negative.discard_cycles = -1;
  all_gone.discard_cycles = 10;
  cutoff.neighbour_cutoff = 0;
  EXPECT_THROW(analyze(bed, unknown), ConfigError);
  EXPECT_THROW(analyze(bed, negative), ConfigError);
  EXPECT_THROW(analyze(bed, all_gone), ConfigError);
  EXPECT_THROW(analyze(bed, cutoff), ConfigError);
  EXPECT_THROW(analyze(MemoryTrajectory(bed.info())), InputError);
}

}  // namespace twincell::missing_beads_test
