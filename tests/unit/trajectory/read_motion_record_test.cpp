// Recorded motions of a plate: interpolation, integration, and the files that are refused.
#include "trajectory/read_motion_record.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/drive.hpp"

namespace twincell::read_motion_record_test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Values of A sin(omega t + phi) or of its derivative, at steps h from t = 0.
MotionRecord sine_record(int derivative, double a, double omega, double phi, double h, int n) {
  MotionRecord record{.file = "sine.csv", .derivative = derivative, .interval = h};
  for (int i = 0; i < n; ++i)
    record.values.push_back(a * std::pow(omega, derivative) *
                            std::sin(omega * h * i + phi + derivative * std::numbers::pi / 2));
  return record;
}

Drive drive_of(const FittedMotion& fit, double omega) {
  Drive drive{.amplitude = fit.amplitude, .omega = omega};
  drive.recorded = std::make_shared<RecordedMotion>(fit.motion);
  return drive;
}

// Cycles begin where the sine passes its mean upwards, so the recorded drive is A sin(omega t). A cubic
// spline of displacements errs by (h omega)^4 A/384 at most, at the middle between two samples (Hall & Meyer
// 1976), which it reaches for a sine; its integrals err by less.
TEST(RecordedMotion, ARecordedSineIsTheSine) {
  const double a = 1.5, omega = 0.8, phi = 1.0, period = kTurn / omega;
  for (const int per_cycle : {20, 40}) {
    const double h = period / per_cycle, bound = std::pow(h * omega, 4) * a / 384;
    for (const int derivative : {0, 1, 2})
      for (const bool repeats : {false, true}) {
        const int cycles = 7;
        MotionRecord record =
            sine_record(derivative, a, omega, phi, h, cycles * per_cycle + (repeats ? 0 : 5));
        // Offset of the instrument.
        for (double& value : record.values) value += 9.81;
        const FittedMotion fit = fit_motion(record, omega, repeats ? cycles : 0);
        EXPECT_NEAR(fit.amplitude, a, derivative == 0 ? 1e-12 : 3 * bound);
        EXPECT_NEAR(fit.motion.info().start, (1 - phi / kTurn) * period, 10 * bound);
        const Drive drive = drive_of(fit, omega), sine{.amplitude = a, .omega = omega};
        double worst = 0, fastest = 0;
        // Within the record, away from its ends, where a spline of fewer neighbours errs more.
        for (int cycle = 1; cycle < 5; ++cycle)
          for (int k = 0; k < 500; ++k) {
            const double f = k / 500.0;
            worst = std::max(worst, std::abs(drive.displacement(f, cycle) - sine.displacement(f)));
            fastest = std::max(fastest, std::abs(drive.velocity(f, cycle) - sine.velocity(f)));
          }
        if (derivative == 0 && repeats) {
          EXPECT_GT(worst, 0.9 * bound);
          EXPECT_LT(worst, 1.1 * bound);
        }
        EXPECT_LT(worst, 4 * bound) << derivative << repeats << per_cycle;
        EXPECT_LT(fastest, 20 * bound / h) << derivative << repeats << per_cycle;
        // At its ends a spline of positions knows their curvature less well.
        const double curvature = repeats ? 0.1 * std::pow(h * omega, 2) : 0.02;
        EXPECT_NEAR(drive.peak_fall(), sine.peak_fall(), curvature * sine.peak_fall());
      }
  }
}

// Within each interval displacement, velocity and acceleration are derivatives of one another, and at a
// sample both polynomials have the same three.
TEST(RecordedMotion, IsSmooth) {
  const MotionRecord record = sine_record(2, 1, 1, 0, 0.3, 100);
  const RecordedMotion motion = fit_motion(record, 1, 0).motion;
  const auto at = [&](double t) { return motion.at(0, (t - motion.info().start) / kTurn, kTurn); };
  for (int k = 1; k < 99; ++k) {
    const MotionSample before = at(0.3 * k - 1e-9), after = at(0.3 * k + 1e-9), here = motion.samples()[k];
    EXPECT_NEAR(before.z, here.z, 1e-8);
    EXPECT_NEAR(before.v, here.v, 1e-8);
    EXPECT_NEAR(before.a, here.a, 1e-8);
    EXPECT_NEAR(after.a, here.a, 1e-8);
    const double d = 1e-5, t = 0.3 * k + 0.1;
    EXPECT_NEAR(at(t).v, (at(t + d).z - at(t - d).z) / (2 * d), 1e-9);
    EXPECT_NEAR(at(t).a, (at(t + d).v - at(t - d).v) / (2 * d), 1e-9);
  }
}

// A spline through values of a cubic polynomial is that polynomial: with z = t^3/6 - t the acceleration is t.
TEST(RecordedMotion, ACubicPolynomialIsExact) {
  MotionRecord record{.file = "cubic.csv", .interval = 0.25};
  for (int i = 0; i < 64; ++i) {
    const double t = 0.25 * i;
    record.values.push_back(t * t * t / 6 - t);
  }
  const RecordedMotion motion = fit_motion(record, 1, 0).motion;
  const double low = motion.samples()[0].z;
  for (int k = 0; k <= 600; ++k) {
    const double t = 15.75 * k / 600;
    const MotionSample s = motion.at(0, (t - motion.info().start) / kTurn, kTurn);
    EXPECT_NEAR(s.z - low, t * t * t / 6 - t, 1e-10);
    EXPECT_NEAR(s.v, t * t / 2 - 1, 1e-10);
    EXPECT_NEAR(s.a, t, 1e-9);
  }
}

// A constant error of an accelerometer, and the unknown initial height and velocity, do not move the plate
// away.
TEST(RecordedMotion, ConstantsOfIntegrationAreRemoved) {
  MotionRecord record = sine_record(2, 1, 1, 0.3, 0.1, 20'000);
  for (double& a : record.values) a -= 250;
  const RecordedMotion motion = fit_motion(record, 1, 0).motion;
  EXPECT_NEAR(motion.range().highest, 1, 1e-3);
  EXPECT_NEAR(motion.range().lowest, -1, 1e-3);
  EXPECT_NEAR(motion.range().speed, 1, 1e-3);
}

/// Share of the amplitude of a sine of frequency f that is kept.
double kept(double f, double cutoff, double h) {
  const double r = std::pow(std::sin(kTurn / 2 * f * h) / std::sin(kTurn / 2 * cutoff * h), 4);
  return 1 - std::pow(r / (1 + r), 2);
}

// The filter of a record that repeats multiplies each Fourier component; of a record with ends it does so
// away from them, and it keeps a straight line to its ends.
TEST(RecordedMotion, SmoothingKeepsLowFrequencies) {
  const double h = 0.01, cutoff = 4;
  for (const double f : {1.0, 2.0, 4.0, 8.0, 20.0}) {
    const MotionRecord sine = sine_record(0, 1, kTurn * f, 0.3, h, 500);
    const MotionRecord repeated = smoothed(sine, cutoff, true), once = smoothed(sine, cutoff, false);
    for (std::size_t i = 0; i < 500; ++i) {
      EXPECT_NEAR(repeated.values[i], kept(f, cutoff, h) * sine.values[i], 1e-9) << f << ' ' << i;
      if (i < 150 || i >= 350) continue;
      EXPECT_NEAR(once.values[i], kept(f, cutoff, h) * sine.values[i], 1e-6) << f;
    }
  }
  EXPECT_GT(kept(1, cutoff, h), 0.9999);
  EXPECT_NEAR(kept(4, cutoff, h), 0.75, 1e-12);
  EXPECT_LT(kept(20, cutoff, h), 0.01);
  MotionRecord line{.file = "line.csv", .interval = h};
  for (int i = 0; i < 100; ++i) line.values.push_back(3 - 0.2 * i);
  const MotionRecord straight = smoothed(line, cutoff, false);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_NEAR(straight.values[i], line.values[i], 1e-9);
}

// A spline through values that alternate by +-e has the curvature 12 e/h^2 at them.
TEST(RecordedMotion, SmoothingRemovesNoise) {
  const double h = kTurn / 200, e = 0.001, cutoff = 10 / kTurn;
  MotionRecord noisy = sine_record(0, 1, 1, 0, h, 1000);
  for (std::size_t i = 0; i < noisy.values.size(); ++i) noisy.values[i] += i % 2 == 0 ? e : -e;
  EXPECT_NEAR(fit_motion(noisy, 1, 5).motion.range().fall, 1 + 12 * e / (h * h), 0.01);
  const FittedMotion fit = fit_motion(smoothed(noisy, cutoff, true), 1, 5);
  EXPECT_NEAR(fit.motion.range().fall, 1 + 12 * e / (h * h) * kept(1 / (2 * h), cutoff, h), 0.001);
  EXPECT_NEAR(fit.amplitude, 1, 1e-6);
}

TEST(RecordedMotion, ARepeatedRecordHasTheSameBitsInEveryRepetition) {
  const RecordedMotion motion = fit_motion(sine_record(0, 1, 1, 0.3, kTurn / 40, 120), 1, 3).motion;
  for (int k = 0; k < 100; ++k)
    for (const std::int64_t cycle : {0, 1, 2}) {
      EXPECT_EQ(motion.at(cycle, k / 100.0, kTurn).z, motion.at(cycle + 3'000'000'000, k / 100.0, kTurn).z);
      EXPECT_EQ(motion.at(cycle, k / 100.0, kTurn).v, motion.at(cycle - 3, k / 100.0, kTurn).v);
    }
  EXPECT_TRUE(std::isinf(motion.length(kTurn)));
}

class MotionRecordFile : public ::testing::Test {
 protected:
  /// The complaint about a file of these lines.
  std::string refused(const std::string& text,
                      const Scale& scale = {.sigma_m = 0.002, .gravity_m_s2 = 9.81}) {
    put_file(folder_ / "trace.csv", text);
    return complaint_of([&] {
      (void)read_motion_record(folder_ / "trace.csv", scale, {.file = "scene.toml", .key = "drive.file"});
    });
  }
  static std::string rows(const std::string& head, const std::vector<std::string>& rows) {
    std::string text = head + "\n";
    for (const std::string& row : rows) text += row + "\n";
    return text;
  }
  /// Rows of a sine, 1 ms apart; `spoil` changes the time and the value of a row.
  template <class Spoil>
  static std::string sine(int n, Spoil spoil) {
    std::string text = "# encoder\ntime_s, position_mm, temperature\n";
    for (int i = 0; i < n; ++i) {
      std::string t = fmt::format("{:.6f}", 0.001 * i),
                  z = fmt::format("{:.9f}", 3 * std::sin(0.05 * kTurn * i));
      spoil(i, t, z);
      text += t + "," + z + ",20\n";
    }
    return text;
  }
  TemporaryFolder folder_;
};

TEST_F(MotionRecordFile, IsReadInItsUnits) {
  const Scale scale{.sigma_m = 0.002, .gravity_m_s2 = 9.81};
  const auto first = [&](const std::string& head, const std::string& value) {
    std::string text = head + "\n";
    for (int i = 0; i < 10; ++i) text += fmt::format("{},{}\n", i, value);
    put_file(folder_ / "trace.csv", text);
    return read_motion_record(folder_ / "trace.csv", scale, {});
  };
  const MotionRecord mm = first("time_ms,position_mm", "3");
  EXPECT_DOUBLE_EQ(mm.values[0], 1.5);
  EXPECT_DOUBLE_EQ(mm.interval, 0.001 / std::sqrt(0.002 / 9.81));
  EXPECT_EQ(mm.derivative, 0);
  EXPECT_DOUBLE_EQ(first("time_s,position_m", "0.003").values[0], 1.5);
  EXPECT_DOUBLE_EQ(first("time_t0,position_sigma", "3").values[0], 3);
  EXPECT_EQ(first("time_t0,position_sigma", "3").interval, 1);
  EXPECT_DOUBLE_EQ(first("time_s,velocity_mm_s", "280.14").values[0], 0.28014 / std::sqrt(0.002 * 9.81));
  EXPECT_EQ(first("time_s,velocity_m_s", "1").derivative, 1);
  EXPECT_DOUBLE_EQ(first("time_s,acceleration_m_s2", "19.62").values[0], 2);
  EXPECT_DOUBLE_EQ(first("time_s,acceleration_g", "2").values[0], 2);
  EXPECT_EQ(first("time_s,acceleration_g", "2").derivative, 2);
  EXPECT_EQ(mm.sha256.size(), 64);
}

TEST_F(MotionRecordFile, BadFilesAreRefusedInOneSentence) {
  const auto nothing = [](int, std::string&, std::string&) {};
  EXPECT_EQ(refused(sine(100, nothing)), "");
  const auto expect = [&](const std::string& text, const std::vector<std::string>& words,
                          const Scale& scale = {.sigma_m = 0.002, .gravity_m_s2 = 9.81}) {
    const std::string complaint = refused(text, scale);
    for (const std::string& word : words)
      EXPECT_NE(complaint.find(word), std::string::npos) << '"' << word << "\" is not in: " << complaint;
  };
  expect(sine(5, nothing), {"trace.csv", "has 5 rows; a recorded motion has at least 8"});
  expect(sine(100,
              [](int i, std::string&, std::string& z) {
                if (i == 41) z = "nan";
              }),
         {"position_mm: row 42 has no number."});
  expect(sine(100,
              [](int i, std::string&, std::string& z) {
                if (i == 41) z = "";
              }),
         {"row 42 has no number."});
  expect(sine(100,
              [](int i, std::string&, std::string& z) {
                if (i == 41) z = "inf";
              }),
         {":44:", "finite"});
  expect(sine(100,
              [](int i, std::string& t, std::string&) {
                if (i == 50) t = "0.048";
              }),
         {"time_s: row 51 is not later than the row before it."});
  expect(sine(100,
              [](int i, std::string& t, std::string&) {
                if (i > 30) t = fmt::format("{:.6f}", 0.001 * i + 0.004);
              }),
         {"time_s: rows are missing: row 32 follows 5 usual steps after row 31."});
  expect(sine(100, [](int i, std::string& t,
                      std::string&) { t = fmt::format("{:.6f}", 0.001 * i + (i % 2) * 0.0003); }),
         {"time_s: row", "departs by 0.3 steps from equal steps, the bound is 0.1; resample"});
  // Times rounded to a twentieth of a step are read.
  EXPECT_EQ(refused(sine(100, [](int i, std::string& t,
                                 std::string&) { t = fmt::format("{:.6f}", 0.001 * i + (i % 2) * 5e-5); })),
            "");
  expect("time,position_mm\n0,1\n1,1\n2,1\n3,1\n4,1\n5,1\n6,1\n7,1\n",
         {"has no column of times", "time_s, time_ms, time_t0", "time, position_mm"});
  expect("time_s,z_mm\n0,1\n1,1\n2,1\n3,1\n4,1\n5,1\n6,1\n7,1\n",
         {"has no column of the motion", "acceleration_m_s2"});
  expect("time_s,position_mm,position_m\n0,1,1\n1,1,1\n2,1,1\n3,1,1\n4,1,1\n5,1,1\n6,1,1\n7,1,1\n",
         {"has 2 columns of the motion, position_mm, position_m; keep one."});
  expect(sine(100, nothing),
         {"scene.toml: drive.file: the column time_s of ", "needs scale.sigma_mm and scale.gravity_m_s2"},
         Scale{.sigma_m = 0.002});
  expect("", {"trace.csv"});
  expect("time_s;position_mm\n0;1\n", {"separated by semicolons"});
}

TEST(RecordedMotion, RecordsThatCannotDriveAreRefused) {
  const auto refused = [](const MotionRecord& record, double omega, int cycles) {
    return complaint_of([&] { (void)fit_motion(record, omega, cycles); });
  };
  EXPECT_NE(refused(sine_record(0, 1, 1, 0, 0.1, 100), 1, 0)
                .find("sine.csv: lasts 1.58 cycles of the drive; at least 2"),
            std::string::npos);
  EXPECT_NE(refused(sine_record(0, 1, 1, 0, 1, 100), 1, 0)
                .find("has 6.28 samples in a cycle of the drive; at least 8"),
            std::string::npos);
  // Two and a half cycles do not close.
  MotionRecord open = sine_record(0, 1, 1, 0, kTurn / 40, 90);
  EXPECT_NE(refused(open, 1, 1).find("cannot be repeated: from the last value to the first it jumps by"),
            std::string::npos);
  MotionRecord far = sine_record(0, 1e9, 1, 0, 0.1, 200);
  EXPECT_NE(refused(far, 1, 0).find("sigma, the bound is 1e+06"), std::string::npos);
}

}  // namespace
}  // namespace twincell::read_motion_record_test
