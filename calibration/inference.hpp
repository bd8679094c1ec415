#pragma once
/// \file
/// Parameters of a simulator from observables that it shares with a measurement, and what the measurement
/// leaves open.
///
/// The simulator is noisy, so it is run at scattered points and each observable is fitted by a quadratic
/// surface y_o(theta), whose residuals are what one run scatters. With the measured y*_o and its error
///     chi^2(theta) = sum_o (y_o(theta) - y*_o)^2/(e_o^2 + s_o^2)
/// is profiled: the 95 % interval of a parameter is where chi^2, smallest over all others, is within t^2 of
/// its least, t Student's 97.5 % quantile for the runs from which s_o is known (3.84 for very many). A
/// parameter whose interval reaches both ends of what was looked at is undetermined.

#include <string>
#include <vector>

namespace twincell {

/// One parameter and where it was looked for.
struct Sought {
  std::string name;
  double lower = 0, upper = 1;
};
/// One run: [parameters], [observables]; NaN where a run has no value.
struct SimulatedPoint {
  std::vector<double> theta, y;
};
/// What was measured.
struct MeasuredObservable {
  std::string name;
  double value = 0, error = 0;
};

/// One parameter's profile.
struct Profile {
  Sought sought;
  double best = 0;
  double low = 0, high = 0;                  ///< of the 95 % interval
  bool open_low = false, open_high = false;  ///< it reaches the end that was looked at
  double standard_error = 0;                 ///< (high - low)/2t; NaN where an end is open
  std::vector<double> at, chi2;              ///< the profile itself
  [[nodiscard]] bool undetermined() const { return open_low && open_high; }
};

struct Inference {
  std::vector<Profile> profiles;
  double chi2 = 0;                ///< least
  double freedom = 0;             ///< observables - parameters
  std::vector<double> scatter;    ///< s_o of each observable
  std::vector<double> predicted;  ///< y_o at the best point
  std::vector<std::string> notes;
};

/// \throws InputError for fewer runs than a quadratic surface has coefficients plus two
Inference infer_parameters(const std::vector<Sought>& sought, const std::vector<SimulatedPoint>& runs,
                           const std::vector<MeasuredObservable>& measured);

/// `n` points spread evenly over the ranges (Halton's sequence, so that more points refine fewer).
std::vector<std::vector<double>> spread_points(const std::vector<Sought>& sought, int n);

}  // namespace twincell
