#include "calibration/fit/curve_components.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace twincell::calibration {
namespace {

constexpr double kExplainedShare = 0.999;  // of the variance, after which no form is added

bool finite(const std::vector<double>& curve) {
  return std::all_of(curve.begin(), curve.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

std::vector<double> CurveComponents::numbers(const std::vector<double>& curve) const {
  std::vector<double> all(forms.size(), std::numeric_limits<double>::quiet_NaN());
  if (!finite(curve)) return all;
  for (std::size_t i = 0; i < forms.size(); ++i) {
    all[i] = 0;
    for (std::size_t k = 0; k < mean.size(); ++k) all[i] += forms[i][k] * (curve[k] - mean[k]);
  }
  return all;
}

std::vector<double> CurveComponents::curve(const std::vector<double>& numbers) const {
  std::vector<double> c = mean;
  for (std::size_t i = 0; i < forms.size(); ++i)
    for (std::size_t k = 0; k < c.size(); ++k) c[k] += numbers[i] * forms[i][k];
  return c;
}

double CurveComponents::misfit(const std::vector<double>& curve) const {
  const std::vector<double> near = this->curve(numbers(curve));
  double sum = 0;
  for (std::size_t k = 0; k < mean.size(); ++k) sum += std::pow(curve[k] - near[k], 2);
  return std::sqrt(sum / static_cast<double>(mean.size()));
}

CurveComponents components_of(const std::vector<std::vector<double>>& curves, std::size_t most) {
  std::vector<const std::vector<double>*> used;
  for (const auto& c : curves)
    if (!c.empty() && finite(c)) used.push_back(&c);
  if (used.size() < 3)
    throw InputError(
        {.file = {}, .key = "runs"},
        fmt::format("{} of {} runs have a whole curve; at least 3 are needed.", used.size(), curves.size()));
  const auto rows = static_cast<Eigen::Index>(used.size()),
             columns = static_cast<Eigen::Index>(used.front()->size());
  Eigen::MatrixXd all(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i)
    all.row(i) = Eigen::Map<const Eigen::RowVectorXd>(used[static_cast<std::size_t>(i)]->data(), columns);
  const Eigen::RowVectorXd mean = all.colwise().mean();
  all.rowwise() -= mean;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(all, Eigen::ComputeThinV);
  const Eigen::VectorXd share = svd.singularValues().array().square();
  CurveComponents out;
  out.mean.assign(mean.data(), mean.data() + columns);
  double left = share.sum();
  const double enough = (1 - kExplainedShare) * left;
  for (Eigen::Index i = 0; i < share.size() && out.forms.size() < std::max<std::size_t>(most, 1); ++i) {
    if (i > 0 && left <= enough) break;
    const Eigen::VectorXd form = svd.matrixV().col(i);
    out.forms.emplace_back(form.data(), form.data() + columns);
    left -= share[i];
  }
  out.left_out = std::sqrt(std::max(left, 0.0) / static_cast<double>(rows * columns));
  return out;
}

}  // namespace twincell::calibration
