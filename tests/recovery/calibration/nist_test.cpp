// NIST StRD nonlinear regression: data with certified parameters and standard deviations (11 digits), solved
// by the solver that every fit uses. https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/fit/curve_fit.hpp"
#include "calibration/laws/model.hpp"
#include "tests/support/validation.hpp"

namespace twincell::nist_test {

using namespace calibration;

namespace {

/// b1 (1 - exp(-b2 x)): Misra1a and BoxBOD.
struct Saturation {
  static constexpr int kParameters = 2;
  template <class T>
  static T value(double x, const T* b) {
    using std::exp;
    return b[0] * (1.0 - exp(-b[1] * x));
  }
};

/// b1 x^b2: DanWood.
struct PowerOfX {
  static constexpr int kParameters = 2;
  template <class T>
  static T value(double x, const T* b) {
    using std::exp;
    return b[0] * exp(b[1] * std::log(x));
  }
};

/// Thurber.
struct Cubics {
  static constexpr int kParameters = 7;
  template <class T>
  static T value(double x, const T* b) {
    return (b[0] + x * (b[1] + x * (b[2] + x * b[3]))) / (1.0 + x * (b[4] + x * (b[5] + x * b[6])));
  }
};

/// MGH09.
struct Quadratics {
  static constexpr int kParameters = 4;
  template <class T>
  static T value(double x, const T* b) {
    return b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3]);
  }
};

/// Rat43.
struct Sigmoid {
  static constexpr int kParameters = 4;
  template <class T>
  static T value(double x, const T* b) {
    using std::exp;
    using std::log;
    return b[0] * exp(-log(1.0 + exp(b[1] - b[2] * x)) / b[3]);
  }
};

struct Problem {
  std::string name;
  std::vector<double> x, y;
  std::vector<std::vector<double>> starts;
  std::vector<double> certified, deviations;
  double squares;
};

/// Number of correct digits, -log10 of the relative error, at most the 11 certified digits.
double digits(double value, double certified) {
  const double error = std::abs(value - certified) / std::abs(certified);
  return error <= 1e-11 ? 11 : -std::log10(error);
}

template <class Model>
void expect_certified(const Problem& problem) {
  std::vector<DataPoint> points;
  for (std::size_t i = 0; i < problem.x.size(); ++i) points.push_back({problem.x[i], problem.y[i]});
  for (std::size_t s = 0; s < problem.starts.size(); ++s) {
    Law law;
    law.name = problem.name;
    for (std::size_t p = 0; p < problem.certified.size(); ++p)
      law.parameters.push_back(fmt::format("b{}", p + 1));
    law.starts = [&](const std::vector<FitPoint>&) { return Starts{problem.starts[s]}; };
    law = make_law<Model>(law);
    const CurveFit fit = fit_curve(law, points);
    double values = 11, errors = 11;
    ASSERT_EQ(fit.fit.standard_errors.size(), problem.certified.size()) << problem.name;
    for (std::size_t p = 0; p < problem.certified.size(); ++p) {
      values = std::min(values, digits(fit.fit.values[p], problem.certified[p]));
      errors = std::min(errors, digits(fit.fit.standard_errors[p], problem.deviations[p]));
    }
    const std::string what = fmt::format("NIST {} from start {}: digits agreed, ", problem.name, s + 1);
    test::validate({"V5.11", what + "worst parameter", 11, 2, "NIST StRD, 11 digits"}, values);
    test::validate({"V5.11", what + "worst standard deviation", 11, 2, "NIST StRD, 11 digits"}, errors);
    EXPECT_GE(digits(2 * fit.fit.cost_after, problem.squares), 9) << problem.name;
  }
}

}  // namespace

TEST(Nist, Misra1a) {
  expect_certified<Saturation>(
      {"Misra1a",
       {77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0},
       {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78},
       {{500, 0.0001}, {250, 0.0005}},
       {2.3894212918E+02, 5.5015643181E-04},
       {2.7070075241E+00, 7.2668688436E-06},
       1.2455138894E-01});
}

// From NIST's other start, (1, 1), the first step leads to b2 < 0, from which no step returns. This is why
// the laws of the program supply their own starts.
TEST(Nist, BoxBod) {
  expect_certified<Saturation>({"BoxBOD (NIST's second)",
                                {1, 2, 3, 5, 7, 10},
                                {109, 149, 149, 191, 213, 224},
                                {{100, 0.75}},
                                {2.1380940889E+02, 5.4723748542E-01},
                                {1.2354515176E+01, 1.0455993237E-01},
                                1.1680088766E+03});
}

TEST(Nist, DanWood) {
  expect_certified<PowerOfX>({"DanWood",
                              {1.309, 1.471, 1.490, 1.565, 1.611, 1.680},
                              {2.138, 3.421, 3.597, 4.340, 4.882, 5.660},
                              {{1, 5}, {0.7, 4}},
                              {7.6886226176E-01, 3.8604055871E+00},
                              {1.8281973860E-02, 5.1726610913E-02},
                              4.3173084083E-03});
}

TEST(Nist, Thurber) {
  expect_certified<Cubics>(
      {"Thurber",
       {-3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481,
        -2.363, -2.322, -1.501, -1.460, -1.274, -1.212, -1.100, -1.046, -0.915, -0.714,
        -0.566, -0.545, -0.400, -0.309, -0.109, -0.103, 0.010,  0.119,  0.377,  0.790,
        0.963,  1.006,  1.115,  1.572,  1.841,  2.047,  2.200},
       {80.574,   84.248,   87.264,   87.195,   89.076,   89.608,   89.868,   90.101,   92.405,   95.854,
        100.696,  101.060,  401.672,  390.724,  567.534,  635.316,  733.054,  759.087,  894.206,  990.785,
        1090.109, 1080.914, 1122.643, 1178.351, 1260.531, 1273.514, 1288.339, 1327.543, 1353.863, 1414.509,
        1425.208, 1421.384, 1442.962, 1464.350, 1468.705, 1447.894, 1457.628},
       {{1000, 1000, 400, 40, 0.7, 0.3, 0.03}, {1300, 1500, 500, 75, 1, 0.4, 0.05}},
       {1.2881396800E+03, 1.4910792535E+03, 5.8323836877E+02, 7.5416644291E+01, 9.6629502864E-01,
        3.9797285797E-01, 4.9727297349E-02},
       {4.6647963344E+00, 3.9571156086E+01, 2.8698696102E+01, 5.5675370270E+00, 3.1333340687E-02,
        1.4984928198E-02, 6.5842344623E-03},
       5.6427082397E+03});
}

TEST(Nist, Mgh09) {
  expect_certified<Quadratics>(
      {"MGH09",
       {4, 2, 1, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625},
       {0.1957, 0.1947, 0.1735, 0.16, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246},
       {{25, 39, 41.5, 39}, {0.25, 0.39, 0.415, 0.39}},
       {1.9280693458E-01, 1.9128232873E-01, 1.2305650693E-01, 1.3606233068E-01},
       {1.1435312227E-02, 1.9633220911E-01, 8.0842031232E-02, 9.0025542308E-02},
       3.0750560385E-04});
}

TEST(Nist, Rat43) {
  expect_certified<Sigmoid>({"Rat43",
                             {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
                             {16.08, 33.83, 65.80, 97.20, 191.55, 326.20, 386.87, 520.53, 590.03, 651.92,
                              724.93, 699.56, 689.96, 637.56, 717.41},
                             {{100, 10, 1, 1}, {700, 5, 0.75, 1.3}},
                             {6.9964151270E+02, 5.2771253025E+00, 7.5962938329E-01, 1.2792483859E+00},
                             {1.6302297817E+01, 2.0828735829E+00, 1.9566123451E-01, 6.8761936385E-01},
                             8.7864049080E+03});
}

}  // namespace twincell::nist_test
