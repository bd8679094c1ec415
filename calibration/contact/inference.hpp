#pragma once
/// \file
/// Parameters of a simulator from observables that it shares with a measurement, and what the measurement
/// leaves open.
///
/// The simulator is noisy, so it is run at scattered points and each observable is fitted by a surface
/// y_o(theta) of second or third degree, whichever predicts left-out runs better; its residuals are what one
/// run scatters. With the measured y*_o and its error e_o
///     chi^2(theta) = d^T V^-1 d,    d_o = y_o(theta) - y*_o,
///     V = S (1 + h(theta)) + diag(max(e_o^2 - S_oo, 0))
/// S is the covariance of the residuals of one run, which observables of the same run share, and h what the
/// surface itself is uncertain by. The measurement is one run too: where its own error is smaller than what
/// runs scatter, the scatter counts.
///     The 95 % interval of a parameter is where chi^2, smallest over all others, is within a `drop` of its
///     least.
/// That is at least t^2 nu/nu': t Student's 97.5 % quantile at nu' = nu - p + 1, nu the runs from which S is
/// known and p the observables that share runs (Hotelling's correction; 3.84 for very many runs). It is more
/// where the runs say so: each in turn takes the measurement's place, the surfaces made of all others, and 95
/// % of them have to lie within (rank 0.95 (n + 1) of n, as in conformal prediction). A parameter whose
/// interval reaches both ends of what was looked at is undetermined.

#include <optional>
#include <string>
#include <vector>

namespace twincell {

/// One parameter and where it was looked for.
struct Sought {
  std::string name;
  double lower = 0, upper = 1;
};
/// One run.
struct SimulatedPoint {
  std::vector<double> theta;    ///< [parameters]
  std::vector<double> y;        ///< [observables]; NaN where the run has no value
  std::vector<double> at = {};  ///< [observables] where it stood for those with a condition; may be empty if
                                ///< none has
};
/// Something besides the parameters on which an observable depends: over which range runs tried it, and where
/// the measurement stood.
struct Condition {
  Sought tried;
  double value = 0, error = 0;
};
/// What was measured. One with a condition is taken to have runs of its own: its residuals are shared with no
/// other.
struct MeasuredObservable {
  std::string name;
  double value = 0, error = 0;
  std::optional<Condition> at = {};
};

/// One parameter's profile.
struct Profile {
  Sought sought;
  double best = 0;
  double drop = 0;                           ///< of chi^2 at the ends of the interval
  double low = 0, high = 0;                  ///< of the 95 % interval
  bool open_low = false, open_high = false;  ///< it reaches the end that was looked at
  double standard_error = 0;     ///< (high - low)/2 over the root of the drop; NaN where an end is
                                 ///< open
  std::vector<double> at, chi2;  ///< the profile itself
  [[nodiscard]] bool undetermined() const { return open_low && open_high; }
};

struct Inference {
  std::vector<Profile> profiles;
  double chi2 = 0;                ///< least
  double freedom = 0;             ///< observables - parameters
  std::vector<double> scatter;    ///< s_o of each observable
  std::vector<double> predicted;  ///< y_o at the best point
  std::vector<double> slope;      ///< its derivative by the condition there; 0 without one
  std::vector<std::string> notes;
};

/// \throws InputError for fewer runs than a quadratic surface has coefficients plus two, or than the
/// observables
///         that share runs need
Inference infer_parameters(const std::vector<Sought>& sought, const std::vector<SimulatedPoint>& runs,
                           const std::vector<MeasuredObservable>& measured);

/// `n` points spread evenly over the ranges (Halton's sequence, so that more points refine fewer). \pre at
/// most six ranges
std::vector<std::vector<double>> spread_points(const std::vector<Sought>& sought, int n);

}  // namespace twincell
