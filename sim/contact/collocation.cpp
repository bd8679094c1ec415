#include "sim/contact/collocation.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace twincell::sim {

namespace {

using Number = long double;
constexpr int kCount = static_cast<int>(kStages);
using Matrix = Eigen::Matrix<Number, kCount, kCount>;

/// Legendre polynomials P_0 .. P_8 at 2 x - 1.
std::array<Number, kStages + 1> legendre(Number x) {
  std::array<Number, kStages + 1> p{1, 2 * x - 1};
  for (std::size_t k = 1; k < kStages; ++k) {
    const auto n = static_cast<Number>(k);
    p[k + 1] = ((2 * n + 1) * (2 * x - 1) * p[k] - n * p[k - 1]) / (n + 1);
  }
  return p;
}
/// Radau points: the zeros of P_8 - P_7 in (0, 1], where it changes its sign.
std::array<Number, kStages> radau_points() {
  const auto f = [](Number x) { return legendre(x)[kStages] - legendre(x)[kStages - 1]; };
  std::array<Number, kStages> c{};
  std::size_t found = 0;
  constexpr int kPieces = 1000;
  for (int k = 0; k < kPieces && found + 1 < kStages; ++k) {
    Number low = static_cast<Number>(k) / kPieces, high = static_cast<Number>(k + 1) / kPieces;
    if ((f(low) > 0) == (f(high) > 0)) continue;
    const bool sign = f(high) > 0;
    for (int n = 0; n < 80; ++n) {
      const Number middle = (low + high) / 2;
      ((f(middle) > 0) == sign ? high : low) = middle;
    }
    c[found++] = high;
  }
  c[kStages - 1] = 1;
  return c;
}
StageMap map_of(const Matrix& m) {
  StageMap map{};
  for (int j = 0; j < kCount; ++j)
    for (int i = 0; i < kCount; ++i) map.column[j][i] = static_cast<double>(m(i, j));
  return map;
}
Collocation computed() {
  Collocation c{};
  const auto at = radau_points();
  Matrix values, integrals;
  for (int i = 0; i < kCount; ++i) {
    const Number x = at[static_cast<std::size_t>(i)];
    c.moment[i] = static_cast<double>(x);
    const auto p = legendre(x);
    for (int k = 0; k < kCount; ++k) {
      const auto n = static_cast<std::size_t>(k);
      values(i, k) = p[n];
      // Integral of P_n from 0 to x: (P_n+1 - P_n-1)/(2 (2 n + 1)).
      integrals(i, k) = k == 0 ? x : (p[n + 1] - p[n - 1]) / (2 * (2 * static_cast<Number>(k) + 1));
    }
  }
  const Matrix coefficients = values.inverse(), once = integrals * coefficients, twice = once * once;
  c.once = map_of(once), c.twice = map_of(twice);
  for (int i = 0; i < kCount; ++i)
    for (int k = 0; k < 2; ++k) c.last[k][i] = static_cast<double>(coefficients(kCount - 2 + k, i));
  for (std::size_t k = 0; k <= kStages; ++k) {
    const auto place = [&](std::size_t j) { return j == 0 ? Number{0} : at[j - 1]; };
    c.place[k] = static_cast<double>(place(k));
    Number product = 1;
    for (std::size_t j = 0; j <= kStages; ++j)
      if (j != k) product *= 2 * (place(k) - place(j));
    c.weight[k] = static_cast<double>(1 / product);
  }
  for (std::size_t k = 0; k <= Collocation::kWidths; ++k) {
    const Number width = Number{Collocation::kWidest} * static_cast<Number>(k) / Collocation::kWidths;
    const Matrix r_a = (Matrix::Identity() + width * width * twice).inverse() * once;
    c.response[k] = {static_cast<double>(width), map_of(r_a), map_of(r_a * once), map_of(r_a * twice)};
  }
  return c;
}

}  // namespace

const Collocation& Collocation::numbers() {
  static const Collocation kNumbers = computed();
  return kNumbers;
}

}  // namespace twincell::sim
