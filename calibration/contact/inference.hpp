#pragma once
/// \file
/// Inference of simulation parameters from observables that simulation and measurement share, with intervals
/// that show which parameters the measurement determines.
///
/// The simulation is noisy. It therefore runs at scattered points theta, and each observable is fitted by a
/// polynomial surface y_o(theta) of degree two or three, whichever predicts left-out runs better. The
/// residuals of the surface give the scatter of one run. With the measured y*_o and its error e_o
///     chi^2(theta) = d^T V^-1 d,    d_o = y_o(theta) - y*_o,
///     V = S (1 + h(theta)) + diag(max(e_o^2 - S_oo, 0)).
/// S is the covariance of the residuals of one run, shared by observables of the same run, and h is the
/// leverage: the variance of the surface relative to the scatter. The measurement is one run as well: where
/// its own error is smaller than the scatter of runs, the scatter is used.
///
/// The 95 % interval of a parameter contains the values at which chi^2, minimised over all other parameters,
/// is within `drop` of its minimum. The drop is at least t^2 nu/nu', where t is Student's 97.5 % quantile at
/// nu' = nu - p + 1, nu the degrees of freedom from which S is estimated, and p the number of observables
/// that share runs (Hotelling's correction; 3.84 for very many runs). The drop is larger where the runs
/// require it: each run in turn replaces the measurement, with surfaces fitted to all other runs, and 95 % of
/// the runs must be inside the interval (rank 0.95 (n + 1) of n, as in conformal prediction). A parameter
/// whose interval reaches both ends of the search range is undetermined.

#include <optional>
#include <string>
#include <vector>

namespace twincell::calibration {

/// One parameter and its search range.
struct Sought {
  std::string name;
  double lower = 0, upper = 1;
};
/// One simulation run.
struct SimulatedPoint {
  std::vector<double> theta;    ///< [parameters]
  std::vector<double> y;        ///< [observables]; NaN where the run has no value
  std::vector<double> at = {};  ///< [observables] condition of the run; may be empty if no observable has one
};
/// Variable other than the parameters on which an observable depends: its range over the runs, and its value
/// and error in the measurement.
struct Condition {
  Sought tried;
  double value = 0, error = 0;
};
/// One measured observable. An observable with a condition has its own runs, so its residuals are independent
/// of all others.
struct MeasuredObservable {
  std::string name;
  double value = 0, error = 0;
  std::optional<Condition> at = {};
};

/// Profile of chi^2 for one parameter.
struct Profile {
  Sought sought;
  double best = 0;
  double drop = 0;                           ///< chi^2 above its minimum at the ends of the interval
  double low = 0, high = 0;                  ///< ends of the 95 % interval
  bool open_low = false, open_high = false;  ///< the interval reaches this end of the search range
  double standard_error = 0;                 ///< (high - low)/(2 x 1.96); NaN if an end is open
  std::vector<double> at, chi2;              ///< the profile: parameter values, least chi^2 at each
  [[nodiscard]] bool undetermined() const { return open_low && open_high; }
};

/// Result of infer_parameters.
struct Inference {
  std::vector<Profile> profiles;
  double chi2 = 0;                ///< minimum
  double freedom = 0;             ///< observables - parameters
  std::vector<double> scatter;    ///< s_o of each observable
  std::vector<double> predicted;  ///< y_o at the best point
  std::vector<double> slope;      ///< derivative of y_o by its condition there; 0 without a condition
  std::vector<std::string> notes;
};

/// Fits the surfaces and profiles chi^2 over the search ranges.
/// \throws InputError if an observable has fewer runs than a quadratic surface has coefficients plus two, or
/// if the observables that share runs need more runs
Inference infer_parameters(const std::vector<Sought>& sought, const std::vector<SimulatedPoint>& runs,
                           const std::vector<MeasuredObservable>& measured);

/// `n` points spread evenly over the search ranges by Halton's sequence: a longer sequence contains the
/// shorter one.
/// \pre at most six ranges
std::vector<std::vector<double>> spread_points(const std::vector<Sought>& sought, int n);

}  // namespace twincell::calibration
